// SPDX-License-Identifier: Apache-2.0
#include "margins/loop_grid.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

#include "quadtune/synthesis/open_loop.hpp"

namespace quadtune {

std::vector<double> frequency_grid(const OpenLoop& loop) {
  internal::Landmarks landmarks{
      .roots = {loop.poles(), loop.closed_loop_poles()}, .dt = loop.dt(), .delay = loop.delay()};
  if (loop.size() == 1) landmarks.roots.push_back(loop.zeros());
  return internal::loop_grid(landmarks);
}

namespace internal {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPerDecade = 60;
constexpr double kBeyond = 1e3;     ///< factor beyond the slowest and the fastest landmark
constexpr double kFastest = 1e150;  ///< [rad/s] its square and multiples do not overflow
constexpr double kPhaseStep = 0.2;  ///< [rad] maximum phase change by the delay per step

/// A pole or zero as a resonance: its frequency and its distance to the boundary [rad/s].
struct Resonance {
  double w;
  double width;
  [[nodiscard]] double size() const { return std::hypot(w, width); }
};

std::vector<Resonance> resonances(const Landmarks& landmarks) {
  std::vector<Resonance> all;
  for (const Eigen::VectorXcd& roots : landmarks.roots)
    for (const std::complex<double>& root : roots) {
      // The continuous-time equivalent of a discrete root; a root at 0 is a delay.
      const std::complex<double> s = landmarks.dt > 0 ? std::log(root) / landmarks.dt : root;
      if (std::isfinite(s.real()) && std::isfinite(s.imag()))
        all.push_back({std::abs(s.imag()), std::abs(s.real())});
    }
  return all;
}

/// Adds frequencies around a root that a grid with kPerDecade points per decade does not resolve.
void add_resonance(const Resonance& root, std::vector<double>& grid) {
  constexpr double kDamped = 0.3;  // from here on, sixty per decade are as dense
  constexpr double kFar = 0.5;
  if (!(root.width < kDamped * root.w)) return;
  for (const double k : {0.0, 0.1, 0.3, 0.6, 1.0, 1.5, 2.5, 4.0, 8.0, 15.0, 30.0})
    if (k * root.width < kFar * root.w)
      for (const double side : {-k, k}) grid.push_back(root.w + side * root.width);
}

/// Predicts a peak of f from the vertex of the parabola through three values of 1/f².
double predicted_peak(const std::vector<double>& w, const std::vector<double>& values,
                      std::size_t i) {
  const auto inverse_square = [&](std::size_t k) { return 1 / (values[k] * values[k]); };
  const double q = inverse_square(i);
  const double before = w[i] - w[i - 1], after = w[i + 1] - w[i];
  const double falls = (q - inverse_square(i - 1)) / before;
  const double rises = (inverse_square(i + 1) - q) / after;
  const double curvature = (rises - falls) / (before + after);
  if (!(curvature > 0) || !std::isfinite(curvature)) return values[i];
  const double slope = (falls * after + rises * before) / (before + after);
  const double vertex = q - slope * slope / (4 * curvature);
  return vertex > 0 ? 1 / std::sqrt(vertex) : kInfinity;
}

/// Adds to the prediction a reserve that increases with its distance from the value, because the
/// grid resolves a peak that hardly exceeds the value.
double possible_peak(double value, double predicted) {
  if (!std::isfinite(value)) return kInfinity;  // not NaN, which cannot be ordered
  return 1.01 * (predicted + 3 * (predicted - value));
}

}  // namespace

std::vector<double> loop_grid(const Landmarks& landmarks) {
  const bool discrete = landmarks.dt > 0;
  const double nyquist = discrete ? std::numbers::pi / landmarks.dt : 0;
  std::vector<double> sizes = landmarks.corners;
  for (const Resonance& root : resonances(landmarks)) sizes.push_back(root.size());
  double fastest = discrete ? nyquist : 1e-12;
  if (!discrete)
    for (const double size : sizes) fastest = std::max(fastest, std::min(size, kFastest));
  // A root that is smaller than rounding relative to the fastest is an integrator.
  double slowest = fastest;
  for (const double size : sizes)
    if (size > 1e-10 * fastest) slowest = std::min(slowest, size);
  double top = discrete ? nyquist : fastest * kBeyond;
  // With a delay alone, L crosses the negative axis for the first time below this frequency.
  if (!discrete && landmarks.delay > 0) top = std::max(top, 4 * std::numbers::pi / landmarks.delay);
  top = std::min(top, kBeyond * kFastest);
  const double bottom = slowest / kBeyond;
  std::vector<double> grid = loop_grid(landmarks, bottom, top);
  // In a stiff loop, an apparent integrator may be a lag.
  for (const double size : sizes)
    for (const double k : {0.1, 0.3, 1.0, 3.0, 10.0})
      if (k * size < bottom) grid.push_back(k * size);
  grid.push_back(0);
  std::sort(grid.begin(), grid.end());
  grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
  return grid;
}

std::vector<double> loop_grid(const Landmarks& landmarks, double low, double high) {
  std::vector<double> grid = landmarks.corners;
  const int steps = static_cast<int>(std::ceil(std::log10(high / low) * kPerDecade));
  low = high * std::pow(10, -steps / kPerDecade);
  for (int i = 0; i <= steps; ++i) grid.push_back(high * std::pow(10, -i / kPerDecade));
  for (const Resonance& root : resonances(landmarks)) add_resonance(root, grid);
  if (landmarks.delay > 0) {
    const double step = kPhaseStep / landmarks.delay;
    const double end = std::min(high, landmarks.delay_phase / landmarks.delay);
    for (int i = 1; i * step < end; ++i) grid.push_back(i * step);
  }
  std::erase_if(grid, [&](double w) { return !(w >= low && w <= high); });
  std::sort(grid.begin(), grid.end());
  // Closer frequencies come from landmarks that differ by rounding only, such as repeated poles.
  constexpr double kApart = 1e-11;
  grid.erase(
      std::unique(grid.begin(), grid.end(), [](double a, double b) { return b - a <= kApart * b; }),
      grid.end());
  grid.back() = high;
  return grid;
}

Peak highest_peak(const FrequencyFunction& f, const std::vector<double>& w,
                  const std::vector<double>& values) {
  constexpr double kEqual = 1e-10;   // peaks whose order depends on rounding
  constexpr double kPlateau = 1e-9;  // smaller local maxima on a plateau are rounding errors
  Peak best{-kInfinity, 0};
  for (std::size_t i = 0; i < w.size(); ++i)
    if (!(values[i] <= best.value + kEqual * std::abs(best.value)) && !std::isnan(values[i]))
      best = {values[i], w[i]};
  std::vector<std::pair<double, std::size_t>> tops;  // with their possible peaks
  for (std::size_t i = 1; i + 1 < w.size(); ++i) {
    const double before = values[i - 1], after = values[i + 1];
    if (values[i] >= before && values[i] >= after && std::isfinite(w[i + 1]) &&
        values[i] > (1 + kPlateau) * std::min(before, after))
      tops.emplace_back(possible_peak(values[i], predicted_peak(w, values, i)), i);
  }
  std::sort(tops.rbegin(), tops.rend());
  for (const auto& [possible, i] : tops) {
    if (!(possible > best.value)) break;
    Peak top = lowest_between([&](double at) { return -f(at); }, w[i - 1], w[i + 1]);
    top.value *= -1;
    const double equal = w[i] == best.w ? 0 : kEqual * std::abs(best.value);
    if (top.value > best.value + (top.w < best.w ? -equal : equal)) best = top;
  }
  return best;
}

Peak lowest_between(const FrequencyFunction& f, double low, double high, int bits) {
  // Boost's tolerance is relative to the argument; a normalized argument makes it relative to the
  // interval.
  const auto at = [&](double share) { return low + share * (high - low); };
  boost::uintmax_t steps = 100;
  const auto [share, value] = boost::math::tools::brent_find_minima(
      [&](double x) { return f(at(x)); }, 0.0, 1.0, bits, steps);
  return {value, at(share)};
}

double crossing(const FrequencyFunction& f, double low, double high, double at_low,
                double at_high) {
  // toms748_solve() interpolates and therefore requires finite values.
  const auto finite = [](double value) {
    constexpr double kLargest = 1e100;
    return std::isnan(value) ? 0 : std::clamp(value, -kLargest, kLargest);
  };
  boost::uintmax_t steps = 200;
  const auto [a, b] = boost::math::tools::toms748_solve(
      [&](double w) { return finite(f(w)); }, low, high, finite(at_low), finite(at_high),
      boost::math::tools::eps_tolerance<double>(), steps);
  return a + (b - a) / 2;
}

std::vector<double> crossings(const FrequencyFunction& f, const std::vector<double>& w,
                              const std::vector<double>& values,
                              const std::function<bool(std::size_t)>& certain) {
  const auto is_certain = [&](std::size_t i) { return values[i] != 0 && certain(i); };
  std::vector<double> found;
  for (std::size_t i = 0; i + 1 < w.size();) {
    if (values[i] * values[i + 1] > 0) {
      ++i;
      continue;
    }
    std::size_t end = i + 1;  // one past the last certain value up to i
    while (end > 0 && !is_certain(end - 1)) --end;
    std::size_t right = i + 1;
    while (right < w.size() && !is_certain(right)) ++right;
    if (end > 0 && right < w.size() && values[end - 1] * values[right] < 0)
      found.push_back(crossing(f, w[end - 1], w[right], values[end - 1], values[right]));
    i = right;
  }
  return found;
}

}  // namespace internal

}  // namespace quadtune
