// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/pid/pid_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <ostream>
#include <vector>

#include "pid/loop_shape.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/border.hpp"
#include "quadtune/internal/enum_names.hpp"

namespace quadtune {
namespace {

using internal::LoopShape;
using internal::MinPhaseMargin;
using internal::SensitivityPeaks;
using std::numbers::pi;
using Complex = std::complex<double>;

constexpr double kDegree = pi / 180;
// All crossovers of the scan are feasible.
constexpr double kNoHighestCrossover = std::numeric_limits<double>::infinity();

void validate(const LoopRequirement& requirement) {
  const char* where = "pid_for_crossover";
  if (!(requirement.crossover > 0) || !std::isfinite(requirement.crossover))
    throw InvalidInput(where, fmt::format("crossover is {} rad/s, expected a positive number",
                                          requirement.crossover));
  if (!(requirement.phase_margin > 0 && requirement.phase_margin < pi))
    throw InvalidInput(where, fmt::format("phase margin is {} rad, expected more than 0 and less "
                                          "than pi",
                                          requirement.phase_margin));
  if (!(requirement.Tf >= 0) || !std::isfinite(requirement.Tf))
    throw InvalidInput(where, fmt::format("Tf is {} s, expected 0 or more", requirement.Tf));
  if (!(requirement.Ms_max > 1))
    throw InvalidInput(where, fmt::format("Ms_max is {}, expected more than 1 because a loop with "
                                          "delay or two more poles than zeros has no less",
                                          requirement.Ms_max));
}

double in_turn(double angle) { return std::remainder(angle, 2 * pi); }

/// The required value of C(jω), and the controllers that have it. With j ω/(1 + j ω Tf) = a + j b
/// of the derivative,
///     Kp + a Kd = Re C,   b Kd - Ki/ω = Im C
struct Target {
  double w = 0;
  double Tf = 0;
  double X = 0;  ///< Re C times sign, ≥ 0
  double Y = 0;  ///< Im C times sign
  double a = 0;
  double b = 0;
  double sign = 1;  ///< sign of all gains

  /// The controller with this Kd on the line of solutions.
  [[nodiscard]] PidGains at(double Kd) const {
    const double Ki = w * (b * Kd - Y);
    // A Ki that is only rounding would be a negligible integral with an extremely slow pole.
    const bool integral = Ki > 1e-13 * w * (b * Kd + std::abs(Y));
    return {sign * std::max(X - a * Kd, 0.0), integral ? sign * Ki : 0, sign * Kd,
            Kd != 0 ? Tf : 0};
  }
};

Target target(Complex C, double w, double Tf) {
  Target t;
  t.w = w;
  t.Tf = Tf;
  t.sign = C.real() < 0 ? -1 : 1;
  t.X = t.sign * C.real();
  t.Y = t.sign * C.imag();
  t.a = w * w * Tf / (1 + w * w * Tf * Tf);
  t.b = w / (1 + w * w * Tf * Tf);
  return t;
}

/// Whether a value is ≥ 0 up to rounding.
bool not_negative(double value, double scale) { return value >= -1e-12 * scale; }

/// Solves (X - a Kd)² = 4 Kd ω (b Kd - Y), that is Kp² = 4 Kd Ki, for Kd. The product of the roots
/// is X²/(a² - 4 ω b) < 0, so that exactly one of them is positive.
double Kd_of_double_zero(const Target& t) {
  const double square = t.a * t.a - 4 * t.w * t.b;
  const double half = 2 * t.w * t.Y - t.a * t.X;
  const double root = std::sqrt(half * half - square * t.X * t.X);
  // Use the form of the positive root without cancellation.
  return half > 0 ? -(half + root) / square : t.X * t.X / (root - half);
}

class Problem {
 public:
  Problem(const ContinuousTransferFunction& plant, const LoopRequirement& requirement)
      : plant_(plant),
        requirement_(requirement),
        shape_(plant, {requirement.crossover, requirement.Tf > 0 ? 1 / requirement.Tf : 0}),
        low_sign_(shape_.low_frequency_sign()) {
    const Eigen::VectorXcd poles = polynomial_roots(plant.den);
    plant_unstable_ = (poles.real().array() > 1e-12).any();
  }

  struct Attempt {
    PidLoopStatus status = PidLoopStatus::phase_infeasible;
    PidGains gains;
    double evidence = 0;  ///< margin of the other crossover, or minimum Ms, by status
    double at = 0;        ///< its frequency [rad/s]
  };

  [[nodiscard]] Attempt attempt(double w) const {
    Attempt result = attempt_any_sign(w);
    // Gains of the wrong sign meet the phase with an offset of π and never stabilize a stable plant
    // with integral action. In that case the required phase is out of reach.
    if (result.status == PidLoopStatus::unstable && result.gains.Kp * low_sign_ < 0 &&
        !plant_unstable_)
      result.status = PidLoopStatus::phase_infeasible;
    return result;
  }

  /// The required phase of C for a plant of positive sign [rad].
  [[nodiscard]] double needed_phase(double w) const {
    return in_turn(requirement_.phase_margin - pi - std::arg(low_sign_ * plant_({0, w})));
  }

  [[nodiscard]] const LoopShape& shape() const { return shape_; }

 private:
  [[nodiscard]] Attempt attempt_any_sign(double w) const {
    const Complex P = plant_({0, w});
    if (!std::isfinite(std::abs(P)) || P == 0.0) return {};
    if (requirement_.type == PidType::P) return proportional(P, w);
    const Complex C = std::polar(1.0, requirement_.phase_margin - pi) / P;
    const Target t = target(C, w, requirement_.Tf);
    const double scale = std::abs(C);
    switch (requirement_.type) {
      case PidType::P:
        break;
      case PidType::PI:
        if (!not_negative(-t.Y, scale)) return {};
        return judged({t.sign * t.X, t.sign * w * std::max(-t.Y, 0.0), 0, 0}, w);
      case PidType::PD: {
        const double Kd = std::max(t.Y, 0.0) / t.b;
        if (!not_negative(t.Y, scale) || !not_negative(t.X - t.a * Kd, scale)) return {};
        return judged({t.sign * std::max(t.X - t.a * Kd, 0.0), 0, t.sign * Kd, requirement_.Tf}, w);
      }
      case PidType::PID:
        if (requirement_.freedom == PidFreedom::max_Ki) return max_Ki(t);
        const double Kd = Kd_of_double_zero(t);
        if (!(Kd >= 0) || !not_negative(t.X - t.a * Kd, scale)) return {};
        return judged(t.at(Kd), w);
    }
    return {};
  }

  /// A P controller meets the crossover; its phase margin must be at least the required one.
  [[nodiscard]] Attempt proportional(Complex P, double w) const {
    Attempt first = judged({low_sign_ / std::abs(P), 0, 0, 0}, w);
    if (first.status == PidLoopStatus::solved) return first;
    const Attempt second = judged({-low_sign_ / std::abs(P), 0, 0, 0}, w);
    if (second.status == PidLoopStatus::solved) return second;
    if (first.status == PidLoopStatus::other_crossover)
      first.status = PidLoopStatus::phase_infeasible;
    return first;
  }

  [[nodiscard]] Attempt judged(const PidGains& gains, double w) const {
    Attempt result;
    result.gains = gains;
    result.status = PidLoopStatus::solved;
    if (!shape_.stable(gains)) {
      result.status = PidLoopStatus::unstable;
      return result;
    }
    const MinPhaseMargin min = shape_.min_phase_margin(gains);
    if (!(std::abs(min.margin) >= requirement_.phase_margin - 1e-7)) {
      result.status = PidLoopStatus::other_crossover;
      result.evidence = min.margin;
      result.at = min.w;
    } else if (!(std::abs(min.last_w - w) <= 1e-6 * w)) {
      result.status = PidLoopStatus::other_crossover;
      result.evidence = min.last_margin;
      result.at = min.last_w;
    }
    return result;
  }

  [[nodiscard]] Attempt judged_with_Ms(const PidGains& gains, double w) const {
    Attempt result = judged(gains, w);
    if (result.status != PidLoopStatus::solved) return result;
    const SensitivityPeaks peaks = shape_.peaks(gains);
    if (peaks.Ms <= requirement_.Ms_max) return result;
    result.status = PidLoopStatus::Ms_exceeded;
    result.evidence = peaks.Ms;
    result.at = peaks.w_Ms;
    return result;
  }

  /// Ki increases with Kd along the line of solutions: computes the largest accepted Kd by a scan
  /// and bisection.
  [[nodiscard]] Attempt max_Ki(const Target& t) const {
    const double size = std::hypot(t.X, t.Y) / t.b;
    const double low = std::max(0.0, t.Y / t.b);
    const double high = t.a > 0 ? std::min(t.X / t.a, low + 1e3 * size) : low + 1e3 * size;
    if (!(high >= low)) return {};
    const double width = high - low;
    std::vector<double> scan = {low};
    double part = 1e-3;
    while (part * size < width) {
      scan.push_back(low + part * size);
      part *= part < 1 ? 1.2 : 1.5;
    }
    scan.push_back(high);
    std::optional<Attempt> refused;
    for (std::size_t k = scan.size(); k-- > 0;) {
      Attempt found = judged_with_Ms(t.at(scan[k]), t.w);
      if (found.status == PidLoopStatus::solved) {
        if (k + 1 == scan.size()) return found;
        const auto accepted = [&](double Kd) {
          return judged_with_Ms(t.at(Kd), t.w).status == PidLoopStatus::solved;
        };
        const double last = internal::border(accepted, scan[k], scan[k + 1], 1e-12).holds;
        return judged_with_Ms(t.at(last), t.w);
      }
      // Report the closest failure: the one with the minimum Ms, or else any.
      if (!refused ||
          (found.status == PidLoopStatus::Ms_exceeded &&
           (refused->status != PidLoopStatus::Ms_exceeded || found.evidence < refused->evidence)))
        refused = found;
    }
    return *refused;
  }

  ContinuousTransferFunction plant_;
  LoopRequirement requirement_;
  LoopShape shape_;
  double low_sign_;  ///< sign of the plant's response at low frequencies
  bool plant_unstable_ = false;
};

bool solvable(const Problem& problem, double w) {
  return problem.attempt(w).status == PidLoopStatus::solved;
}

void search_crossovers(const Problem& problem, PidLoopDesign& design) {
  // At an end of the grid, rounding can hide that |L| passes 1.
  const double first = 1.1 * problem.shape().grid().front();
  const double last = problem.shape().grid().back() / 1.1;
  const int steps = 20 * static_cast<int>(std::ceil(std::log10(last / first)));
  const double ratio = std::pow(last / first, 1.0 / steps);
  int lowest = -1;
  int highest = -1;
  for (int k = 0; k <= steps; ++k) {
    if (!solvable(problem, first * std::pow(ratio, k))) continue;
    if (lowest < 0) lowest = k;
    highest = k;
  }
  if (lowest < 0) return;
  const auto last_between = [&](int good, int bad) {
    return internal::border([&](double w) { return solvable(problem, w); },
                            first * std::pow(ratio, good), first * std::pow(ratio, bad), 1e-10)
        .holds;
  };
  design.lowest_crossover = lowest == 0 ? 0 : last_between(lowest, lowest - 1);
  design.highest_crossover =
      highest == steps ? kNoHighestCrossover : last_between(highest, highest + 1);
}

/// The phases in degrees, e.g. "-90 to 0", that a controller with gains of one sign can have.
std::string phases(const LoopRequirement& requirement) {
  const double lead = 90 - std::atan(requirement.crossover * requirement.Tf) / kDegree;
  switch (requirement.type) {
    case PidType::P:
      return "0";
    case PidType::PI:
      return "-90 to 0";
    case PidType::PD:
      return fmt::format("0 to {:.4g}", lead);
    case PidType::PID:
      return fmt::format("-90 to {:.4g}", lead);
  }
  return "";
}

std::string obstacle(const Problem& problem, const LoopRequirement& requirement,
                     const Problem::Attempt& attempt) {
  const std::string what =
      fmt::format("{} at {:.4g} rad/s", to_string(requirement.type), requirement.crossover);
  switch (attempt.status) {
    case PidLoopStatus::phase_infeasible:
      return fmt::format("{} must have a phase of {:.4g} deg, but its range is {}", what,
                         problem.needed_phase(requirement.crossover) / kDegree,
                         phases(requirement));
    case PidLoopStatus::unstable:
      return fmt::format("{} has one solution, and it does not stabilize the loop", what);
    case PidLoopStatus::other_crossover:
      return fmt::format("{} leaves another crossover at {:.4g} rad/s with {:.4g} deg of margin",
                         what, attempt.at, attempt.evidence / kDegree);
    case PidLoopStatus::Ms_exceeded:
      return fmt::format("{} has max |S| >= {:.4g}, at {:.4g} rad/s, which exceeds {:.4g}", what,
                         attempt.evidence, attempt.at, requirement.Ms_max);
    case PidLoopStatus::not_run:
    case PidLoopStatus::solved:
      break;
  }
  return "";
}

/// Rounds a positive number to four digits, up or down.
double rounded(double x, double (*round)(double)) {
  const double step = std::pow(10, std::floor(std::log10(x)) - 3);
  return round(x / step) * step;
}

std::string possible(const PidLoopDesign& design) {
  if (std::isnan(design.highest_crossover)) return "no feasible crossover was found";
  const bool unlimited = std::isinf(design.highest_crossover);
  if (design.lowest_crossover == 0 && unlimited)
    return "some lower and some higher crossovers are feasible";
  // The printed ends are feasible as well: they are rounded into the range.
  const double high = rounded(design.highest_crossover, std::floor);
  if (design.lowest_crossover == 0)
    return fmt::format("crossovers up to {:.4g} rad/s are feasible", high);
  const double low = rounded(design.lowest_crossover, std::ceil);
  if (unlimited) return fmt::format("crossovers from {:.4g} rad/s upwards are feasible", low);
  if (low < high)
    return fmt::format("crossovers between {:.4g} and {:.4g} rad/s are feasible", low, high);
  return fmt::format("crossovers between {:.10g} and {:.10g} rad/s are feasible",
                     design.lowest_crossover, design.highest_crossover);
}

}  // namespace

constexpr internal::EnumName<PidLoopStatus> kPidLoopStatuses[] = {
    {PidLoopStatus::not_run, "not run"},
    {PidLoopStatus::solved, "solved"},
    {PidLoopStatus::phase_infeasible, "phase out of reach"},
    {PidLoopStatus::unstable, "unstable"},
    {PidLoopStatus::other_crossover, "other crossover"},
    {PidLoopStatus::Ms_exceeded, "Ms exceeded"}};

std::string to_string(PidLoopStatus status) { return internal::name_in(kPidLoopStatuses, status); }

std::ostream& operator<<(std::ostream& out, const PidLoopDesign& design) {
  out << to_string(design.status);
  if (!design.solved()) return out << ": " << design.culprit;
  return out << ": " << design.gains
             << fmt::format(", crossover {:.6g} rad/s, phase margin {:.6g} deg, Ms {:.4g}",
                            design.crossover, design.phase_margin / kDegree, design.Ms);
}

PidLoopDesign pid_for_crossover(const ContinuousTransferFunction& plant,
                                const LoopRequirement& requirement) {
  quadtune::validate(plant, "pid_for_crossover");
  validate(requirement);
  if (plant.num.isZero(0))
    throw InvalidInput("pid_for_crossover",
                       "num is 0, expected a plant that responds to its input");
  const Problem problem(plant, requirement);
  const Problem::Attempt attempt = problem.attempt(requirement.crossover);
  PidLoopDesign design;
  design.status = attempt.status;
  if (!design.solved()) {
    search_crossovers(problem, design);
    design.culprit = obstacle(problem, requirement, attempt) + "; " + possible(design);
    return design;
  }
  design.gains = attempt.gains;
  const MinPhaseMargin min = problem.shape().min_phase_margin(design.gains);
  design.crossover = min.w;
  design.phase_margin = min.margin;
  const SensitivityPeaks peaks = problem.shape().peaks(design.gains);
  design.Ms = peaks.Ms;
  design.w_Ms = peaks.w_Ms;
  design.Mt = peaks.Mt;
  design.w_Mt = peaks.w_Mt;
  return design;
}

}  // namespace quadtune
