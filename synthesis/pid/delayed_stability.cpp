// SPDX-License-Identifier: Apache-2.0
#include "pid/delayed_stability.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "margins/loop_grid.hpp"

namespace quadtune::internal {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

struct Point {
  double w;     ///< [rad/s]
  double size;  ///< |L(jω)|, infinite at a pole
};

/// The argument of Π (jω - root), continuous in ω.
double argument(const Eigen::VectorXcd& roots, double w) {
  double sum = 0;
  for (const Complex& root : roots) {
    const double turn = std::atan2(w - root.imag(), std::abs(root.real()));
    sum += root.real() > 0 ? -turn : turn;
  }
  return sum;
}

/// L = num/den e^(-jω delay) by the arguments of F in the two ranges of |L|.
class DelayedLoop {
 public:
  explicit DelayedLoop(const ContinuousTransferFunction& loop)
      : loop_(loop), poles_(polynomial_roots(loop.den)) {
    if (!loop.num.isZero(0)) zeros_ = polynomial_roots(loop.num);
  }

  [[nodiscard]] const Eigen::VectorXcd& zeros() const { return zeros_; }
  [[nodiscard]] double size(double w) const {
    return std::abs(polynomial(loop_.num, {0, w})) / std::abs(polynomial(loop_.den, {0, w}));
  }
  /// The continuous change of arg F between two frequencies, |L| ≤ 1 from one to the other.
  [[nodiscard]] double turn_below(double low, double high) const {
    const auto at = [&](double w) {
      return argument(poles_, w) + std::arg(1.0 + without_delay(w) * rotation(w));
    };
    return at(high) - at(low);
  }
  /// The same with |L| ≥ 1.
  [[nodiscard]] double turn_above(double low, double high) const {
    const auto at = [&](double w) {
      const Complex inverse = polynomial(loop_.den, {0, w}) / polynomial(loop_.num, {0, w});
      return argument(zeros_, w) + std::arg(1.0 + inverse * std::conj(rotation(w)));
    };
    return at(high) - at(low) - (high - low) * loop_.delay;
  }
  /// The same from a frequency to infinity, where arg(1 + L) passes through 0 again and again.
  [[nodiscard]] double last_turn(double low) const {
    double sum = 0;
    for (const Complex& pole : poles_) sum += pole.real() > 0 ? -pi / 2 : pi / 2;
    return sum - argument(poles_, low) - std::arg(1.0 + without_delay(low) * rotation(low));
  }

 private:
  [[nodiscard]] Complex without_delay(double w) const {
    return polynomial(loop_.num, {0, w}) / polynomial(loop_.den, {0, w});
  }
  [[nodiscard]] Complex rotation(double w) const { return std::polar(1.0, -w * loop_.delay); }

  const ContinuousTransferFunction& loop_;
  Eigen::VectorXcd poles_;
  Eigen::VectorXcd zeros_;
};

/// The grid with 0, the lightly damped zeros, and a last frequency beyond which |L| < 1.
std::vector<Point> points_of(const DelayedLoop& loop, const std::vector<double>& grid,
                             const std::vector<double>& sizes) {
  std::vector<Point> points = {{0, loop.size(0)}};
  for (std::size_t k = 0; k < grid.size(); ++k) points.push_back({grid[k], sizes[k]});
  constexpr int kDoublings = 200;
  for (int i = 0; i < kDoublings && !(points.back().size < 1); ++i)
    points.push_back({2 * points.back().w, loop.size(2 * points.back().w)});
  constexpr double kDamped = 0.3;  // the grid resolves those that are damped more
  for (const Complex& zero : loop.zeros())
    if (std::abs(zero.real()) < kDamped * zero.imag() && zero.imag() < points.back().w)
      points.push_back({zero.imag(), loop.size(zero.imag())});
  const auto before = [](const Point& a, const Point& b) { return a.w < b.w; };
  const auto same = [](const Point& a, const Point& b) { return a.w == b.w; };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end(), same), points.end());
  return points;
}

}  // namespace

bool stable_with_delay(const ContinuousTransferFunction& loop, const std::vector<double>& grid,
                       const std::vector<double>& sizes) {
  const double at_infinity =
      loop.num.size() == loop.den.size() ? std::abs(loop.num[0] / loop.den[0]) : 0;
  if (!(at_infinity < 1)) return false;
  const double den_0 = loop.den[loop.den.size() - 1], num_0 = loop.num[loop.num.size() - 1];
  if (!(std::abs(den_0 + num_0) > 1e-14 * (std::abs(den_0) + std::abs(num_0)))) return false;

  const DelayedLoop delayed(loop);
  const std::vector<Point> points = points_of(delayed, grid, sizes);
  if (!(points.back().size < 1)) return false;  // too close to 1 for too long
  double total = 0;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const auto& [low, size_low] = points[k];
    const auto& [high, size_high] = points[k + 1];
    const bool above = size_low >= 1;
    const auto turn = [&](bool is_above, double from, double to) {
      return is_above ? delayed.turn_above(from, to) : delayed.turn_below(from, to);
    };
    if (above == (size_high >= 1)) {
      // Neighbours on the same side of 1 are joined, so that few arguments are computed.
      std::size_t end = k + 1;
      while (end + 1 < points.size() && (points[end + 1].size >= 1) == above) ++end;
      total += turn(above, low, points[end].w);
      k = end - 1;
    } else {
      const double middle = crossing([&](double w) { return std::log(delayed.size(w)); }, low, high,
                                     std::log(size_low), std::log(size_high));
      total += turn(above, low, middle) + turn(!above, middle, high);
    }
  }
  total += delayed.last_turn(points.back().w);
  const auto n = static_cast<double>(loop.den.size() - 1);
  const double roots_right = (n * pi / 2 - total) / pi;
  return std::abs(roots_right) < 0.25;
}

}  // namespace quadtune::internal
