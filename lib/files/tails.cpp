// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/tails.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

namespace quadtune::internal {
namespace {

namespace policies = boost::math::policies;

using Quiet = policies::policy<policies::domain_error<policies::ignore_error>,
                               policies::pole_error<policies::ignore_error>,
                               policies::overflow_error<policies::ignore_error>,
                               policies::evaluation_error<policies::ignore_error>,
                               policies::rounding_error<policies::ignore_error>>;
using Normal = boost::math::normal_distribution<double, Quiet>;
using Student = boost::math::students_t_distribution<double, Quiet>;
using ChiSquared = boost::math::chi_squared_distribution<double, Quiet>;

/// Beyond it a tail is smaller than any positive double, and the gamma function would overflow.
double far_beyond(double degrees) { return 1e6 + 1e3 * degrees; }

}  // namespace

double normal_above(double z) {
  if (std::isnan(z)) return z;
  return boost::math::cdf(boost::math::complement(Normal(), std::clamp(z, -1e3, 1e3)));
}

double student_above(double t, double degrees) {
  if (std::isnan(t)) return t;
  return boost::math::cdf(boost::math::complement(Student(degrees), std::clamp(t, -1e100, 1e100)));
}

double chi_squared_above(double x, double degrees) {
  if (std::isnan(x)) return x;
  if (x > far_beyond(degrees)) return 0;
  return boost::math::cdf(boost::math::complement(ChiSquared(degrees), std::max(x, 0.0)));
}

double normal_below(double z) {
  if (std::isnan(z)) return z;
  return boost::math::cdf(Normal(), z);
}

double chi_squared_below(double x, double degrees) {
  if (std::isnan(x)) return x;
  if (x > far_beyond(degrees)) return 1;
  return boost::math::cdf(ChiSquared(degrees), std::max(x, 0.0));
}

double chi_squared_two_sided(double x, double degrees) {
  if (std::isnan(x)) return x;
  return std::min(1.0, 2 * std::min(chi_squared_below(x, degrees), chi_squared_above(x, degrees)));
}

double normal_exceeded(double p) {
  return boost::math::quantile(boost::math::complement(Normal(), p));
}

double student_exceeded(double p, double degrees) {
  return boost::math::quantile(boost::math::complement(Student(degrees), p));
}

double chi_squared_exceeded(double p, double degrees) {
  return boost::math::quantile(boost::math::complement(ChiSquared(degrees), p));
}

double normal_quantile(double p) { return boost::math::quantile(Normal(), p); }

double student_quantile(double p, double degrees) {
  return boost::math::quantile(Student(degrees), p);
}

double chi_squared_quantile(double p, double degrees) {
  return boost::math::quantile(ChiSquared(degrees), p);
}

}  // namespace quadtune::internal
