// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "quadtune/control/cascade_law.hpp"
#include "quadtune/exports/verify.hpp"

namespace quadtune {
namespace {

Eigen::VectorXcd sorted(Eigen::VectorXcd poles) {
  std::sort(poles.begin(), poles.end(), [](const auto& a, const auto& b) {
    return a.real() != b.real() ? a.real() < b.real() : a.imag() < b.imag();
  });
  return poles;
}

}  // namespace

Eigen::VectorXcd closed_loop_poles(const DiscreteLti& plant, const Gains& gains) {
  const DiscreteLti loop = open_loop(plant, gains);
  return sorted((loop.A - loop.B * loop.C).eigenvalues());
}

Eigen::VectorXcd closed_loop_poles(const DiscreteLti& plant, const CascadeDesign& cascade) {
  return sorted(closed_loop(plant, cascade_law(cascade.gains, cascade.method)).A.eigenvalues());
}

}  // namespace quadtune
