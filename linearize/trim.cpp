// SPDX-License-Identifier: Apache-2.0
#include "quadtune/linearize/trim.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "least_norm.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "trim_newton.hpp"

namespace quadtune {
namespace {

using internal::NewtonResult;
using internal::RotorCurve;
using internal::TrimProblem;

// Relative violations of a limit below this are rounding.
constexpr double kAtLimit = 1e-9;
constexpr double kDegrees = 180 / std::numbers::pi;

void require(bool ok, const std::string& message) {
  if (!ok) throw InvalidInput("trim", message);
}

void check(const Vehicle& vehicle, const FlightCondition& c, const TrimOptions& options) {
  const std::string kind = to_string(c.kind);
  require(std::isfinite(c.yaw), fmt::format("yaw is {} rad, expected a finite number", c.yaw));
  require(std::isfinite(c.climb),
          fmt::format("climb is {} m/s, expected a finite number", c.climb));
  require(c.speed >= 0 && std::isfinite(c.speed),
          fmt::format("speed is {} m/s, expected a finite number that is not negative (the "
                      "direction of flight is yaw)",
                      c.speed));
  require(std::isfinite(c.radius),
          fmt::format("radius is {} m, expected a finite number", c.radius));
  if (c.kind == FlightKind::hover)
    require(
        c.speed == 0 && c.climb == 0,
        fmt::format("the hover has speed {} m/s and climb {} m/s, expected 0 for both because a "
                    "hover is stationary",
                    c.speed, c.climb));
  if (c.kind == FlightKind::circle) {
    require(c.radius != 0,
            "radius is 0 m, expected a positive number (turns right) or a negative one (left)");
    require(c.speed > 0, "speed is 0 m/s, expected a positive number for a circle");
  } else {
    require(c.radius == 0, fmt::format("radius is {} m, expected 0 for a {}", c.radius, kind));
  }
  if (c.kind == FlightKind::spin) {
    require(c.yaw_rate != 0 && std::isfinite(c.yaw_rate),
            fmt::format("yaw rate is {} rad/s, expected a positive number (turns right) or a "
                        "negative one (left)",
                        c.yaw_rate));
    require(c.speed == 0, fmt::format("speed is {} m/s, expected 0 because a spin stays in "
                                      "place",
                                      c.speed));
  } else {
    require(c.yaw_rate == 0,
            fmt::format("yaw rate is {} rad/s, expected 0 for a {}{}", c.yaw_rate, kind,
                        c.kind == FlightKind::circle ? " because it is speed/radius" : ""));
  }
  require(vehicle.gravity > 0,
          fmt::format("gravity is {} m/s², expected a positive number", vehicle.gravity));
  require(options.density_ratio > 0,
          fmt::format("density ratio is {}, expected a positive number", options.density_ratio));
  require(options.tolerance > 0,
          fmt::format("tolerance is {}, expected a positive number", options.tolerance));
  require(options.max_iterations >= 1,
          fmt::format("max_iterations is {}, expected at least 1", options.max_iterations));
}

std::string describe(const FlightCondition& c) {
  std::string words = to_string(c.kind);
  if (c.kind == FlightKind::circle) words += fmt::format(" of {:.4g} m", c.radius);
  if (c.kind == FlightKind::spin)
    words += fmt::format(" at {:.4g} rad/s", c.yaw_rate);
  else if (c.kind != FlightKind::hover)
    words += fmt::format(" at {:.4g} m/s", c.speed);
  if (c.climb != 0) words += fmt::format(" climbing {:.4g} m/s", c.climb);
  return words;
}

double tilt(const Eigen::VectorXd& z) { return std::acos(std::cos(z(0)) * std::cos(z(1))); }

// The largest violation of the limits, relative to the limit's speed or thrust; ≤ kAtLimit: none.
struct Violation {
  Eigen::Index rotor = 0;
  double by = 0;
  bool above = false;
};

Violation worst_violation(const TrimProblem& problem, const Eigen::VectorXd& z) {
  Violation worst;
  for (Eigen::Index i = 0; i < problem.rotors(); ++i) {
    const RotorCurve& curve = problem.curves()[static_cast<std::size_t>(i)];
    const double thrust = z(2 + i) * problem.weight();
    const double above = thrust / curve.max_thrust() - 1;
    const double below = (curve.min_thrust() - thrust) / curve.max_thrust();
    if (above > worst.by) worst = {i, above, true};
    if (below > worst.by) worst = {i, below, false};
  }
  return worst;
}

double max_thrust(const TrimProblem& problem) {
  double sum = 0;
  for (const RotorCurve& curve : problem.curves()) sum += curve.max_thrust();
  return sum;
}

// The number of rotors that turn in the same direction, if they are not half of them.
// @param yaw  torque about yaw for each thrust
std::string directions_of(const Eigen::RowVectorXd& yaw) {
  const Eigen::Index n = yaw.size();
  const Eigen::Index one_way = std::max((yaw.array() > 0).count(), (yaw.array() < 0).count());
  if (2 * one_way <= n) return "";
  return fmt::format("; {} of {} rotors turn in the same direction, expected half of them", one_way,
                     n);
}

// Torque about yaw for the thrust of each rotor, at hover.
Eigen::RowVectorXd yaw_torques(const TrimProblem& problem) {
  const TrimProblem at_rest = problem.slowed(0);
  return at_rest.balance(at_rest.first_guess()).jacobian.bottomRows(1).rightCols(problem.rotors());
}

// Explains a balance at z that exceeds the limits.
void explain_limit(const TrimProblem& problem, const NewtonResult& found, TrimResult& result) {
  const Eigen::VectorXd& z = found.z;
  const Violation worst = worst_violation(problem, z);
  const RotorCurve& curve = problem.curves()[static_cast<std::size_t>(worst.rotor)];
  const double needed = z.tail(problem.rotors()).sum() * problem.weight();
  const double available = max_thrust(problem);
  const std::string flight = describe(result.condition);
  const std::string leaning =
      tilt(z) * kDegrees < 0.05 ? "" : fmt::format(" a tilt of {:.1f}° and", tilt(z) * kDegrees);
  const double thrust = z(2 + worst.rotor) * problem.weight();
  if (needed > available) {
    result.status = TrimStatus::not_enough_thrust;
    // Two digits of what is missing; below a ten-thousandth of the thrust, it is not worth a
    // number.
    const double missing = needed - available;
    const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(missing))), 2, 6);
    if (missing > 1e-4 * available)
      result.culprit = fmt::format(
          "{} needs{} {:.{}f} N, the rotors give at most {:.{}f} N at {:.0f} rad/s: {:.{}f} N "
          "short",
          flight, leaning, needed, decimals, available, decimals, curve.max_speed(), missing,
          decimals);
    else
      result.culprit = fmt::format(
          "{} needs{} {:.4g} N, which is just more than the rotors give at {:.0f} rad/s", flight,
          leaning, needed, curve.max_speed());
    return;
  }
  result.status = worst.above ? TrimStatus::rotor_too_fast : TrimStatus::rotor_too_slow;
  result.culprit = fmt::format("{} needs{} {:.4g} N in all, and rotor {} would have to ", flight,
                               leaning, needed, worst.rotor + 1);
  if (worst.above)
    result.culprit += fmt::format("turn at {:.1f} rad/s, limit {:.1f} rad/s: {:.1f} rad/s too fast",
                                  curve.speed(thrust), curve.max_speed(),
                                  curve.speed(thrust) - curve.max_speed());
  else if (thrust < 0)
    result.culprit +=
        fmt::format("push down with {:.3g} N, but it can only lift, with at least {:.3g} N",
                    -thrust, curve.min_thrust());
  else if (thrust < curve.continued_below())
    result.culprit += fmt::format("give {:.3g} N, minimum {:.3g} N, its thrust at {:.1f} rad/s",
                                  thrust, curve.min_thrust(), curve.min_speed());
  else
    result.culprit += fmt::format(
        "turn at {:.1f} rad/s, minimum {:.1f} rad/s: {:.1f} rad/s too slow", curve.speed(thrust),
        curve.min_speed(), curve.min_speed() - curve.speed(thrust));
  result.culprit += directions_of(yaw_torques(problem));
}

// Explains a missing balance: whether thrusts that carry the weight cannot cancel the torques.
void explain_imbalance(const TrimProblem& problem, const NewtonResult& found, TrimResult& result) {
  const Eigen::Index n = problem.rotors();
  const TrimProblem at_rest = problem.slowed(0);
  const internal::ValueAndJacobian at = at_rest.balance(at_rest.first_guess());
  const Eigen::MatrixXd torques = at.jacobian.bottomRightCorner(3, n);
  // Changes of thrust that preserve the sum: I - 1 1ᵀ/n.
  const Eigen::MatrixXd keep_sum = Eigen::MatrixXd::Identity(n, n) -
                                   Eigen::MatrixXd::Constant(n, n, 1.0 / static_cast<double>(n));
  const Eigen::MatrixXd M = torques * keep_sum;
  const Eigen::Vector3d left =
      at.value.tail<3>() + M * internal::least_norm(M, -at.value.tail<3>());
  Eigen::Index axis = 0;
  const double worst = left.cwiseAbs().maxCoeff(&axis);
  static constexpr const char* kAxes[] = {"roll", "pitch", "yaw"};
  if (worst > 1e-6) {
    result.status = TrimStatus::no_authority;
    result.culprit = fmt::format(
        "{} cannot be balanced: thrusts that carry the weight and balance the torques as far as "
        "possible leave a torque of {:.3g} N m{}",
        kAxes[axis], worst * problem.weight() * problem.arm(),
        axis == 2 ? directions_of(torques.row(2)) : "");
    return;
  }
  result.status = TrimStatus::no_convergence;
  result.culprit = fmt::format("{}: Newton's method stopped at residual {:.2g} after {} steps",
                               describe(result.condition), found.residual, found.iterations);
}

// The start of Newton's method: the initial guess or the neighbour, whichever has the smaller
// residual.
Eigen::VectorXd start(const TrimProblem& problem, const TrimResult* neighbour) {
  Eigen::VectorXd guess = problem.first_guess();
  if (neighbour == nullptr || !neighbour->solved() || neighbour->thrust.size() != problem.rotors())
    return guess;
  Eigen::VectorXd near = problem.guess_from(*neighbour);
  return problem.residual(near).norm() < problem.residual(guess).norm() ? near : guess;
}

// Solves for the flight directly or, if that fails, in small steps starting from a hover.
NewtonResult search(const TrimProblem& problem, const TrimOptions& options,
                    const TrimResult* neighbour) {
  NewtonResult found = newton(problem, start(problem, neighbour), options, false);
  if (found.residual <= options.tolerance && tilt(found.z) < std::numbers::pi / 2) return found;
  int iterations = found.iterations;
  constexpr int kSteps = 20;
  Eigen::VectorXd z = problem.slowed(0).first_guess();
  for (int k = 0; k <= kSteps; ++k) {
    found = newton(problem.slowed(static_cast<double>(k) / kSteps), z, options, false);
    iterations += found.iterations;
    if (!(found.residual <= options.tolerance)) break;
    z = found.z;
  }
  found.residual = problem.residual(found.z).cwiseAbs().maxCoeff();
  found.iterations = iterations;
  return found;
}

void accept(const TrimProblem& problem, const Eigen::VectorXd& z, TrimResult& result) {
  result.status = TrimStatus::solved;
  result.x = problem.state(z, result.condition.yaw);
  result.u = problem.speeds(z);
  result.thrust = z.tail(problem.rotors()) * problem.weight();
  result.tilt = tilt(z);
}

}  // namespace

constexpr internal::EnumName<TrimStatus> kTrimStatuses[] = {
    {TrimStatus::not_run, "not run"},
    {TrimStatus::solved, "solved"},
    {TrimStatus::not_enough_thrust, "not enough thrust"},
    {TrimStatus::rotor_too_fast, "rotor too fast"},
    {TrimStatus::rotor_too_slow, "rotor too slow"},
    {TrimStatus::no_authority, "no authority"},
    {TrimStatus::no_convergence, "no convergence"}};

std::string to_string(TrimStatus status) { return internal::name_in(kTrimStatuses, status); }

TrimResult trim(const Vehicle& vehicle, const FlightCondition& condition,
                const TrimOptions& options, const TrimResult* neighbour) {
  check(vehicle, condition, options);
  const TrimProblem problem(vehicle, condition, options.density_ratio);
  TrimResult result;
  result.condition = condition;
  result.density_ratio = options.density_ratio;
  result.yaw_rate = problem.yaw_rate();
  result.thrust_to_weight = max_thrust(problem) / problem.weight();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  result.x = Eigen::VectorXd::Constant(12, nan);
  result.u = Eigen::VectorXd::Constant(problem.rotors(), nan);
  result.thrust = result.u;

  const NewtonResult unlimited = search(problem, options, neighbour);
  result.residual = unlimited.residual;
  result.iterations = unlimited.iterations;
  if (!(unlimited.residual <= options.tolerance)) {
    explain_imbalance(problem, unlimited, result);
    return result;
  }
  if (worst_violation(problem, unlimited.z).by <= kAtLimit) {
    accept(problem, unlimited.z, result);
    return result;
  }
  if (unlimited.freedom > 0) {
    // There are more rotors than the balance needs: fix those at a limit and let the others share
    // the load.
    Eigen::VectorXd start = unlimited.z;
    start.tail(problem.rotors()) =
        start.tail(problem.rotors()).cwiseMax(problem.low()).cwiseMin(problem.high());
    const NewtonResult limited = newton(problem, start, options, true);
    result.iterations += limited.iterations;
    if (limited.residual <= options.tolerance &&
        worst_violation(problem, limited.z).by <= kAtLimit) {
      result.residual = limited.residual;
      accept(problem, limited.z, result);
      return result;
    }
  }
  explain_limit(problem, unlimited, result);
  return result;
}

}  // namespace quadtune
