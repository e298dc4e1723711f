// SPDX-License-Identifier: Apache-2.0
#include "pid/loop_shape.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "margins/loop_grid.hpp"
#include "pid/delayed_stability.hpp"

namespace quadtune::internal {
namespace {

using Complex = std::complex<double>;

/// p + q, polynomials with coefficients in descending powers.
Eigen::VectorXd sum(const Eigen::VectorXd& p, const Eigen::VectorXd& q) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(std::max(p.size(), q.size()));
  result.tail(p.size()) += p;
  result.tail(q.size()) += q;
  return result;
}

std::vector<double> plant_grid(const ContinuousTransferFunction& plant,
                               const std::vector<double>& corners) {
  Landmarks landmarks;
  landmarks.roots = {polynomial_roots(without_leading_zeros(plant.num)),
                     polynomial_roots(plant.den)};
  std::copy_if(corners.begin(), corners.end(), std::back_inserter(landmarks.corners),
               [](double corner) { return corner > 0; });
  if (plant.delay > 0) landmarks.corners.push_back(1 / plant.delay);
  const auto at_rest = [](const Eigen::VectorXcd& roots) { return roots.isZero(0); };
  if (landmarks.corners.empty() &&
      std::all_of(landmarks.roots.begin(), landmarks.roots.end(), at_rest))
    landmarks.corners.push_back(1);
  landmarks.delay = plant.delay;
  // Beyond this phase, every relevant |L| has occurred at every phase.
  landmarks.delay_phase = 50;
  std::vector<double> grid = loop_grid(landmarks);
  grid.erase(grid.begin());  // the response of an integral is infinite at 0
  return grid;
}

}  // namespace

LoopShape::LoopShape(const ContinuousTransferFunction& plant, const std::vector<double>& corners)
    : plant_(plant), grid_(plant_grid(plant, corners)) {
  plant_.num = without_leading_zeros(plant.num);
  responses_.reserve(grid_.size());
  for (const double w : grid_) responses_.push_back(plant_({0, w}));
  std::transform(responses_.begin(), responses_.end(), std::back_inserter(sizes_),
                 [](const Complex& response) { return std::abs(response); });
}

double LoopShape::low_frequency_sign() const {
  const auto last_coefficient = [](const Eigen::VectorXd& p) {
    Eigen::Index last = p.size() - 1;
    while (last > 0 && p[last] == 0) --last;
    return p[last];
  };
  return last_coefficient(plant_.num) * last_coefficient(plant_.den) < 0 ? -1 : 1;
}

Complex LoopShape::at(const PidGains& gains, double w) const {
  return gains({0, w}) * plant_({0, w});
}

bool LoopShape::stable(const PidGains& gains) const {
  const ContinuousTransferFunction loop = loop_of(plant_, gains);
  if (loop.num.size() > loop.den.size()) return false;
  if (loop.den.size() < 2) return false;  // a static loop is algebraic
  if (plant_.delay > 0) {
    std::vector<double> sizes(grid_.size());
    for (std::size_t k = 0; k < grid_.size(); ++k)
      sizes[k] = std::sqrt(std::norm(gains({0, grid_[k]}))) * sizes_[k];
    return stable_with_delay(loop, grid_, sizes);
  }
  const Eigen::VectorXd closed = sum(loop.den, loop.num);
  if (!(std::abs(closed[0]) > 1e-14 * std::abs(loop.den[0]))) return false;
  const Eigen::VectorXcd poles = polynomial_roots(closed);
  return (poles.real().array() < -1e-12 * poles.cwiseAbs().maxCoeff()).all();
}

SensitivityPeaks LoopShape::peaks(const PidGains& gains) const {
  std::vector<double> sensitivity(grid_.size());
  std::vector<double> complementary(grid_.size());
  for (std::size_t k = 0; k < grid_.size(); ++k) {
    const Complex L = gains({0, grid_[k]}) * responses_[k];
    sensitivity[k] = 1 / std::abs(1.0 + L);
    complementary[k] = std::abs(L) * sensitivity[k];
  }
  const Peak S =
      highest_peak([&](double w) { return 1 / std::abs(1.0 + at(gains, w)); }, grid_, sensitivity);
  const auto T_at = [&](double w) {
    const Complex L = at(gains, w);
    return std::abs(L / (1.0 + L));
  };
  const Peak T = highest_peak(T_at, grid_, complementary);
  return {S.value, S.w, T.value, T.w};
}

double LoopShape::noise_gain(const PidGains& gains) const {
  std::vector<double> values(grid_.size());
  for (std::size_t k = 0; k < grid_.size(); ++k) {
    const Complex C = gains({0, grid_[k]});
    values[k] = std::abs(C / (1.0 + C * responses_[k]));
  }
  const auto gain = [&](double w) { return std::abs(gains({0, w}) / (1.0 + at(gains, w))); };
  return highest_peak(gain, grid_, values).value;
}

MinPhaseMargin LoopShape::min_phase_margin(const PidGains& gains) const {
  std::vector<double> values(grid_.size());
  for (std::size_t k = 0; k < grid_.size(); ++k)
    values[k] = std::log(std::abs(gains({0, grid_[k]}) * responses_[k]));
  MinPhaseMargin min;
  for (const double w :
       crossings([&](double at_w) { return std::log(std::abs(at(gains, at_w))); }, grid_, values)) {
    const double margin = std::arg(-at(gains, w));
    if (min.w == 0 || std::abs(margin) < std::abs(min.margin)) {
      min.w = w;
      min.margin = margin;
    }
    min.last_w = w;
    min.last_margin = margin;
  }
  return min;
}

}  // namespace quadtune::internal
