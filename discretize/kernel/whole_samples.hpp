// SPDX-License-Identifier: Apache-2.0
/// Conversion of delays from seconds to samples.
#pragma once

#include <string>

namespace quadtune::internal {

/// A smaller distance to a whole number of samples is rounding of decimal numbers.
inline constexpr double kWholeSample = 1e-9;

/// A delay in samples: the whole number and a fraction in [0, 1).
struct Samples {
  int whole = 0;
  double fraction = 0;
};

/// @param delay  [s], ≥ 0
/// @throws InvalidInput  if the delay exceeds 1e9 samples.
[[nodiscard]] Samples in_samples(double delay, double dt, const std::string& where);

/// @throws InvalidInput  likewise, or if the delay is not a whole number of samples.
[[nodiscard]] int whole_samples(double delay, double dt, const std::string& where);

}  // namespace quadtune::internal
