// SPDX-License-Identifier: Apache-2.0
/// Tails and quantiles of distributions for numbers that a log made: where a number is none, or has
/// left the range of a double, the answer is NaN or the limit, and nothing throws.
#pragma once

namespace quadtune::internal {

/// Probability of more than z, or x; NaN for NaN.
/// @param degrees  of freedom, > 0
[[nodiscard]] double normal_above(double z);
[[nodiscard]] double student_above(double t, double degrees);
[[nodiscard]] double chi_squared_above(double x, double degrees);
/// Probability of at most x; NaN for NaN.
[[nodiscard]] double chi_squared_below(double x, double degrees);

/// Probability of a value as far from its expectation on its side, twice.
[[nodiscard]] double chi_squared_two_sided(double x, double degrees);

/// What is exceeded with this probability, 0 < p < 1.
[[nodiscard]] double normal_exceeded(double p);
[[nodiscard]] double student_exceeded(double p, double degrees);
[[nodiscard]] double chi_squared_exceeded(double p, double degrees);

}  // namespace quadtune::internal
