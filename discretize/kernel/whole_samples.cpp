// SPDX-License-Identifier: Apache-2.0
#include "kernel/whole_samples.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/errors.hpp"

namespace quadtune::internal {

Samples in_samples(double delay, double dt, const std::string& where) {
  const double samples = delay / dt;
  if (samples > 1e9)
    throw InvalidInput(
        where,
        fmt::format("the delay of {} s is {:.6g} samples, expected at most 1e9", delay, samples));
  const double nearest = std::round(samples);
  if (std::abs(samples - nearest) <= kWholeSample) return {static_cast<int>(nearest), 0};
  return {static_cast<int>(std::floor(samples)), samples - std::floor(samples)};
}

int whole_samples(double delay, double dt, const std::string& where) {
  const Samples samples = in_samples(delay, dt, where);
  if (samples.fraction == 0) return samples.whole;
  throw InvalidInput(where, fmt::format("the delay is {} s, expected a whole number of samples of "
                                        "{} s because only zoh is exact for fractions of a sample",
                                        delay, dt));
}

}  // namespace quadtune::internal
