// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/pid/pid_optimum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "pid/gain_search.hpp"
#include "pid/loop_shape.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/synthesis/pid/pid_rules.hpp"

namespace quadtune {
namespace {

using internal::forbid;
using internal::GainInterval;
using internal::GainPoint;
using internal::LoopShape;
using internal::SensitivityPeaks;
using Complex = std::complex<double>;

void validate_bounds(const PidBounds& bounds, PidType type, double Tf) {
  const char* where = "max_integral_gain";
  if (type != PidType::PI && type != PidType::PID)
    throw InvalidInput(where, fmt::format("type is {}, expected PI or PID because the others have "
                                          "no integral gain",
                                          to_string(type)));
  for (const auto& [name, peak] : {std::pair("Ms_max", bounds.Ms_max), {"Mt_max", bounds.Mt_max}})
    if (!(peak > 1))
      throw InvalidInput(where,
                         fmt::format("{} is {}, expected more than 1 because no loop with integral "
                                     "action has less",
                                     name, peak));
  if (!(bounds.noise_gain_max > 0))
    throw InvalidInput(
        where, fmt::format("noise_gain_max is {}, expected more than 0", bounds.noise_gain_max));
  if (!(Tf >= 0) || !std::isfinite(Tf))
    throw InvalidInput(where, fmt::format("Tf is {} s, expected 0 or more", Tf));
  if (type == PidType::PID && Tf == 0 && std::isfinite(bounds.noise_gain_max))
    throw InvalidInput(
        where,
        "Tf is 0 s with a bound on the noise gain, expected more than 0, because the "
        "noise gain of a derivative without a filter is infinite");
}

/// Maximizes Ki for one transfer function; Kp and Kd are searched.
class IntegralProblem : public internal::GainProblem {
 public:
  IntegralProblem(const ContinuousTransferFunction& plant, PidType type, const PidBounds& bounds,
                  double Tf)
      : plant_(plant),
        with_derivative_(type == PidType::PID),
        bounds_(bounds),
        Tf_(with_derivative_ ? Tf : 0),
        shape_(plant, {Tf_ > 0 ? 1 / Tf_ : 0}),
        sign_(shape_.low_frequency_sign()) {}

  [[nodiscard]] PidGains gains(const GainPoint& x, double log_Ki) const override {
    return {sign_ * std::exp(x.log_Kp), sign_ * std::exp(log_Ki),
            with_derivative_ ? sign_ * std::exp(x.log_Kd) : 0, Tf_};
  }
  [[nodiscard]] const std::vector<double>& grid() const override { return shape_.grid(); }
  void forbid_on_grid(const PidGains& base, std::vector<GainInterval>& forbidden) const override {
    for (std::size_t k = 0; k < grid().size(); ++k)
      forbid_with(base, grid()[k], sign_ * shape_.plant_responses()[k], forbidden);
  }
  void forbid_at(const PidGains& base, double w,
                 std::vector<GainInterval>& forbidden) const override {
    forbid_with(base, w, sign_ * plant_({0, w}), forbidden);
  }
  [[nodiscard]] bool stable(const PidGains& g) const override { return shape_.stable(g); }

  [[nodiscard]] double excess(const PidGains& g) const override {
    const SensitivityPeaks peaks = shape_.peaks(g);
    double worst = std::max(peaks.Ms / bounds_.Ms_max, peaks.Mt / bounds_.Mt_max);
    if (std::isfinite(bounds_.noise_gain_max))
      worst = std::max(worst, shape_.noise_gain(g) / bounds_.noise_gain_max);
    constexpr double kUnlimited = 1e2;
    return std::isfinite(worst) ? std::log(worst) : kUnlimited;
  }

  [[nodiscard]] bool is_unlimited(const GainPoint& x, double reached) const override {
    if (!std::isfinite(reached)) return false;
    const double beyond = reached > 0 ? 2 * reached : std::exp(x.log_Kp) * grid().front();
    return stable(gains(x, std::log(beyond)));
  }

  /// Starting points: a scan over crossovers, and the AMIGO gains.
  [[nodiscard]] std::vector<GainPoint> starts() const {
    std::vector<GainPoint> points;
    const auto add = [&](double Kp, double Td) {
      points.push_back({std::log(Kp), std::log(Kp * Td)});
    };
    const double ratio = grid().back() / grid().front();
    for (int k = 0; k <= 60; ++k) {
      const double w = grid().front() * std::pow(ratio, k / 60.0);
      const double size = std::abs(plant_({0, w}));
      if (!(size > 0) || !std::isfinite(size)) continue;
      for (const double part : {0.1, 0.3, 0.8})
        for (const double lead : {0.1, 0.5, 2.0}) add(part / size, lead / w);
    }
    const LagFit<FopdtModel> fit = fit_fopdt(plant_);
    if (fit.fitted() && fit.model.delay > 0) {
      const PidStandard rule = standard_form(amigo(PidType::PID, fit.model));
      add(std::abs(rule.K), rule.Td);
    }
    return points;
  }

  [[nodiscard]] const LoopShape& shape() const { return shape_; }
  [[nodiscard]] double Tf() const { return Tf_; }

 private:
  void forbid_with(const PidGains& base, double w, Complex P,
                   std::vector<GainInterval>& forbidden) const {
    const Complex integral = 1.0 / Complex(0, w);
    const Complex C = sign_ * base({0, w});
    const Complex L = C * P;
    const Complex slope = P * integral;  // dL/dKi
    const internal::AffineResponse returned{1.0 + L, slope};
    forbid(returned, {}, 1 / bounds_.Ms_max, w, forbidden);
    if (std::isfinite(bounds_.Mt_max))
      forbid(returned, {L / bounds_.Mt_max, slope / bounds_.Mt_max}, 0, w, forbidden);
    if (std::isfinite(bounds_.noise_gain_max))
      forbid(returned, {C / bounds_.noise_gain_max, integral / bounds_.noise_gain_max}, 0, w,
             forbidden);
  }

  ContinuousTransferFunction plant_;
  bool with_derivative_;
  PidBounds bounds_;
  double Tf_;
  LoopShape shape_;
  double sign_;  ///< sign of the plant's low-frequency response and of the gains
};

/// Whether Ki may grow without bound: the loop K/s, for any K, is within reach of the controller.
/// High gain then only brings S nearer to 0 and T nearer to 1.
bool is_unbounded(const ContinuousTransferFunction& plant, PidType type, const PidBounds& bounds,
                  double Tf) {
  if (plant.delay > 0 || std::isfinite(bounds.noise_gain_max)) return false;
  const Eigen::VectorXd num = without_leading_zeros(plant.num);
  const Eigen::VectorXcd zeros = polynomial_roots(num);
  if (zeros.size() > 0 && !(zeros.real().maxCoeff() < 0)) return false;
  return plant.den.size() - num.size() <= (type == PidType::PID && Tf == 0 ? 2 : 1);
}

/// "Ms <= 1.4 and a noise gain <= 20": the bounds that are finite.
std::string describe(const PidBounds& bounds) {
  std::vector<std::string> parts;
  const auto add = [&](const char* name, double bound) {
    if (std::isfinite(bound)) parts.push_back(fmt::format("{} <= {:.4g}", name, bound));
  };
  add("Ms", bounds.Ms_max);
  add("Mt", bounds.Mt_max);
  add("a noise gain", bounds.noise_gain_max);
  return internal::joined(parts, " and ");
}

std::string unlimited(PidType type) {
  return fmt::format(
      "Ki of a {} is unbounded: the plant has neither enough delay "
      "nor enough lag to limit it",
      to_string(type));
}

/// The optimum to which the search climbs from a start; solved only if its loop meets the bounds.
PidOptimum climbed(const IntegralProblem& problem, internal::GainSearch& search,
                   const internal::GainPoint& start, const ContinuousTransferFunction& plant,
                   PidType type, const PidBounds& bounds) {
  PidOptimum optimum;
  optimum.status = PidOptimumStatus::not_found;
  optimum.culprit = fmt::format("the search found no {} whose loop is stable with {}",
                                to_string(type), describe(bounds));
  const GainPoint best = search.climb(start, {.over_Kd = type == PidType::PID});
  const internal::MaxGain max = search.max(best);
  if (!max.within_bounds()) return optimum;
  const LoopShape& shape = problem.shape();
  // A first-order loop is stable with any gain, also within a bound of the noise gain: the search
  // then ends at the end of its grid. Any other loop may have its maximum at a Kp of almost 0.
  PidBounds any_noise = bounds;
  any_noise.noise_gain_max = std::numeric_limits<double>::infinity();
  if (!(max.log_gain < std::log(shape.grid().back() / 10) + best.log_Kp) &&
      is_unbounded(plant, type, any_noise, problem.Tf())) {
    optimum.status = PidOptimumStatus::unbounded;
    optimum.culprit = unlimited(type);
    return optimum;
  }
  const PidGains gains = problem.gains(best, max.log_gain);
  if (!std::isfinite(gains.Ki) || !std::isfinite(gains.Kp) || !shape.stable(gains)) return optimum;
  const SensitivityPeaks peaks = shape.peaks(gains);
  constexpr double kMet = 1.001;
  const double noise_gain = shape.noise_gain(gains);
  if (!(peaks.Ms <= kMet * bounds.Ms_max) || !(peaks.Mt <= kMet * bounds.Mt_max) ||
      !(noise_gain <= kMet * bounds.noise_gain_max))
    return optimum;
  optimum.status = PidOptimumStatus::solved;
  optimum.culprit.clear();
  optimum.gains = gains;
  optimum.Ms = peaks.Ms;
  optimum.Mt = peaks.Mt;
  optimum.noise_gain = noise_gain;
  return optimum;
}

}  // namespace

constexpr internal::EnumName<PidOptimumStatus> kPidOptimumStatuses[] = {
    {PidOptimumStatus::not_run, "not run"},
    {PidOptimumStatus::solved, "solved"},
    {PidOptimumStatus::not_found, "not found"},
    {PidOptimumStatus::unbounded, "unbounded"}};

std::string to_string(PidOptimumStatus status) {
  return internal::name_in(kPidOptimumStatuses, status);
}

std::ostream& operator<<(std::ostream& out, const PidOptimum& optimum) {
  out << to_string(optimum.status);
  if (!optimum.solved()) return out << ": " << optimum.culprit;
  out << ": " << optimum.gains
      << fmt::format(", Ms {:.4g}, Mt {:.4g}, noise gain {:.4g}, bound by", optimum.Ms, optimum.Mt,
                     optimum.noise_gain);
  for (const std::string& name : optimum.binding) out << " " << name;
  return out;
}

PidOptimum max_integral_gain(const ContinuousTransferFunction& plant, PidType type,
                             const PidBounds& bounds, double Tf) {
  quadtune::validate(plant, "max_integral_gain");
  validate_bounds(bounds, type, Tf);
  if (plant.num.isZero(0))
    throw InvalidInput("max_integral_gain",
                       "num is 0, expected a plant that responds to its input");
  PidOptimum optimum;
  if (is_unbounded(plant, type, bounds, Tf)) {
    optimum.status = PidOptimumStatus::unbounded;
    optimum.culprit = unlimited(type);
    return optimum;
  }
  const IntegralProblem problem(plant, type, bounds, Tf);
  internal::GainSearch search(problem);
  optimum = climbed(problem, search, search.best_of(problem.starts()), plant, type, bounds);
  // A loose bound forbids only a small region near -1, which the frequencies of the grid may miss,
  // so that the climb ends where the loop is unstable. Gains within a tighter bound are within this
  // one: the climb starts again from them.
  constexpr double kLoose = 2;
  int evaluations = 0;  // within the tighter bounds
  if (std::isfinite(bounds.Ms_max) && bounds.Ms_max > kLoose) {
    PidBounds tighter = bounds;
    tighter.Ms_max = bounds.Ms_max > 2 * kLoose ? std::max(2 * kLoose, bounds.Ms_max / 2)
                                                : std::max(kLoose, bounds.Ms_max / 1.2);
    const PidOptimum inside = max_integral_gain(plant, type, tighter, Tf);
    evaluations = inside.evaluations;
    if (inside.solved()) {
      const GainPoint start = {std::log(std::abs(inside.gains.Kp)),
                               inside.gains.Kd == 0 ? 0 : std::log(std::abs(inside.gains.Kd))};
      for (const PidOptimum& other : {climbed(problem, search, start, plant, type, bounds), inside})
        if (other.solved() &&
            (!optimum.solved() || std::abs(other.gains.Ki) > std::abs(optimum.gains.Ki)))
          optimum = other;
    }
  }
  optimum.evaluations = evaluations + search.evaluations();
  if (!optimum.solved()) return optimum;
  optimum.binding.clear();
  const auto binds = [](double met, double bound) { return met > 0.999 * bound; };
  if (binds(optimum.Ms, bounds.Ms_max)) optimum.binding.emplace_back("Ms");
  if (binds(optimum.Mt, bounds.Mt_max)) optimum.binding.emplace_back("Mt");
  if (binds(optimum.noise_gain, bounds.noise_gain_max)) optimum.binding.emplace_back("noise gain");
  return optimum;
}

}  // namespace quadtune
