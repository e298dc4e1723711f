// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flown/flown_gains.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "quadtune/errors.hpp"
#include "quadtune/internal/in_parallel.hpp"
#include "quadtune/synthesis/actuator_lqi.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// Bound for the position loops of a cascade, cut at their tilt command: at least 31° of phase.
constexpr double kOuterMs = 1.85;

/// A bound counts as met within this factor.
constexpr double kBoundSlack = 1.005;

/// Frequencies from far below any crossover to just below the Nyquist frequency [rad/s].
VectorXd grid(double dt) {
  constexpr Index kCount = 80;
  constexpr double kLowest = 0.05;
  const double span = std::log(0.98 * std::numbers::pi / dt / kLowest);
  return (kLowest * (VectorXd::LinSpaced(kCount, 0, span).array().exp()).matrix());
}

/// The structure of the law of one group of axes, and the load that its cost includes.
struct AxisLaw {
  FlownAxis axis = FlownAxis::north;
  double now = 0;                         ///< as with_integrals()
  double tilt_integral = 0;               ///< Ki/Kp of the tilt loop [1/s]; 0: no integral
  double rate_lead = 0, rate_filter = 0;  ///< of the tilt loop [s]
  double load = 0;  ///< torque whose sudden removal the cost includes if there is an integral [N m]
  CascadeStructure structure = CascadeStructure::pid;
};

/// The bound 4 |Kd| Ki / Kp² ≤ 1 for the group's loops, in terms of F = [p v tilt rate ∫p] or [p v
/// ∫p].
std::vector<GainProductBound> structure_bounds(const AxisLaw& law) {
  if (law.structure == CascadeStructure::pid) return {};
  if (states_of(law.axis).size() != 4) return {{4, {-2, 1, 1}}};
  // Kp of the tilt loop is a factor of all gains of the position loop and cancels in their ratio.
  std::vector<GainProductBound> bounds = {{4, {-2, 1, 0, 0, 1}}};
  if (law.tilt_integral > 0) bounds.push_back({4 * law.tilt_integral, {0, 0, -1, 1, 0}});
  return bounds;
}

/// The part of the plant of a member that the law sees, with the lead of the tilt loop's rate.
PeriodicLti part_of(const FlownFamilyMember& member, const AxisLaw& law) {
  constexpr Index kRate = 3;
  PeriodicLti part = axis_part(member.plant, law.axis);
  if (law.rate_lead == 0) return part;
  const double sum = law.rate_filter + part.dt;
  return with_rate_lead(part, kRate, law.rate_lead / sum, part.dt / sum);
}

FixedGainsMember member_of(const FlownFamilyMember& member, const AxisLaw& law,
                           const AxisWeights& weights) {
  FixedGainsMember result;
  result.name = member.name;
  const PeriodicLti part = part_of(member, law);
  OutputFeedbackProblem& problem = result.problem;
  problem = axis_problem(part, law.axis, weights, law.now);
  if (law.tilt_integral > 0) {
    problem.plant = with_tilt_integral(problem.plant, law.tilt_integral);
    const Index nx = problem.Q.rows(), starts = problem.start.cols();
    problem.Q.conservativeResizeLike(MatrixXd::Zero(nx + 2, nx + 2));
    problem.start.conservativeResizeLike(MatrixXd::Zero(nx + 2, starts + 1));
    // When a load is removed, the integral that balanced it remains.
    problem.start(nx, starts) = law.load / law.tilt_integral;
  }
  if (!member.nominal) return result;
  const MeanResponse response(problem.plant);
  const VectorXd w = grid(part.dt);
  result.response.resize(problem.plant.C.rows(), w.size());
  for (Index i = 0; i < w.size(); ++i) result.response.col(i) = response.at(w(i));
  if (states_of(law.axis).size() == 4) {
    result.inner = {2, 3};  // the tilt and its rate
    result.outer_Ms = kOuterMs;
  }
  return result;
}

/// The regulator with integrals and the same weights, without its gains on actuator states.
MatrixXd start_of(const Vehicle& vehicle, const StandardAxes& weights, double dt) {
  ActuatorLqiOptions options;
  options.dt = dt;
  options.integrals = standard_integrals();
  const ActuatorLqi lqi = actuator_lqi(vehicle, lqi_weights(weights, options.integrals), options);
  if (!lqi.solved())
    throw NoSolution(fmt::format("{}: lqr: {}", vehicle.name, lqi.riccati.culprit), vehicle.name);
  MatrixXd all(4, 16);
  all << lqi.gains.K, lqi.gains.K_int;
  return all;
}

/// Slows the loop by `factor`: the gain on the nth derivative of a deviation is scaled by
/// 1/factor^(order - n).
RowVectorXd slowed(const RowVectorXd& F, double factor) {
  const Index order = F.size() - 1;
  RowVectorXd result = F;
  for (Index j = 0; j < order; ++j) result(j) /= std::pow(factor, static_cast<double>(order - j));
  result(order) /= std::pow(factor, static_cast<double>(order + 1));
  return result;
}

bool stable(const std::vector<FixedGainsMember>& members, const RowVectorXd& F) {
  return std::all_of(members.begin(), members.end(), [&](const FixedGainsMember& member) {
    return output_feedback_cost(member.problem, F).stable;
  });
}

/// The loop of a member, cut at the law's output.
PeriodicLti loop_of(const FlownFamilyMember& member, const AxisLaw& law, const RowVectorXd& F) {
  PeriodicLti loop = with_integrals(part_of(member, law), {0}, law.now);
  if (law.tilt_integral > 0) loop = with_tilt_integral(loop, law.tilt_integral);
  loop.C = (F * loop.C).eval();
  loop.outputs = loop.inputs;
  return loop;
}

/// The worst margins of a group over the nominal members.
double Ms_of(const FlownAxisGains& axis, const std::vector<FlownFamilyMember>& family) {
  double worst = 0;
  for (std::size_t i = 0; i < axis.margins.size(); ++i)
    if (family[i].nominal) worst = std::max(worst, axis.margins[i].Ms);
  return worst;
}
double disk_of(const FlownAxisGains& axis, const std::vector<FlownFamilyMember>& family) {
  double worst = 2;
  for (std::size_t i = 0; i < axis.margins.size(); ++i)
    if (family[i].nominal) worst = std::min(worst, axis.margins[i].disk.alpha);
  return worst;
}

/// Searches from `start`, after slowing it until it is stable.
FlownAxisGains search_from(const RowVectorXd& start, const std::vector<FlownFamilyMember>& family,
                           const AxisLaw& law, const AxisWeights& weights,
                           const MarginBounds& asked, int max_searches = 3) {
  std::vector<FixedGainsMember> members;
  members.reserve(family.size());
  for (const FlownFamilyMember& member : family) members.push_back(member_of(member, law, weights));
  RowVectorXd F = start;
  constexpr int kMaxSlowings = 25;
  for (int i = 0; i < kMaxSlowings && !stable(members, F); ++i) F = slowed(F, 1.25);
  FlownAxisGains result;
  result.axis = law.axis;
  result.tilt_integral = law.tilt_integral;
  result.rate_lead = law.rate_lead;
  result.rate_filter = law.rate_filter;
  MarginBounds bounds = asked;
  // The search bounds the margins only on a grid and for the mean response of the plant. The next
  // search compensates the excess of the actual closed loop over the bounds.
  for (int i = 0; i < max_searches; ++i) {
    for (FixedGainsMember& member : members) member.bounds = bounds;
    result.search = fixed_gains(members, F, {.products = structure_bounds(law)});
    if (result.search.status == FixedGainsStatus::unstable_start) return result;
    F = result.search.F.row(0);
    result.margins.clear();
    for (const FlownFamilyMember& member : family)
      result.margins.push_back(loop_margins(loop_of(member, law, F)));
    const double Ms = Ms_of(result, family), disk = disk_of(result, family);
    if (Ms <= asked.Ms * kBoundSlack && disk * kBoundSlack >= asked.disk) break;
    if (Ms > asked.Ms) bounds.Ms = std::max(1.05, bounds.Ms * asked.Ms / Ms);
    if (disk > 0 && disk < asked.disk) bounds.disk = std::min(1.9, bounds.disk * asked.disk / disk);
  }
  result.F = F;
  return result;
}

/// 4 Ki |Kd|/Kp² of the tilt loop, which a PI controller of the rate can represent up to 1.
double share_of_structure(const FlownAxisGains& axis) {
  return 4 * axis.tilt_integral * std::abs(axis.F(3) / axis.F(2));
}

/// As search_from(), but if the structure does not permit the integral of the tilt loop together
/// with the margins, the integral is made slower.
FlownAxisGains search_with_integral(const RowVectorXd& start,
                                    const std::vector<FlownFamilyMember>& family, AxisLaw law,
                                    const AxisWeights& weights, const MarginBounds& asked,
                                    int max_searches = 3) {
  constexpr int kMaxSlower = 4;
  constexpr double kReserve = 0.9;
  FlownAxisGains result = search_from(start, family, law, weights, asked, max_searches);
  if (law.structure == CascadeStructure::pid || law.tilt_integral == 0) return result;
  for (int i = 0; i < kMaxSlower; ++i) {
    if (result.search.status == FixedGainsStatus::unstable_start) break;
    const double share = share_of_structure(result);
    if (!(share > 1)) break;
    law.tilt_integral *= kReserve / share;
    result = search_from(result.F, family, law, weights, asked, max_searches);
  }
  return result;
}

/// The torque about a group's axis if one rotor produces 10 % less thrust than at hover.
double load_of(const Vehicle& vehicle, FlownAxis axis) {
  constexpr double kWeaker = 0.1;
  const Index across = axis == FlownAxis::north ? 0 : 1;
  double arm = 0;
  for (const Rotor& rotor : vehicle.rotors) arm = std::max(arm, std::abs(rotor.position(across)));
  return kWeaker * arm * vehicle.mass * vehicle.gravity /
         static_cast<double>(vehicle.rotors.size());
}

std::size_t index_of(FlownAxis axis) {
  return static_cast<std::size_t>(std::find(kFlownAxes.begin(), kFlownAxes.end(), axis) -
                                  kFlownAxes.begin());
}

/// The bounds for one group of axes.
MarginBounds bounds_of(const FlownGainsOptions& options, FlownAxis axis) {
  MarginBounds bounds = options.bounds;
  if (const std::optional<double> Ms = options.axis_Ms[index_of(axis)]) bounds.Ms = *Ms;
  return bounds;
}

AxisLaw law_of(FlownAxis axis, const FlownGainsOptions& options) {
  AxisLaw law;
  law.axis = axis;
  law.now = options.now;
  law.structure = options.structure;
  if (states_of(axis).size() == 4) {
    law.rate_lead = options.rate_lead.value_or(0);
    law.rate_filter = options.rate_filter;
  }
  return law;
}

/// Adds an integral to the tilt loop, in proportion to the gains of the law without it.
void add_tilt_integral(AxisLaw& law, const FlownAxisGains& without) {
  const double Kp = std::abs(without.F(2)), Kd = std::abs(without.F(3));
  // Slower than the tilt loop, so that it costs little phase. The load in the cost is much smaller
  // than that of the motor: the cost grows with its square, and a large load would make the
  // position integrals so strong that steps overshoot.
  const double integral_share = law.structure == CascadeStructure::p_pi ? 0.2 : 0.35;
  constexpr double kCountedTilt = 0.03;  // [rad] steady tilt under the load without the integral
  law.tilt_integral = integral_share * Kp / Kd;
  law.load = kCountedTilt * Kp;
}

FlownAxisGains design(const Vehicle& vehicle, const std::vector<FlownFamilyMember>& family,
                      FlownAxis axis, const AxisWeights& weights, const MatrixXd& regulator,
                      const FlownGainsOptions& options) {
  const std::vector<Index>& states = states_of(axis);
  RowVectorXd start(std::ssize(states) + 1);
  for (std::size_t j = 0; j < states.size(); ++j)
    start(static_cast<Index>(j)) = regulator(wrench_of(axis), states[j]);
  start(start.size() - 1) = regulator(wrench_of(axis), 12 + static_cast<Index>(axis));
  AxisLaw law = law_of(axis, options);
  const MarginBounds bounds = bounds_of(options, axis);
  FlownAxisGains result = search_from(start, family, law, weights, bounds);
  const bool tilts = states.size() == 4;
  if (!tilts || !options.tilt_integral || result.F.size() == 0) return result;
  if (load_of(vehicle, axis) <= kMaxLoadTilt * std::abs(result.F(2))) return result;
  add_tilt_integral(law, result);
  FlownAxisGains with = search_with_integral(result.F, family, law, weights, bounds);
  return with.search.status == FixedGainsStatus::unstable_start ? result : with;
}

/// Reports what the designer should know, e.g. a bound that is not met.
void add_notes(FlownGains& gains, const Vehicle& vehicle, const FlownGainsOptions& options) {
  gains.notes.clear();
  if (const std::string why = why_no_estimator(vehicle); options.estimator.empty() && !why.empty())
    gains.notes.push_back(why + "; the gains are designed for true states");
  for (const FlownAxisGains& axis : gains.axes) {
    // The last search may have had tighter bounds than these.
    const MarginBounds& bounds = options.bounds;
    const double Ms = Ms_of(axis, gains.family), disk = disk_of(axis, gains.family);
    if (!(Ms <= bounds.Ms * kBoundSlack && disk * kBoundSlack >= bounds.disk))
      gains.notes.push_back(
          fmt::format("{}: Ms is {:.3f} and the disk margin {:.3f}, required are {} and {}",
                      to_string(axis.axis), Ms, disk, bounds.Ms, bounds.disk));
    else if (axis.search.status == FixedGainsStatus::no_convergence)
      gains.notes.push_back(fmt::format("{}: {} ({})", to_string(axis.axis),
                                        to_string(axis.search.status), axis.search.culprit));
  }
}

/// The cause of a loop that no gains stabilize, with the sensor that is missing, if one is.
std::string not_stabilized(const Vehicle& vehicle, const FlownAxisGains& axis) {
  const std::string lacks = general_filter_lacks(vehicle.sensors);
  return fmt::format("{}: {}: no gains were found that stabilize the flown loop {}{}",
                     place_of(vehicle), to_string(axis.axis), axis.search.culprit,
                     lacks.empty() ? "" : "; the sensors have " + lacks);
}

}  // namespace

double FlownGains::Ms() const {
  double worst = 0;
  for (const FlownAxisGains& axis : axes) worst = std::max(worst, Ms_of(axis, family));
  return worst;
}

double FlownGains::disk() const {
  double worst = 2;
  for (const FlownAxisGains& axis : axes) worst = std::min(worst, disk_of(axis, family));
  return worst;
}

FlownGains flown_gains(const Vehicle& vehicle, const FlownGainsOptions& options) {
  FlownGains result;
  const StandardAxes usual = standard_axes(vehicle);  // throws if the vehicle cannot hover
  const StandardAxes weights = options.weights.value_or(usual);
  result.family = flown_family(vehicle, InputKind::wrench, options.dt, options.estimator);
  const MatrixXd start = start_of(vehicle, weights, options.dt);
  result.axes.resize(kFlownAxes.size());
  const auto one = [&](std::size_t i) {
    result.axes[i] = design(vehicle, result.family, kFlownAxes[i], weights[i], start, options);
  };
  internal::in_parallel(kFlownAxes.size(), internal::thread_count(0), [&] { return one; }, {});
  for (const FlownAxisGains& axis : result.axes)
    if (axis.search.status == FixedGainsStatus::unstable_start)
      throw NoSolution(not_stabilized(vehicle, axis), place_of(vehicle));
  add_notes(result, vehicle, options);
  return result;
}

void redesign(FlownGains& gains, const std::vector<FlownAxis>& groups, const Vehicle& vehicle,
              const FlownGainsOptions& options) {
  const StandardAxes weights = options.weights ? *options.weights : standard_axes(vehicle);
  const auto one = [&](std::size_t i) {
    const std::size_t k = index_of(groups[i]);
    FlownAxisGains& axis = gains.axes[k];
    AxisLaw law = law_of(groups[i], options);
    if (axis.tilt_integral > 0) add_tilt_integral(law, axis);
    law.tilt_integral = axis.tilt_integral;
    FlownAxisGains again = search_with_integral(axis.F, gains.family, law, weights[k],
                                                bounds_of(options, groups[i]), 1);
    if (again.search.status != FixedGainsStatus::unstable_start) axis = std::move(again);
  };
  internal::in_parallel(groups.size(), internal::thread_count(0), [&] { return one; }, {});
  add_notes(gains, vehicle, options);
}

CascadeGains as_cascade(const FlownGains& gains, double dt) {
  CascadeGains cascade;
  cascade.dt = dt;
  const auto add = [&](CascadeAxis axis, double Kp, double Ki, double Kd) {
    PidLoop loop = cascade_loop(axis);
    loop.Kp = Kp;
    loop.Ki = Ki;
    loop.Kd = Kd;
    if (axis == CascadeAxis::pitch || axis == CascadeAxis::roll) {
      const FlownAxisGains& of = gains.axes[axis == CascadeAxis::pitch ? 0 : 1];
      loop.rate_lead = of.rate_lead;
      loop.rate_filter = of.rate_filter;
    }
    cascade.loops.push_back(loop);
  };
  // τ = -F [p; v; tilt; rate; ∫p] with F_tilt = Kp of the tilt, F_p = Kp of the tilt times Kp of
  // the position, and so on; a measured rate enters a loop with its own sign.
  const RowVectorXd &x = gains.axes[0].F, &y = gains.axes[1].F;
  add(CascadeAxis::x, x(0) / x(2), x(4) / x(2), -x(1) / x(2));
  add(CascadeAxis::y, y(0) / y(2), y(4) / y(2), -y(1) / y(2));
  add(CascadeAxis::pitch, x(2), gains.axes[0].tilt_integral * x(2), -x(3));
  add(CascadeAxis::roll, y(2), gains.axes[1].tilt_integral * y(2), -y(3));
  const RowVectorXd& yaw = gains.axes[3].F;
  add(CascadeAxis::yaw, yaw(0), yaw(2), -yaw(1));
  // The altitude loop commands the force along +z, which is -T.
  const RowVectorXd& z = gains.axes[2].F;
  add(CascadeAxis::altitude, -z(0), -z(2), z(1));
  return cascade;
}

Gains as_state_feedback(const FlownGains& from, const Vehicle& vehicle, double dt) {
  Gains gains;
  gains.states = ned_convention().states;
  gains.inputs = ned_convention().wrench;
  gains.K = MatrixXd::Zero(4, 12);
  gains.K_int = MatrixXd::Zero(4, 4);
  for (std::size_t i = 0; i < from.axes.size(); ++i) {
    const FlownAxisGains& one = from.axes[i];
    if (one.rate_lead != 0)
      throw InvalidInput(vehicle.name, fmt::format("the gains of {} act on the derivative of the "
                                                   "rate, which state feedback cannot represent",
                                                   to_string(one.axis)));
    if (one.tilt_integral != 0)
      throw InvalidInput(vehicle.name, fmt::format("the gains of {} have an integral in the tilt "
                                                   "loop, which state feedback cannot represent",
                                                   to_string(one.axis)));
    const std::vector<Index>& states = states_of(one.axis);
    for (std::size_t j = 0; j < states.size(); ++j)
      gains.K(wrench_of(one.axis), states[j]) = one.F(static_cast<Index>(j));
    gains.K_int(wrench_of(one.axis), static_cast<Index>(i)) = one.F(one.F.size() - 1);
    const Signal& first = gains.states[static_cast<std::size_t>(states.front())];
    gains.integrals.push_back({first.name, first.unit + " s"});
  }
  gains.x0 = VectorXd::Zero(12);
  gains.u0 = Eigen::Vector4d(vehicle.mass * vehicle.gravity, 0, 0, 0);
  gains.vehicle = vehicle.name;
  gains.convention = "ned";
  gains.input_kind = InputKind::wrench;
  gains.dt = dt;
  gains.axes = PositionAxes::heading;
  return gains;
}

}  // namespace quadtune
