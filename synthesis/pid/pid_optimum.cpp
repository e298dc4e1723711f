// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/pid_optimum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <ostream>
#include <vector>

#include "pid/gain_gaps.hpp"
#include "pid/golden_section.hpp"
#include "pid/loop_shape.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/synthesis/pid_rules.hpp"

namespace quadtune {
namespace {

using internal::climb_from;
using internal::forbid;
using internal::GainInterval;
using internal::LoopShape;
using internal::SensitivityPeaks;
using Complex = std::complex<double>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// log Ki that no Kp and Kd with room for a Ki have: below it, points are told apart by how far
/// they are from the bounds.
constexpr double kNoRoom = -1e3;

void validate(const PidBounds& bounds, PidType type, double Tf) {
  const char* where = "greatest_integral_gain";
  if (type != PidType::PI && type != PidType::PID)
    throw InvalidInput(where, fmt::format("type is {}, expected PI or PID because the others have "
                                          "no integral gain",
                                          to_string(type)));
  if (!(bounds.Ms_max > 1) || !(bounds.Mt_max > 1))
    throw InvalidInput(where,
                       fmt::format("Ms_max is {} and Mt_max {}, expected more than 1 because "
                                   "integral action makes both at least 1",
                                   bounds.Ms_max, bounds.Mt_max));
  if (!(bounds.noise_gain_max > 0))
    throw InvalidInput(
        where, fmt::format("noise_gain_max is {}, expected more than 0", bounds.noise_gain_max));
  if (!(Tf >= 0) || !std::isfinite(Tf))
    throw InvalidInput(where, fmt::format("Tf is {} s, expected 0 or more", Tf));
  if (type == PidType::PID && Tf == 0 && std::isfinite(bounds.noise_gain_max))
    throw InvalidInput(where,
                       "Tf is 0 s with a bound on the noise gain, expected a filter because "
                       "without one the noise gain is infinite");
}

class Search {
 public:
  Search(const ContinuousTransferFunction& plant, PidType type, const PidBounds& bounds, double Tf)
      : plant_(plant),
        with_derivative_(type == PidType::PID),
        bounds_(bounds),
        Tf_(with_derivative_ ? Tf : 0),
        shape_(plant, {Tf_ > 0 ? 1 / Tf_ : 0}) {
    const auto last_coefficient = [](const Eigen::VectorXd& p) {
      Eigen::Index last = p.size() - 1;
      while (last > 0 && p[last] == 0) --last;
      return p[last];
    };
    sign_ = last_coefficient(plant.num) * last_coefficient(plant.den) < 0 ? -1 : 1;
    for (const double w : shape_.grid()) responses_.push_back(sign_ * plant_({0, w}));
  }

  struct Point {
    double log_Kp = 0;
    double log_Kd = 0;  ///< not used by PI
  };

  /// The best of a scan over crossovers and of AMIGO's gains.
  [[nodiscard]] Point start() {
    Point best;
    double value = -kInfinity;
    const auto consider = [&](double Kp, double Td) {
      const Point x = {std::log(Kp), std::log(Kp * Td)};
      const double found = log_greatest_Ki(x);
      if (!(found > value)) return;
      value = found;
      best = x;
    };
    const double first = shape_.grid().front();
    const double ratio = shape_.grid().back() / first;
    for (int k = 0; k <= 60; ++k) {
      const double w = first * std::pow(ratio, k / 60.0);
      const double size = std::abs(plant_({0, w}));
      if (!(size > 0) || !std::isfinite(size)) continue;
      for (const double part : {0.1, 0.3, 0.8})
        for (const double lead : {0.1, 0.5, 2.0}) consider(part / size, lead / w);
    }
    const LagFit<FopdtModel> fit = fit_fopdt(plant_);
    if (fit.fitted() && fit.model.delay > 0) {
      const PidStandard rule = standard_form(amigo(PidType::PID, fit.model));
      consider(std::abs(rule.K), rule.Td);
    }
    return best;
  }

  /// Over Kp for every Kd: where two bounds meet there is a ridge, along which a step in both at
  /// once would be needed.
  [[nodiscard]] Point climb(Point x) {
    const auto best_Kp = [&](double log_Kd) {
      x.log_Kp = climb_from(
          [&](double log_Kp) {
            return log_greatest_Ki({log_Kp, log_Kd});
          },
          x.log_Kp, 0.5);
      return x.log_Kp;
    };
    if (with_derivative_)
      x.log_Kd = climb_from(
          [&](double log_Kd) {
            return log_greatest_Ki({best_Kp(log_Kd), log_Kd});
          },
          x.log_Kd, 0.7);
    x.log_Kp = best_Kp(x.log_Kd);
    return x;
  }

  [[nodiscard]] PidGains gains(const Point& x, double log_Ki) const {
    PidGains g;
    g.Kp = sign_ * std::exp(x.log_Kp);
    g.Ki = sign_ * std::exp(log_Ki);
    g.Kd = with_derivative_ ? sign_ * std::exp(x.log_Kd) : 0;
    g.Tf = Tf_;
    return g;
  }

  /// Infinite where nothing ends Ki; below kNoRoom where the bounds leave none. What all
  /// frequencies forbid leaves gaps, in each of which the loop is stable or not as a whole: the
  /// highest that is.
  [[nodiscard]] double log_greatest_Ki(const Point& x) {
    ++evaluations_;
    const PidGains proportional = gains(x, -kInfinity);
    std::vector<GainInterval>& all = forbidden_;
    all.clear();
    for (std::size_t k = 0; k < responses_.size(); ++k)
      forbid_at(proportional, shape_.grid()[k], responses_[k], all);
    double reached = 0;
    const std::vector<GainInterval> gaps = internal::gaps_between(all, reached);
    if (reached < kInfinity) {
      const double beyond = reached > 0 ? 2 * reached : std::exp(x.log_Kp) * shape_.grid().front();
      if (shape_.stable(gains(x, std::log(beyond)))) return kInfinity;
    }
    for (std::size_t k = gaps.size(); k-- > 0;) {
      const double log_Ki = end_of(gaps[k], proportional);
      const PidGains found = gains(x, log_Ki);
      // Between two frequencies of the grid more may be forbidden.
      if (shape_.stable(found) && violation(found) <= 1e-7) return log_Ki;
    }
    return kNoRoom - std::max(violation(proportional), 0.0);
  }

  [[nodiscard]] const LoopShape& shape() const { return shape_; }
  [[nodiscard]] int evaluations() const { return evaluations_; }

 private:
  void forbid_at(const PidGains& proportional, double w, Complex P,
                 std::vector<GainInterval>& all) const {
    const Complex integral = 1.0 / Complex(0, w);
    const Complex C = sign_ * proportional({0, w});
    const Complex L = C * P;
    const Complex slope = P * integral;  // of L, with Ki
    const internal::AffineResponse returned{1.0 + L, slope};
    forbid(returned, {}, 1 / bounds_.Ms_max, w, all);
    if (std::isfinite(bounds_.Mt_max))
      forbid(returned, {L / bounds_.Mt_max, slope / bounds_.Mt_max}, 0, w, all);
    if (std::isfinite(bounds_.noise_gain_max))
      forbid(returned, {C / bounds_.noise_gain_max, integral / bounds_.noise_gain_max}, 0, w, all);
  }

  /// log of the end of a gap, between the frequencies of the grid, and a hair below it.
  [[nodiscard]] double end_of(const GainInterval& gap, const PidGains& proportional) const {
    const auto end = [&](double log_w) {
      const double w = std::exp(log_w);
      std::vector<GainInterval> here;
      forbid_at(proportional, w, sign_ * plant_({0, w}), here);
      double least = kInfinity;
      for (const GainInterval& f : here)
        if (f.low > gap.low) least = std::min(least, f.low);
      return -least;
    };
    const double log_w = climb_from(end, std::log(gap.w), 0.04);
    return std::log(std::min(gap.high, -end(log_w))) - 1e-9;
  }

  /// log of how far the worst bound is exceeded, ≤ 0 within all.
  [[nodiscard]] double violation(const PidGains& g) const {
    const SensitivityPeaks peaks = shape_.peaks(g);
    double worst = std::max(peaks.Ms / bounds_.Ms_max, peaks.Mt / bounds_.Mt_max);
    if (std::isfinite(bounds_.noise_gain_max))
      worst = std::max(worst, shape_.noise_gain(g) / bounds_.noise_gain_max);
    return std::isfinite(worst) ? std::log(worst) : 1e2;
  }

  ContinuousTransferFunction plant_;
  bool with_derivative_;
  PidBounds bounds_;
  double Tf_;
  LoopShape shape_;
  double sign_ = 1;                 ///< of the plant's response to what is slow, and of the gains
  std::vector<Complex> responses_;  ///< of sign · plant on the shape's grid
  std::vector<GainInterval> forbidden_;  ///< kept, so that it is not allocated anew
  int evaluations_ = 0;
};

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

PidOptimum greatest_integral_gain(const ContinuousTransferFunction& plant, PidType type,
                                  const PidBounds& bounds, double Tf) {
  quadtune::validate(plant, "greatest_integral_gain");
  validate(bounds, type, Tf);
  if (plant.num.isZero(0))
    throw InvalidInput("greatest_integral_gain",
                       "num is 0, expected a plant that answers its input");
  Search search(plant, type, bounds, Tf);
  const Search::Point best = search.climb(search.start());
  const double value = search.log_greatest_Ki(best);
  PidOptimum optimum;
  optimum.evaluations = search.evaluations();
  if (!(value > kNoRoom)) {
    optimum.status = PidOptimumStatus::not_found;
    optimum.culprit = fmt::format(
        "no {} was found that is stable with Ms <= {:.4g}, Mt <= {:.4g} "
        "and a noise gain <= {:.4g}",
        to_string(type), bounds.Ms_max, bounds.Mt_max, bounds.noise_gain_max);
    return optimum;
  }
  // A loop of one lag takes any gain: the search then ends where its frequencies end.
  if (!(value < std::log(search.shape().grid().back() / 10) + best.log_Kp)) {
    optimum.status = PidOptimumStatus::unbounded;
    optimum.culprit = fmt::format(
        "Ki of a {} grows beyond all corners of the plant: it has neither "
        "delay nor lag enough to end it",
        to_string(type));
    return optimum;
  }
  optimum.status = PidOptimumStatus::solved;
  optimum.gains = search.gains(best, value);
  const SensitivityPeaks peaks = search.shape().peaks(optimum.gains);
  optimum.Ms = peaks.Ms;
  optimum.Mt = peaks.Mt;
  optimum.noise_gain = search.shape().noise_gain(optimum.gains);
  const auto binds = [](double met, double bound) { return met > 0.999 * bound; };
  if (binds(optimum.Ms, bounds.Ms_max)) optimum.binding.emplace_back("Ms");
  if (binds(optimum.Mt, bounds.Mt_max)) optimum.binding.emplace_back("Mt");
  if (binds(optimum.noise_gain, bounds.noise_gain_max)) optimum.binding.emplace_back("noise gain");
  return optimum;
}

}  // namespace quadtune
