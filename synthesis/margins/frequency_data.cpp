// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/frequency_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "margins/crossover_margins.hpp"
#include "margins/disk.hpp"
#include "margins/loop_grid.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"

namespace quadtune {

using Eigen::Index;

namespace {

using Complex = std::complex<double>;
using internal::Peak;
constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// The samples as logarithms, with a continuous phase.
class DataCurve {
 public:
  explicit DataCurve(const FrequencyData& data) {
    const Index n = data.w.size();
    log_w_ = data.w.array().log();
    log_L_ = data.G.cwiseAbs().array().log();
    phase_.resize(n);
    phase_[0] = std::arg(data.G[0]);
    for (Index i = 1; i < n; ++i)
      phase_[i] = phase_[i - 1] + std::remainder(std::arg(data.G[i]) - phase_[i - 1], kTurn);
  }

  [[nodiscard]] Index intervals() const { return log_w_.size() - 1; }
  [[nodiscard]] double phase_step(Index i) const { return phase_[i + 1] - phase_[i]; }

  /// L at the fraction u of interval i.
  [[nodiscard]] Complex at(Index i, double u) const {
    return std::polar(std::exp(std::lerp(log_L_[i], log_L_[i + 1], u)),
                      std::lerp(phase_[i], phase_[i + 1], u));
  }
  [[nodiscard]] double frequency(Index i, double u) const {
    return std::exp(std::lerp(log_w_[i], log_w_[i + 1], u));
  }
  /// L at a frequency within the data.
  [[nodiscard]] Complex at(double w) const {
    const double x = std::log(w);
    const auto above = std::upper_bound(log_w_.begin() + 1, log_w_.end() - 1, x);
    const Index i = above - log_w_.begin() - 1;
    return at(i, std::clamp((x - log_w_[i]) / (log_w_[i + 1] - log_w_[i]), 0.0, 1.0));
  }

  /// Calls visit(i, u) for each point at which |L| = 1. A sample counts for the interval that
  /// begins with it, the last one for the last interval.
  template <class Visit>
  void each_gain_crossing(const Visit& visit) const {
    for (Index i = 0; i < intervals(); ++i)
      crossing_of(log_L_[i], log_L_[i + 1], 0, i + 1 == intervals(),
                  [&](double u) { visit(i, u); });
  }
  /// Calls visit(i, u) for each point at which L is real and negative.
  template <class Visit>
  void each_phase_crossing(const Visit& visit) const {
    for (Index i = 0; i < intervals(); ++i) {
      const auto [low, high] = std::minmax(phase_[i], phase_[i + 1]);
      for (double k = std::ceil((low / std::numbers::pi - 1) / 2);
           (2 * k + 1) * std::numbers::pi <= high; ++k)
        crossing_of(phase_[i], phase_[i + 1], (2 * k + 1) * std::numbers::pi, i + 1 == intervals(),
                    [&](double u) { visit(i, u); });
    }
  }

 private:
  /// The point of an interval at which a linear function has the value `level`.
  template <class Visit>
  static void crossing_of(double first, double second, double level, bool is_last,
                          const Visit& visit) {
    const double a = first - level;
    const double b = second - level;
    if (a == 0 && b == 0) return;  // no isolated crossing
    if (a == 0 || (a < 0) != (b < 0)) {
      if (b == 0 && !is_last) return;  // of the next interval
      visit(a / (a - b));
    } else if (b == 0 && is_last) {
      visit(1.0);
    }
  }

  Eigen::VectorXd log_w_, log_L_, phase_;
};

void compute_crossovers(const DataCurve& curve, LoopMargins& margins) {
  curve.each_gain_crossing([&](Index i, double u) {
    const double w = curve.frequency(i, u);
    double phase = std::remainder(std::arg(curve.at(i, u)) + std::numbers::pi, kTurn);
    if (phase <= -std::numbers::pi) phase += kTurn;
    margins.gain_crossovers.push_back({w, phase, (phase > 0 ? phase : phase + kTurn) / w});
  });
  curve.each_phase_crossing([&](Index i, double u) {
    margins.phase_crossovers.push_back({curve.frequency(i, u), 1 / std::abs(curve.at(i, u))});
  });
  const auto by_frequency = [](const auto& a, const auto& b) { return a.w < b.w; };
  std::sort(margins.phase_crossovers.begin(), margins.phase_crossovers.end(), by_frequency);
  internal::set_margins_of_crossovers(margins);
}

/// The maximum of |S + offset| of the interpolated curve.
Peak peak_of(const DataCurve& curve, const std::vector<double>& w, double offset) {
  const auto size = [&](double at) { return std::abs(1.0 / (1.0 + curve.at(at)) + offset); };
  std::vector<double> values;
  values.reserve(w.size());
  for (const double at : w) values.push_back(size(at));
  const auto infinite = std::find_if(values.begin(), values.end(),
                                     [](double value) { return !std::isfinite(value); });
  if (infinite != values.end())
    return {kUnbounded, w[static_cast<std::size_t>(infinite - values.begin())]};
  return internal::highest_peak(size, w, values);
}

}  // namespace

void validate(const FrequencyData& data, const std::string& where) {
  const Index n = data.w.size();
  if (n < 2 || data.G.size() != n)
    throw InvalidInput(where, fmt::format("has {} and {}, expected at least two of each",
                                          internal::counted(n, "frequency", "frequencies"),
                                          internal::counted(data.G.size(), "value")));
  for (Index i = 0; i < n; ++i) {
    if (!(data.w[i] > (i > 0 ? data.w[i - 1] : 0.0)) || !std::isfinite(data.w[i]))
      throw InvalidInput(where, fmt::format("frequency {} is {:.6g} rad/s, expected positive "
                                            "numbers in increasing order",
                                            i + 1, data.w[i]));
    const double size = std::abs(data.G[i]);
    if (!(size > 0) || !std::isfinite(size))
      throw InvalidInput(where,
                         fmt::format("the value at {:.6g} rad/s is {:.6g}, expected a finite "
                                     "number other than 0",
                                     data.w[i], size));
  }
}

FrequencyData open_loop_of(const FrequencyData& measured, MeasuredResponse what) {
  validate(measured, "frequency data");
  if (what == MeasuredResponse::loop) return measured;
  FrequencyData L = measured;
  for (Index i = 0; i < L.G.size(); ++i) {
    const Complex G = measured.G[i];
    L.G[i] = what == MeasuredResponse::sensitivity ? 1.0 / G - 1.0 : G / (1.0 - G);
    if (!std::isfinite(std::abs(L.G[i])) || L.G[i] == 0.0)
      throw InvalidInput(
          "frequency data",
          fmt::format("the value at {:.6g} rad/s is 1, expected another number "
                      "because L is {} there",
                      L.w[i], what == MeasuredResponse::sensitivity ? "0" : "infinite"));
  }
  return L;
}

FrequencyDataMargins frequency_data_margins(const FrequencyData& L, bool stable, double skew) {
  validate(L, "frequency_data_margins");
  if (!std::isfinite(skew))
    throw InvalidInput("frequency_data_margins",
                       fmt::format("skew is {}, expected a finite number", skew));
  const DataCurve curve(L);
  FrequencyDataMargins result;
  LoopMargins& margins = result.margins;
  margins.stable = stable;
  compute_crossovers(curve, margins);
  result.crosses_gain = !margins.gain_crossovers.empty();
  result.crosses_phase = !margins.phase_crossovers.empty();
  std::vector<double> w;  // the samples, and points between them at which the curve is searched
  constexpr int kParts = 16;
  for (Index i = 0; i < curve.intervals(); ++i) {
    for (int k = 0; k < kParts; ++k) w.push_back(curve.frequency(i, double{1} * k / kParts));
    if (std::abs(curve.phase_step(i)) > result.largest_phase_step) {
      result.largest_phase_step = std::abs(curve.phase_step(i));
      result.w_largest_phase_step = L.w[i];
    }
  }
  w.push_back(L.w[L.w.size() - 1]);
  const Peak S = peak_of(curve, w, 0), T = peak_of(curve, w, -1);  // |T| = |1 - S|
  margins.Ms = S.value;
  margins.w_Ms = S.w;
  margins.Mt = T.value;
  margins.w_Mt = T.w;
  if (stable) {
    const Peak disk = peak_of(curve, w, (skew - 1) / 2);
    margins.disk = internal::disk_of_peak(disk.value, disk.w, skew);
  }
  return result;
}

}  // namespace quadtune
