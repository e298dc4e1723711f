// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "quadtune/exports/verify.hpp"

namespace quadtune {

Eigen::VectorXcd closed_loop_poles(const DiscreteLti& plant, const Gains& gains) {
  const DiscreteLti loop = open_loop(plant, gains);
  Eigen::VectorXcd poles = (loop.A - loop.B * loop.C).eigenvalues();
  std::sort(poles.begin(), poles.end(), [](const auto& a, const auto& b) {
    return a.real() != b.real() ? a.real() < b.real() : a.imag() < b.imag();
  });
  return poles;
}

}  // namespace quadtune
