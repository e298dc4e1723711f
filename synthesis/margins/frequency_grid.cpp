// SPDX-License-Identifier: Apache-2.0
#include "margins/frequency_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "margins/brent_maximum.hpp"

namespace quadtune {

namespace {

constexpr double kPerDecade = 40;
/// How far the grid reaches beyond the slowest and the fastest landmark.
constexpr double kBeyond = 1e3;
constexpr double kPhaseStep = 0.2;  ///< [rad] that a delay may turn between two frequencies
constexpr std::size_t kMostForDelay = 5000;

/// A pole or zero as a resonance: its frequency and its distance to the boundary [rad/s].
struct Landmark {
  double w;
  double width;
};

void add_landmarks(const Eigen::VectorXcd& roots, double dt, std::vector<Landmark>& all) {
  for (const std::complex<double>& root : roots) {
    // Where a discrete root would be in continuous time; one at 0 is a delay and has no frequency.
    const std::complex<double> s = dt > 0 ? std::log(root) / dt : root;
    if (!std::isfinite(s.real()) || !std::isfinite(s.imag())) continue;
    all.push_back({std::abs(s.imag()), std::abs(s.real())});
  }
}

}  // namespace

std::vector<double> frequency_grid(const OpenLoop& loop) {
  std::vector<Eigen::VectorXcd> roots{loop.poles(), loop.closed_loop_poles()};
  if (loop.size() == 1) roots.push_back(loop.zeros());
  return internal::grid_around(roots, loop.dt(), loop.delay());
}

namespace internal {

std::vector<double> grid_around(const std::vector<Eigen::VectorXcd>& roots, double dt,
                                double delay) {
  const bool discrete = dt > 0;
  std::vector<Landmark> landmarks;
  for (const Eigen::VectorXcd& of : roots) add_landmarks(of, dt, landmarks);
  const double nyquist = discrete ? std::numbers::pi / dt : 0;
  double fastest = discrete ? nyquist : 1e-12;
  for (const Landmark& mark : landmarks)
    if (!discrete) fastest = std::max(fastest, std::hypot(mark.w, mark.width));
  // What is smaller than rounding beside the fastest is an integrator.
  double slowest = fastest;
  for (const Landmark& mark : landmarks) {
    const double size = std::hypot(mark.w, mark.width);
    if (size > 1e-10 * fastest) slowest = std::min(slowest, size);
  }
  double top = discrete ? nyquist : fastest * kBeyond;
  // A delay alone turns L through the first crossing of the negative axis below this.
  if (!discrete && delay > 0) top = std::max(top, 4 * std::numbers::pi / delay);
  const double bottom = std::min(slowest, top) / kBeyond;
  std::vector<double> grid{0};
  const auto steps = static_cast<int>(std::ceil(std::log10(top / bottom) * kPerDecade));
  for (int i = 0; i <= steps; ++i)
    grid.push_back(bottom * std::pow(top / bottom, double(i) / steps));
  for (const Landmark& mark : landmarks) {
    grid.push_back(std::hypot(mark.w, mark.width));
    for (const double k : {0.0, 0.1, 0.3, 0.6, 1.0, 1.5, 2.5, 4.0, 8.0})
      for (const double side : {-k, k}) grid.push_back(mark.w + side * mark.width);
  }
  if (delay > 0) {
    const double step = kPhaseStep / delay;
    for (std::size_t i = 1; i <= kMostForDelay && double(i) * step < top; ++i)
      grid.push_back(double(i) * step);
  }
  if (discrete) grid.push_back(nyquist);
  std::erase_if(grid, [&](double w) { return !(w >= 0) || w > top; });
  std::sort(grid.begin(), grid.end());
  grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
  return grid;
}

double refine_root(const std::function<double(double)>& f, double low, double high) {
  const bool rises = f(high) > 0;
  constexpr int kMaxHalvings = 100;
  for (int i = 0; i < kMaxHalvings; ++i) {
    // Halving the logarithm, where the ends are decades apart, takes fewer steps.
    const double middle =
        low > 0 && high > 4 * low ? std::sqrt(low * high) : low + 0.5 * (high - low);
    if (middle <= low || middle >= high) break;
    ((f(middle) > 0) == rises ? high : low) = middle;
  }
  return high;
}

std::pair<double, double> refine_peak(const std::function<double(double)>& f,
                                      const std::vector<double>& grid,
                                      const std::vector<double>& values, double width) {
  constexpr double kNear = 0.7;
  if (grid.empty()) return {0, 0};
  const auto largest = std::max_element(values.begin(), values.end());
  std::pair<double, double> best{*largest,
                                 grid[static_cast<std::size_t>(largest - values.begin())]};
  const double level = kNear * *largest;
  for (std::size_t i = 1; i + 1 < grid.size(); ++i) {
    if (values[i] < level || values[i] < values[i - 1] || values[i] < values[i + 1]) continue;
    best = std::max(best, brent_maximum(f, grid[i - 1], grid[i + 1], width * grid[i + 1]));
  }
  return best;
}

}  // namespace internal

}  // namespace quadtune
