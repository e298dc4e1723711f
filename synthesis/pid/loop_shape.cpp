// SPDX-License-Identifier: Apache-2.0
#include "pid/loop_shape.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "margins/loop_grid.hpp"

namespace quadtune::internal {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

/// p + q, polynomials with coefficients in descending powers.
Eigen::VectorXd sum(const Eigen::VectorXd& p, const Eigen::VectorXd& q) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(std::max(p.size(), q.size()));
  result.tail(p.size()) += p;
  result.tail(q.size()) += q;
  return result;
}

/// Computes the change of arg F(jω) between two frequencies, bisecting until every step is small.
/// NaN if F passes through 0.
template <class F>
double turn(const F& f, double low, Complex f_low, double high, Complex f_high, int depth) {
  const double middle = low + (high - low) / 2;
  const Complex f_middle = f(middle);
  const double first = std::arg(f_middle / f_low);
  const double second = std::arg(f_high / f_middle);
  if (std::abs(first) < 0.8 && std::abs(second) < 0.8) return first + second;
  if (!(depth < 50)) return std::numeric_limits<double>::quiet_NaN();
  return turn(f, low, f_low, middle, f_middle, depth + 1) +
         turn(f, middle, f_middle, high, f_high, depth + 1);
}

/// The change of arg(jω - p), summed over the roots p, from ω = w to infinity.
double remaining_turn(const Eigen::VectorXcd& roots, double w) {
  double sum = 0;
  for (Eigen::Index i = 0; i < roots.size(); ++i) {
    const double right = roots[i].real() > 0 ? -1 : 1;
    sum += right * (pi / 2 - std::atan2(w - roots[i].imag(), std::abs(roots[i].real())));
  }
  return sum;
}

/// Computes a frequency above which |L| remains below `bound`, given that |L| decreases beyond the
/// grid.
double last_frequency_of_note(const ContinuousTransferFunction& loop,
                              const std::vector<double>& grid, double bound) {
  const auto size = [&](double w) {
    return std::abs(polynomial(loop.num, {0, w}) / polynomial(loop.den, {0, w}));
  };
  std::size_t k = grid.size();
  while (k > 0 && size(grid[k - 1]) < bound) --k;
  if (k < grid.size()) return grid[k];
  double w = grid.back();
  for (int doubling = 0; doubling < 200 && !(size(w) < bound); ++doubling) w *= 2;
  return w;
}

/// Mikhailov's criterion: arg F(jω), F = den + num e^(-jω delay), increases by n π/2 from ω = 0 to
/// infinity if and only if no root of F is in the right half-plane; each such root reduces it by π.
bool mikhailov_stable(const ContinuousTransferFunction& loop, const std::vector<double>& grid) {
  const double delay = loop.delay;
  const auto n = static_cast<double>(loop.den.size() - 1);
  const double at_infinity =
      loop.num.size() == loop.den.size() ? std::abs(loop.num[0] / loop.den[0]) : 0;
  if (!(at_infinity < 1)) return false;  // infinitely many roots are not stable
  const auto F = [&](double w) {
    return polynomial(loop.den, {0, w}) +
           polynomial(loop.num, {0, w}) * std::polar(1.0, -w * delay);
  };
  const double end = last_frequency_of_note(loop, grid, std::max(0.5, (1 + at_infinity) / 2));
  double w = 0;
  Complex f = F(0);
  const double scale =
      std::abs(loop.den[loop.den.size() - 1]) + std::abs(loop.num[loop.num.size() - 1]);
  if (!(std::abs(f) > 1e-14 * scale)) return false;
  double total = 0;
  while (w < end) {
    double next = w == 0 ? grid.front() : w + std::min(0.1 * w, 0.5 / delay);
    next = std::min(next, end);
    const Complex f_next = F(next);
    total += turn(F, w, f, next, f_next, 0);
    w = next;
    f = f_next;
  }
  // F = den (1 + L); beyond `end`, |L| < 1, so that arg(1 + L) returns to its value at infinity.
  total += remaining_turn(polynomial_roots(loop.den), end);
  total -= std::arg(1.0 + polynomial(loop.num, {0, end}) / polynomial(loop.den, {0, end}) *
                              std::polar(1.0, -end * delay));
  const double roots_right = (n * pi / 2 - total) / pi;
  return std::abs(roots_right) < 0.25;
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
  if (plant_.delay > 0) return mikhailov_stable(loop, grid_);
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
