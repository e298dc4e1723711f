// SPDX-License-Identifier: Apache-2.0
#include "pid/loop_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include "margins/brent_maximum.hpp"

namespace quadtune::internal {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

/// p + q, both in descending powers.
Eigen::VectorXd sum(const Eigen::VectorXd& p, const Eigen::VectorXd& q) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(std::max(p.size(), q.size()));
  result.tail(p.size()) += p;
  result.tail(q.size()) += q;
  return result;
}

/// By how much arg F(jω) turns from one frequency to another, halving until no step turns far.
/// Not a number where F passes through 0.
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

/// What arg(jω - p), summed over the roots p, still turns from ω = w to infinity.
double remaining_turn(const Eigen::VectorXcd& roots, double w) {
  double sum = 0;
  for (Eigen::Index i = 0; i < roots.size(); ++i) {
    const double right = roots[i].real() > 0 ? -1 : 1;
    sum += right * (pi / 2 - std::atan2(w - roots[i].imag(), std::abs(roots[i].real())));
  }
  return sum;
}

/// Where |L| stays below `bound` for good, given that it falls beyond the grid.
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

/// F(jω) = den + num e^(-jω delay) turns by n π/2 from ω = 0 to infinity if and only if none of its
/// roots lies right; each that does takes π away (Mikhailov).
bool mikhailov_stable(const ContinuousTransferFunction& loop, const std::vector<double>& grid) {
  const double delay = loop.delay;
  const auto n = static_cast<double>(loop.den.size() - 1);
  const double at_infinity =
      loop.num.size() == loop.den.size() ? std::abs(loop.num[0] / loop.den[0]) : 0;
  if (!(at_infinity < 1)) return false;  // infinitely many roots right or on the axis
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
  // F = den (1 + L), and from here on 1 + L turns no more than it returns.
  total += remaining_turn(polynomial_roots(loop.den), end);
  total -= std::arg(1.0 + polynomial(loop.num, {0, end}) / polynomial(loop.den, {0, end}) *
                              std::polar(1.0, -end * delay));
  const double roots_right = (n * pi / 2 - total) / pi;
  return std::abs(roots_right) < 0.25;
}

/// The largest of a function near grid point k, on the logarithmic axis.
template <class F>
std::pair<double, double> climb(const F& f, const std::vector<double>& grid, std::size_t k) {
  const double low = std::log(grid[k > 0 ? k - 1 : 0]);
  const double high = std::log(grid[std::min(k + 1, grid.size() - 1)]);
  const auto [value, place] =
      brent_maximum([&](double log_w) { return f(std::exp(log_w)); }, low, high, 1e-9);
  return {value, std::exp(place)};
}

/// The largest of all peaks that come within 5 % of the grid's largest value.
template <class F>
std::pair<double, double> highest_peak(const F& f, const std::vector<double>& grid,
                                       const std::vector<double>& values) {
  const double largest = *std::max_element(values.begin(), values.end());
  std::pair<double, double> best = {0, grid.front()};
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const bool peak = (k == 0 || values[k] >= values[k - 1]) &&
                      (k + 1 == grid.size() || values[k] >= values[k + 1]);
    if (!peak || values[k] < 0.95 * largest) continue;
    best = std::max({best, std::pair(values[k], grid[k]), climb(f, grid, k)});
  }
  return best;
}

std::vector<double> plant_grid(const ContinuousTransferFunction& plant,
                               const std::vector<double>& corners) {
  std::vector<double> marks;
  std::vector<double> grid;
  const auto mark_roots = [&](const Eigen::VectorXd& p) {
    const Eigen::VectorXcd roots = polynomial_roots(p);
    for (Eigen::Index i = 0; i < roots.size(); ++i) {
      const double size = std::abs(roots[i]);
      if (!(size > 0)) continue;
      marks.push_back(size);
      const double damping = std::max(std::abs(roots[i].real()) / size, 1e-6);
      const double peak = std::abs(roots[i].imag());
      if (damping < 0.3)
        for (const double step : {0.0, 0.1, 0.3, 0.6, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0, 15.0, 30.0})
          for (const double side : {-1.0, 1.0})
            if (damping * step < 0.5) grid.push_back(peak * (1 + side * damping * step));
    }
  };
  mark_roots(without_leading_zeros(plant.num));
  mark_roots(plant.den);
  if (plant.delay > 0) marks.push_back(1 / plant.delay);
  for (const double corner : corners)
    if (corner > 0) marks.push_back(corner);
  if (marks.empty()) marks.push_back(1);
  const auto [least, most] = std::minmax_element(marks.begin(), marks.end());
  const double end = *most * 1e3;
  // Beyond fifty turns of the delay every size of L that matters has come by at every phase.
  const double delayed = plant.delay > 0 ? 50 / plant.delay : 0;
  for (double w = *least * 1e-3; w < end;) {
    grid.push_back(w);
    w += w < delayed ? std::min(0.03 * w, 0.2 / plant.delay) : 0.03 * w;
  }
  grid.push_back(end);
  std::sort(grid.begin(), grid.end());
  grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
  return grid;
}

}  // namespace

LoopShape::LoopShape(const ContinuousTransferFunction& plant, const std::vector<double>& corners)
    : plant_(plant), grid_(plant_grid(plant, corners)) {
  plant_.num = without_leading_zeros(plant.num);
  responses_.reserve(grid_.size());
  for (const double w : grid_) responses_.push_back(plant_({0, w}));
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
  SensitivityPeaks peaks;
  std::tie(peaks.Ms, peaks.w_Ms) =
      highest_peak([&](double w) { return 1 / std::abs(1.0 + at(gains, w)); }, grid_, sensitivity);
  std::tie(peaks.Mt, peaks.w_Mt) = highest_peak(
      [&](double w) {
        const Complex L = at(gains, w);
        return std::abs(L / (1.0 + L));
      },
      grid_, complementary);
  return peaks;
}

double LoopShape::noise_gain(const PidGains& gains) const {
  std::vector<double> values(grid_.size());
  for (std::size_t k = 0; k < grid_.size(); ++k) {
    const Complex C = gains({0, grid_[k]});
    values[k] = std::abs(C / (1.0 + C * responses_[k]));
  }
  const auto gain = [&](double w) { return std::abs(gains({0, w}) / (1.0 + at(gains, w))); };
  return highest_peak(gain, grid_, values).first;
}

LeastPhaseMargin LoopShape::least_phase_margin(const PidGains& gains) const {
  LeastPhaseMargin least;
  double before = 0;
  for (std::size_t k = 0; k < grid_.size(); ++k) {
    const double size = std::abs(gains({0, grid_[k]}) * responses_[k]);
    if (k > 0 && (before < 1) != (size < 1)) {
      double low = grid_[k - 1];
      double high = grid_[k];
      for (int i = 0; i < 60; ++i) {
        const double middle = low + (high - low) / 2;
        ((std::abs(at(gains, middle)) < 1) == (before < 1) ? low : high) = middle;
      }
      const double margin = std::arg(-at(gains, high));
      if (least.w == 0 || std::abs(margin) < std::abs(least.margin)) {
        least.w = high;
        least.margin = margin;
      }
      least.last_w = high;
      least.last_margin = margin;
    }
    before = size;
  }
  return least;
}

}  // namespace quadtune::internal
