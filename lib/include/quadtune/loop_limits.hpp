// SPDX-License-Identifier: Apache-2.0
/// The control periods and the maximum delay of a sampled loop that quadtune accepts.
#pragma once

namespace quadtune {

/// Minimum control period of a law that flies [s].
inline constexpr double kMinControlPeriod = 1e-4;
/// Maximum control period of a law that flies [s].
inline constexpr double kMaxControlPeriod = 1;

/// Maximum delay of commands and sensors [control periods].
inline constexpr int kMaxDelayPeriods = 40;

}  // namespace quadtune
