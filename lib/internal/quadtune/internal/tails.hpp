// SPDX-License-Identifier: Apache-2.0
/// Probabilities and quantiles of distributions. Boost.Math computes them, compiled here alone: its
/// headers take a compiler 20 seconds. Nothing throws: NaN gives NaN, and a number beyond the range
/// of double gives the limit.
#pragma once

namespace quadtune::internal {

/// Probability of more than z, or x; NaN for NaN.
/// @param degrees  of freedom, > 0
[[nodiscard]] double normal_above(double z);
[[nodiscard]] double student_above(double t, double degrees);
[[nodiscard]] double chi_squared_above(double x, double degrees);
/// Probability of at most x; NaN for NaN.
[[nodiscard]] double normal_below(double z);
[[nodiscard]] double chi_squared_below(double x, double degrees);

/// Probability of a value as far from its expectation on its side, twice.
[[nodiscard]] double chi_squared_two_sided(double x, double degrees);

/// What is exceeded with this probability, 0 < p < 1.
[[nodiscard]] double normal_exceeded(double p);
[[nodiscard]] double student_exceeded(double p, double degrees);
[[nodiscard]] double chi_squared_exceeded(double p, double degrees);

/// What is not exceeded with this probability, 0 < p < 1.
[[nodiscard]] double normal_quantile(double p);
[[nodiscard]] double student_quantile(double p, double degrees);
[[nodiscard]] double chi_squared_quantile(double p, double degrees);

}  // namespace quadtune::internal
