// SPDX-License-Identifier: Apache-2.0
/// Seconds as samples.
#pragma once

#include <string>

namespace quadtune::internal {

/// What is nearer to a whole sample than this is the rounding of decimal numbers.
inline constexpr double kWholeSample = 1e-9;

/// A delay in samples: `whole` of them and a fraction in [0, 1).
struct Samples {
  int whole = 0;
  double fraction = 0;
};

/// @param delay  [s], ≥ 0
/// @throws InvalidInput  for more samples than an int counts.
[[nodiscard]] Samples in_samples(double delay, double dt, const std::string& where);

/// @throws InvalidInput  likewise, and for a delay that is no whole number of samples.
[[nodiscard]] int whole_samples(double delay, double dt, const std::string& where);

}  // namespace quadtune::internal
