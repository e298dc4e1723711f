// SPDX-License-Identifier: Apache-2.0
/// The maximum delay of a sampled loop that quadtune accepts.
#pragma once

namespace quadtune {

/// Maximum delay of commands and sensors [control periods].
inline constexpr int kMaxDelayPeriods = 40;

}  // namespace quadtune
