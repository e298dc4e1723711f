// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/pid/cascade_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <ostream>

#include "cascade/cascade_model.hpp"
#include "lyapunov/eigenvalues.hpp"
#include "pid/gain_search.hpp"
#include "quadtune/cascade.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/border.hpp"
#include "quadtune/internal/enum_names.hpp"

namespace quadtune {
namespace {

using Complex = std::complex<double>;
using internal::CascadeResponses;
using internal::GainInterval;
using internal::GainPoint;

/// Maximizes Ki, or Kp of a loop without integral.
class LoopProblem : public internal::GainProblem {
 public:
  /// @param responses  must outlive the problem
  LoopProblem(const CascadeResponses& responses, const CascadeLoopBounds& bounds)
      : responses_(responses), bounds_(bounds) {}

  [[nodiscard]] PidGains gains(const GainPoint& x, double log_gain) const override {
    const double max = std::exp(log_gain);
    const double Kd = std::exp(x.log_Kd);
    return bounds_.integral ? PidGains{std::exp(x.log_Kp), max, Kd, 0} : PidGains{max, 0, Kd, 0};
  }
  [[nodiscard]] const std::vector<double>& grid() const override { return responses_.grid(); }
  void forbid_on_grid(const PidGains& base, std::vector<GainInterval>& forbidden) const override {
    for (std::size_t k = 0; k < grid().size(); ++k)
      forbid_with(base, grid()[k], responses_.points()[k], forbidden);
    forbid_by_structure(base, grid().front(), forbidden);
  }
  void forbid_at(const PidGains& base, double w,
                 std::vector<GainInterval>& forbidden) const override {
    forbid_with(base, w, responses_.at(w), forbidden);
    forbid_by_structure(base, w, forbidden);
  }
  [[nodiscard]] bool stable(const PidGains& g) const override { return responses_.stable(g); }

  [[nodiscard]] double excess(const PidGains& g) const override {
    const double Ms = responses_.Ms(g);
    double worst = std::max(Ms / bounds_.Ms_max, g.Kd * Ms / bounds_.rate_noise_max);
    if (std::isfinite(bounds_.value_noise_max))
      worst = std::max(worst, responses_.value_noise(g) / bounds_.value_noise_max);
    if (std::isfinite(bounds_.tracking_max))
      worst = std::max(worst, responses_.tracking_peak(g) / bounds_.tracking_max);
    constexpr double kUnlimited = 1e2;
    return std::isfinite(worst) ? std::log(worst) : kUnlimited;
  }
  [[nodiscard]] double load_excess(const PidGains& g) const override {
    if (!std::isfinite(bounds_.load_peak_max)) return 0;
    return std::log(internal::load_step(responses_.closed(g)).peak / bounds_.load_peak_max);
  }

 private:
  void forbid_by_structure(const PidGains& base, double w,
                           std::vector<GainInterval>& forbidden) const {
    if (bounds_.p_pi && bounds_.integral)
      forbidden.push_back(
          {max_p_pi_integral(base.Kp, base.Kd), std::numeric_limits<double>::infinity(), w});
  }
  void forbid_with(const PidGains& base, double w, const CascadeResponses::Point& p,
                   std::vector<GainInterval>& forbidden) const {
    const Complex value_slope = bounds_.integral ? p.integral : 1.0;  // of the value feedback
    const internal::AffineResponse returned{1.0 + base.Kp * p.value + base.Kd * p.rate,
                                            value_slope * p.value};
    const double min = std::max(1 / bounds_.Ms_max, base.Kd / bounds_.rate_noise_max);
    internal::forbid(returned, {}, min, w, forbidden);
    const auto bound = [&](double max, Complex through) {
      if (std::isfinite(max))
        internal::forbid(returned, {base.Kp * through / max, value_slope * through / max}, 0, w,
                         forbidden);
    };
    bound(bounds_.value_noise_max, 1);
    bound(bounds_.tracking_max, p.value);
  }

  const CascadeResponses& responses_;
  CascadeLoopBounds bounds_;
};

/// Starting points: a scan of Kd downwards from `high_Kd`, unless it is fixed, and of value
/// feedbacks up to eighty times slower than `fastest` [rad/s].
std::vector<GainPoint> starts(const CascadeLoopBounds& bounds, double high_Kd, double fastest) {
  const int kd = bounds.rate_crossover > 0 ? 1 : 24;
  const int kp = bounds.integral ? 30 : 1;
  std::vector<GainPoint> points;
  for (int k = 0; k < kd; ++k)
    for (int i = 0; i < kp; ++i) {
      const double log_Kd = std::log(high_Kd) - 0.15 * k;
      points.push_back({log_Kd + std::log(fastest) - 0.15 * i, log_Kd});
    }
  return points;
}

void require_bounds(const CascadeLoopBounds& bounds, double dt) {
  const char* where = "cascade loop";
  const double nyquist = std::numbers::pi / dt;
  if (!(bounds.rate_crossover >= 0) || !(bounds.rate_crossover < nyquist))
    throw InvalidInput(where, fmt::format("the rate crossover is {} rad/s, expected more than 0 "
                                          "and less than pi/dt = {:.6g}",
                                          bounds.rate_crossover, nyquist));
  if (!(bounds.Ms_max > 1) || !(bounds.tracking_max > 1))
    throw InvalidInput(
        where, fmt::format("Ms_max is {} and tracking_max {}, expected more than 1 because an "
                           "integral makes both at least 1",
                           bounds.Ms_max, bounds.tracking_max));
  if (!(bounds.value_noise_max > 0) || !(bounds.rate_noise_max > 0) ||
      !(bounds.rate_crossover_max > 0))
    throw InvalidInput(where,
                       "a bound on noise or crossover is not positive, expected positive bounds");
}

/// Computes the maximum crossover of the rate feedback alone for which max |S| is at most Ms.
double highest_rate_crossover(const CascadeResponses& responses, double Ms) {
  const auto keeps = [&](double w) {
    const PidGains gains{0, 0, 1 / std::abs(responses.at(w).rate), 0};
    if (!(responses.Ms(gains) <= Ms)) return false;
    // The value, the integral of the rate, is not fed back: its pole at 1 remains. All other poles
    // must be inside the unit circle.
    const Eigen::VectorXcd poles = internal::eigenvalues(responses.closed(gains).A);
    return (poles.cwiseAbs().array() < 1 + 1e-6).all();
  };
  const std::vector<double>& grid = responses.grid();
  const auto first = std::find_if_not(grid.begin(), grid.end(), keeps);
  if (first == grid.begin()) return 0;
  if (first == grid.end()) return grid.back();
  return internal::border(keeps, *std::prev(first), *first, 1e-13).holds;
}

/// Whether the evidence satisfies the bounds. It is computed by other methods and at other
/// frequencies than in the search.
bool kept(const CascadeLoopBounds& bounds, const CascadeLoopEvidence& evidence) {
  constexpr double kSlack = 1 + 1e-4;
  return evidence.margins.stable && evidence.margins.Ms <= kSlack * bounds.Ms_max &&
         evidence.tracking_peak <= kSlack * bounds.tracking_max &&
         evidence.value_noise <= kSlack * bounds.value_noise_max &&
         evidence.rate_noise <= kSlack * bounds.rate_noise_max;
}

std::string describe(const CascadeLoopBounds& bounds) {
  std::string text = fmt::format("Ms <= {:.6g}", bounds.Ms_max);
  const auto add = [&](const char* name, double bound) {
    if (std::isfinite(bound)) text += fmt::format(", {} <= {:.4g}", name, bound);
  };
  add("tracking peak", bounds.tracking_max);
  add("load peak", bounds.load_peak_max);
  add("value noise", bounds.value_noise_max);
  add("rate noise", bounds.rate_noise_max);
  return text;
}

}  // namespace

constexpr internal::EnumName<CascadeLoopStatus> kCascadeLoopStatuses[] = {
    {CascadeLoopStatus::not_run, "not run"},
    {CascadeLoopStatus::solved, "solved"},
    {CascadeLoopStatus::crossover_infeasible, "crossover out of reach"},
    {CascadeLoopStatus::not_found, "not found"}};

std::string to_string(CascadeLoopStatus status) {
  return internal::name_in(kCascadeLoopStatuses, status);
}

std::ostream& operator<<(std::ostream& out, const CascadeLoopDesign& design) {
  out << to_string(design.status);
  if (!design.solved()) return out << ": " << design.culprit;
  return out << ": " << design.gains << ", " << design.evidence.margins;
}

CascadeLoopDesign design_cascade_loop(const CascadePlant& plant, const CascadeLoopBounds& bounds,
                                      PidMethod method) {
  internal::require_cascade_plant(plant);
  require_bounds(bounds, plant.dt);
  CascadeLoopDesign design;
  design.highest_rate_crossover =
      highest_rate_crossover(CascadeResponses(plant, method, 0), bounds.Ms_max);
  const bool fixed = bounds.rate_crossover > 0;
  if (fixed && bounds.rate_crossover >= design.highest_rate_crossover) {
    design.status = CascadeLoopStatus::crossover_infeasible;
    design.culprit = fmt::format(
        "the crossover of the rate loop is {:.4g} rad/s, expected less than {:.4g} rad/s, "
        "where the hold, the lag and the delay already raise max |S| of the rate loop alone to "
        "{:.4g}",
        bounds.rate_crossover, design.highest_rate_crossover, bounds.Ms_max);
    return design;
  }
  const double reach = std::min(bounds.rate_crossover_max, design.highest_rate_crossover);
  const double fastest = fixed ? bounds.rate_crossover : reach;
  // The scan covers value feedbacks up to eighty times slower, and their integrals are even slower.
  const CascadeResponses responses(plant, method, 1e-4 * fastest);
  const auto Kd_for = [&](double w) { return 1 / std::abs(responses.at(w).rate); };
  const LoopProblem problem(responses, bounds);
  internal::GainSearch search(problem);
  const double high_Kd = Kd_for(fastest);
  const GainPoint best = search.climb(search.best_of(starts(bounds, high_Kd, fastest)),
                                      {.over_Kp = bounds.integral,
                                       .over_Kd = !fixed,
                                       .Kp_reach = 0.2,
                                       .Kd_reach = 0.2,
                                       .Kd_width = 1e-5,
                                       .log_Kd_max = std::log(high_Kd)});
  const internal::MaxGain max = search.max(best);
  if (!max.within_bounds()) {
    design.status = CascadeLoopStatus::not_found;
    design.culprit = "no stabilizing gains were found with " + describe(bounds);
    return design;
  }
  const PidGains gains = problem.gains(best, max.log_gain);
  const CascadeLoopEvidence evidence = cascade_loop_evidence(plant, gains, method);
  if (!kept(bounds, evidence)) {
    design.status = CascadeLoopStatus::not_found;
    design.culprit = fmt::format(
        "the gains violate the bounds outside the frequencies of the search: a loop with the "
        "crossover {:.3g} rad/s is too slow for a period of {:.3g} s",
        fastest, plant.dt);
    return design;
  }
  design.status = CascadeLoopStatus::solved;
  design.gains = gains;
  design.evidence = evidence;
  const auto note = [&](double met, double bound, const char* name) {
    if (met > 0.999 * bound) design.binding.emplace_back(name);
  };
  if (bounds.p_pi && bounds.integral)
    note(gains.Ki, max_p_pi_integral(gains.Kp, gains.Kd), "structure");
  note(design.evidence.margins.Ms, bounds.Ms_max, "Ms");
  note(design.evidence.tracking_peak, bounds.tracking_max, "tracking");
  note(design.evidence.load_peak, bounds.load_peak_max, "load peak");
  note(design.evidence.value_noise, bounds.value_noise_max, "value noise");
  note(design.evidence.rate_noise, bounds.rate_noise_max, "rate noise");
  if (!fixed) note(design.gains.Kd, high_Kd, "rate crossover");
  return design;
}

}  // namespace quadtune
