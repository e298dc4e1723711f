// SPDX-License-Identifier: Apache-2.0
#include "sampling/looks_sampled.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

namespace quadtune {

std::string why_not_sampled(const Eigen::MatrixXd& A) {
  constexpr double kNearOne = 0.5;
  if (A.size() == 0) return "";
  const Eigen::VectorXcd z = A.eigenvalues();
  // Rounding splits the eigenvalues of a Jordan block of size n by its n-th root.
  const double zero = std::max(1e-8, std::pow(1e-15, 1.0 / static_cast<double>(A.rows()))) *
                      std::max(A.norm(), 1e-300);
  std::vector<double> negative;
  bool singular = false;
  for (const std::complex<double>& pole : z) {
    if (std::abs(pole - 1.0) < kNearOne) return "";
    if (std::abs(pole) <= zero)
      singular = true;
    else if (pole.real() < 0 && std::abs(pole.imag()) <= 1e-9 * std::abs(pole))
      negative.push_back(pole.real());
  }
  if (singular) return "has the eigenvalue 0";
  // An even number of equal negative eigenvalues may be pairs e^(±jπ).
  std::sort(negative.begin(), negative.end());
  for (std::size_t i = 0; i < negative.size();) {
    std::size_t end = i + 1;
    while (end < negative.size() &&
           std::abs(negative[end] - negative[i]) <= 1e-6 * std::abs(negative[i]))
      ++end;
    if ((end - i) % 2 == 1) return fmt::format("has the eigenvalue {:.3g}", negative[i]);
    i = end;
  }
  return "";
}

}  // namespace quadtune
