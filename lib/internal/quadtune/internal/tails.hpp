// SPDX-License-Identifier: Apache-2.0
/// Probabilities and quantiles of distributions, by Boost.Math. Only tails.cpp includes Boost.Math,
/// whose headers take 20 seconds to compile. No function throws: a NaN argument gives NaN, and a
/// result beyond the range of double gives the limit.
#pragma once

namespace quadtune::internal {

/// Probability of a value above z, t or x; NaN for NaN.
/// @param degrees  of freedom, > 0
[[nodiscard]] double normal_above(double z);
[[nodiscard]] double student_above(double t, double degrees);
[[nodiscard]] double chi_squared_above(double x, double degrees);
/// Probability of a value of at most z or x; NaN for NaN.
[[nodiscard]] double normal_below(double z);
[[nodiscard]] double chi_squared_below(double x, double degrees);

/// Two-sided p-value: twice the smaller of the two tail probabilities at x.
[[nodiscard]] double chi_squared_two_sided(double x, double degrees);

/// The value that is exceeded with probability p, 0 < p < 1.
[[nodiscard]] double normal_exceeded(double p);
[[nodiscard]] double student_exceeded(double p, double degrees);
[[nodiscard]] double chi_squared_exceeded(double p, double degrees);

/// The p-quantile, 0 < p < 1.
[[nodiscard]] double normal_quantile(double p);
[[nodiscard]] double student_quantile(double p, double degrees);
[[nodiscard]] double chi_squared_quantile(double p, double degrees);

}  // namespace quadtune::internal
