// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/sample_time.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <complex>

#include "methods/period.hpp"

namespace quadtune {
namespace {

constexpr std::size_t kListed = 4;  // the number of fastest poles that are listed

std::string text(const std::complex<double>& pole) {
  if (pole.imag() == 0) return fmt::format("pole at {:.6g} 1/s is", pole.real());
  return fmt::format("poles at {:.6g} +- {:.6g}i 1/s are", pole.real(), pole.imag());
}

}  // namespace

std::vector<std::string> sample_time_warnings(const Eigen::VectorXcd& poles, double dt) {
  internal::require_period(dt, "sample_time_warnings");
  std::vector<std::complex<double>> fast;
  for (const std::complex<double>& pole : poles)
    if (pole.imag() >= 0 && std::abs(pole) * dt > kLongPeriod) fast.push_back(pole);
  std::stable_sort(fast.begin(), fast.end(),
                   [](const auto& a, const auto& b) { return std::abs(a) > std::abs(b); });
  std::vector<std::string> warnings;
  std::size_t others = 0;
  for (const std::complex<double>& pole : fast) {
    const std::string line = fmt::format(
        "the {} fast for dt = {:.6g} s: |pole| dt is {:.3g}, expected at most {}; use dt <= "
        "{:.3g} s",
        text(pole), dt, std::abs(pole) * dt, kLongPeriod, kLongPeriod / std::abs(pole));
    // Identical axes have identical poles.
    if (!warnings.empty() && warnings.back() == line) continue;
    if (warnings.size() < kListed)
      warnings.push_back(line);
    else
      ++others;
  }
  if (others > 0)
    warnings.push_back(fmt::format("{} more {} fast for dt = {:.6g} s, but less so", others,
                                   others == 1 ? "pole or pair of poles is" : "poles or pairs are",
                                   dt));
  return warnings;
}

std::vector<std::string> sample_time_warnings(const ContinuousLti& plant, double dt) {
  validate(plant, "sample_time_warnings");
  return sample_time_warnings(Eigen::VectorXcd(plant.A.eigenvalues()), dt);
}

std::vector<std::string> sample_time_warnings(const ContinuousTransferFunction& plant, double dt) {
  validate(plant, "sample_time_warnings");
  return sample_time_warnings(polynomial_roots(plant.den), dt);
}

}  // namespace quadtune
