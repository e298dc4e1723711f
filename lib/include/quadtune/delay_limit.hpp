// SPDX-License-Identifier: Apache-2.0
/// The longest delay of a sampled loop that the program accepts.
#pragma once

namespace quadtune {

/// Of commands and sensors [control periods].
inline constexpr int kMostDelayPeriods = 40;

}  // namespace quadtune
