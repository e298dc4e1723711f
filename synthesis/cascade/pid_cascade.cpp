// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/pid/pid_cascade.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lyapunov/eigenvalues.hpp"
#include "quadtune/control/cascade_law.hpp"
#include "quadtune/control/pid.hpp"
#include "quadtune/discretize/delay.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/in_parallel.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/synthesis/flown_axis.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr const char* kWhere = "pid cascade";

/// The indices of an axis in ned_convention().
struct AxisFacts {
  CascadeAxis axis;
  Index value;  ///< index of the state
  Index rate;   ///< index of the state
  Index input;  ///< component of the wrench; for an outer loop that of its inner loop
  std::optional<CascadeAxis> inside;
};

constexpr std::array<AxisFacts, kCascadeAxes> kAxes = {{
    {CascadeAxis::x, 0, 6, 2, CascadeAxis::pitch},
    {CascadeAxis::y, 1, 7, 1, CascadeAxis::roll},
    {CascadeAxis::pitch, 4, 10, 2, {}},
    {CascadeAxis::roll, 3, 9, 1, {}},
    {CascadeAxis::yaw, 5, 11, 3, {}},
    {CascadeAxis::altitude, 2, 8, 0, {}},
}};

/// Inner loops first; the last two are outer loops.
constexpr std::array<CascadeAxis, kCascadeAxes> kDesignOrder = {
    CascadeAxis::roll,     CascadeAxis::pitch, CascadeAxis::yaw,
    CascadeAxis::altitude, CascadeAxis::y,     CascadeAxis::x};
constexpr std::size_t kInnerAxes = 4;

const AxisFacts& facts(CascadeAxis axis) { return kAxes[index_of(axis)]; }

std::vector<Index> states_of(const AxisFacts& axis) {
  if (!axis.inside) return {axis.value, axis.rate};
  const AxisFacts& inside = facts(*axis.inside);
  return {axis.value, axis.rate, inside.value, inside.rate};
}

void require_hover(const ContinuousLti& hover) {
  validate(hover, kWhere);
  if (hover.A.rows() != 12 || hover.B.cols() != 4)
    throw InvalidInput(kWhere, fmt::format("the model has {} states and {} inputs, expected the 12 "
                                           "states of hover and the 4 inputs of the wrench",
                                           hover.A.rows(), hover.B.cols()));
}

/// Extracts value and rate from the outputs of a model, with the sign that makes them increase with
/// the command.
CascadePlant as_loop(const DiscreteLti& sampled, Index value, double sign) {
  CascadePlant plant;
  plant.dt = sampled.dt;
  plant.A = sampled.A;
  plant.B = sampled.B;
  plant.C = sign * sampled.C.middleRows(value, 2);
  plant.D = MatrixXd::Zero(2, 1);
  return plant;
}

/// The gains of a loop in its own sign, and the lead of its rate as in PidSettings.
struct OwnLoop {
  PidGains gains;
  double rate_lead = 0, rate_share = 0;
};

/// The plant whose rate has the lead of the loop; its first states are those of the plant.
CascadePlant with_lead(const CascadePlant& plant, const OwnLoop& loop) {
  if (loop.rate_lead == 0) return plant;
  PeriodicLti part;
  part.dt = plant.dt;
  part.A = {plant.A};
  part.B = {plant.B};
  part.C = plant.C;
  part = with_rate_lead(part, 1, loop.rate_lead, loop.rate_share);
  CascadePlant result = plant;
  result.A = part.A.front();
  result.B = part.B.front();
  result.C = part.C;
  result.states.clear();
  return result;
}

/// A vehicle with its sampling and delays, split into the plants of the loops.
class LoopPlants {
 public:
  LoopPlants(const CascadeVehicle& vehicle, const CascadeSpecification& specification)
      : model_(vehicle.hover),
        lag_(specification.lag.value_or(vehicle.lag)),
        specification_(specification) {
    require_hover(model_);
  }

  /// The sign of the effect of a positive command on the value of the loop. Plants are multiplied
  /// by it, and so are the gains.
  [[nodiscard]] double sign(CascadeAxis name) const {
    const AxisFacts& axis = facts(name);
    const double effect = axis.inside ? model_.A(axis.rate, facts(*axis.inside).value)
                                      : model_.B(axis.rate, axis.input);
    if (effect == 0)
      throw InvalidInput(kWhere, fmt::format("{} does not respond to its command, {}, expected a "
                                             "controllable vehicle",
                                             to_string(name), cascade_loop(name).output));
    // The altitude loop commands a force along +z, but the input of the model is T along -z.
    return (effect < 0) != (name == CascadeAxis::altitude) ? -1 : 1;
  }

  /// The plant of a loop.
  /// @param inner  its inner loop; not used for an inner loop
  [[nodiscard]] CascadePlant plant(CascadeAxis name, const OwnLoop& inner) const {
    const AxisFacts& axis = facts(name);
    const DiscreteLti sampled = sampled_chain(axis);
    if (!axis.inside) return as_loop(sampled, 0, sign(name));
    const double inner_sign = sign(*axis.inside);
    CascadePlant closed = closed_at_command(with_lead(as_loop(sampled, 2, inner_sign), inner),
                                            inner.gains, specification_.method);
    // The set point of the inner loop has its sign; the first states are those of the chain.
    closed.B *= inner_sign;
    closed.C.setZero();
    closed.C.leftCols(sampled.A.rows()) = sign(name) * sampled.C.topRows(2);
    return closed;
  }

  [[nodiscard]] DiscreteLti whole() const {
    Eigen::VectorXd delays = Eigen::VectorXd::Zero(12);
    for (const AxisFacts& axis : kAxes)
      for (const Index state : {axis.value, axis.rate})
        delays(state) = specification_.delay[index_of(axis.axis)];
    return sampled(model_, delays);
  }

 private:
  [[nodiscard]] DiscreteLti sampled(const ContinuousLti& part,
                                    const Eigen::VectorXd& delays) const {
    const ContinuousLti lagged = with_actuator_lag(part, lag_);
    if (delays.isZero(0)) {
      ContinuousLti written = lagged;
      if (written.C.size() == 0) {
        written.C = MatrixXd::Identity(lagged.A.rows(), lagged.A.rows());
        written.outputs = lagged.states;
      }
      return discretize_zoh(written, specification_.dt);
    }
    // The delay common to all signals is equivalent to one of the inputs, which are fewer.
    const double shared = delays.minCoeff();
    return discretize_zoh(
        lagged, specification_.dt,
        {Eigen::VectorXd::Constant(part.B.cols(), shared), (delays.array() - shared).matrix()});
  }

  [[nodiscard]] DiscreteLti sampled_chain(const AxisFacts& axis) const {
    const std::vector<Index> states = states_of(axis);
    ContinuousLti part;
    part.A = model_.A(states, states);
    part.B = model_.B(states, std::vector{axis.input});
    if (axis.axis == CascadeAxis::altitude) part.B = -part.B;
    Eigen::VectorXd delays = Eigen::VectorXd::Constant(static_cast<Index>(states.size()),
                                                       specification_.delay[index_of(axis.axis)]);
    if (axis.inside) delays.tail(2).setConstant(specification_.delay[index_of(*axis.inside)]);
    return sampled(part, delays);
  }

  const ContinuousLti& model_;
  double lag_;
  const CascadeSpecification& specification_;
};

std::optional<OwnLoop> in_own_sign(const CascadeGains& gains, CascadeAxis axis, double sign) {
  for (const PidLoop& loop : gains.loops)
    if (loop.name == to_string(axis)) {
      const PidSettings<double> settings = pid_settings(loop, gains.dt);
      return OwnLoop{{sign * loop.Kp, sign * loop.Ki, -sign * loop.Kd, 0},
                     settings.rate_lead,
                     settings.rate_share};
    }
  return {};
}

PidLoop as_written(CascadeAxis axis, const PidGains& gains, double sign) {
  PidLoop loop = cascade_loop(axis);
  // Adding 0 converts -0 to 0.
  loop.Kp = sign * gains.Kp + 0.0;
  loop.Ki = sign * gains.Ki + 0.0;
  loop.Kd = -sign * gains.Kd + 0.0;
  return loop;
}

/// The maximum command per error that the available authority permits; see
/// CascadeVehicle::authority.
double max_gain(CascadeAxis axis, const Eigen::Vector4d& authority) {
  constexpr double kTilt = 0.2;      // [rad]
  constexpr double kHeading = 0.35;  // [rad]
  constexpr double kDistance = 0.5;  // [m]
  switch (axis) {
    case CascadeAxis::x:
    case CascadeAxis::y:
      return kTilt / kDistance;
    case CascadeAxis::pitch:
    case CascadeAxis::roll:
      return authority(facts(axis).input) / kTilt;
    case CascadeAxis::yaw:
      return authority(facts(axis).input) / kHeading;
    case CascadeAxis::altitude:
      return authority(facts(axis).input) / kDistance;
  }
  return kUnbounded;
}

/// @param gain_max   maximum gain of a loop whose bandwidth is not specified
/// @param published  evidence of the published loop; nullptr if it is not used as a baseline
CascadeLoopBounds bounds_of(const CascadeRequirement& requirement, double fastest, double gain_max,
                            const CascadeLoopEvidence* published) {
  CascadeLoopBounds bounds;
  bounds.rate_crossover = requirement.bandwidth.value_or(0);
  bounds.rate_crossover_max = fastest;
  bounds.Ms_max = requirement.Ms_max;
  bounds.tracking_max = requirement.tracking_max;
  bounds.integral = requirement.integral;
  if (requirement.bandwidth) return bounds;
  bounds.value_noise_max = gain_max;
  if (published == nullptr || !published->margins.stable) return bounds;
  constexpr double kNearer = 0.98;
  bounds.rate_crossover_max = kUnbounded;
  bounds.Ms_max = std::min(bounds.Ms_max, 1 + kNearer * (published->margins.Ms - 1));
  bounds.value_noise_max = published->value_noise;
  bounds.rate_noise_max = published->rate_noise;
  // The load response of the published loop is a bound only if that loop is robust enough, and if
  // it has no integral or the new loop has one as well.
  const bool comparable = requirement.integral || std::isinf(published->load_integral);
  if (published->margins.Ms <= requirement.Ms_max && comparable)
    bounds.load_peak_max = published->load_peak;
  return bounds;
}

/// A loop with given gains around its inner loop with given gains.
struct GivenLoop {
  PidGains gains;
  CascadeLoopEvidence evidence;
};

std::optional<GivenLoop> given_loop(const LoopPlants& hover, const CascadeGains& gains,
                                    PidMethod method, CascadeAxis axis) {
  const std::optional<CascadeAxis> inside = facts(axis).inside;
  OwnLoop inner;
  if (inside) {
    const auto found = in_own_sign(gains, *inside, hover.sign(*inside));
    if (!found) return {};
    inner = *found;
  }
  const auto found = in_own_sign(gains, axis, hover.sign(axis));
  if (!found) return {};
  const CascadePlant plant = with_lead(hover.plant(axis, inner), *found);
  return GivenLoop{found->gains, cascade_loop_evidence(plant, found->gains, method)};
}

void add_published(const LoopPlants& hover, const CascadeGains& published, PidMethod method,
                   CascadeAxisDesign& loop) {
  const std::optional<GivenLoop> given = given_loop(hover, published, method, loop.axis);
  if (!given) return;
  loop.published = given->gains;
  loop.published_evidence = given->evidence;
}

/// Designs one loop.
/// @param inner  its inner loop; nullptr for an inner loop
CascadeAxisDesign design_axis(const LoopPlants& hover, const CascadeVehicle& vehicle,
                              const CascadeSpecification& specification, CascadeAxis axis,
                              const CascadeLoopDesign* inner) {
  // The zero-order hold has a phase lag of nine degrees at a twentieth of the sample rate.
  const double by_clock = 2 * std::numbers::pi / specification.dt / 20;
  constexpr double kSeparation = 3;
  CascadeAxisDesign loop;
  loop.axis = axis;
  if (vehicle.published) add_published(hover, *vehicle.published, specification.method, loop);
  const bool measured = loop.published && specification.use_published;
  loop.bounds =
      bounds_of(specification.requirements[index_of(axis)],
                inner ? inner->evidence.bandwidth / kSeparation : by_clock,
                max_gain(axis, vehicle.authority), measured ? &loop.published_evidence : nullptr);
  loop.bounds.p_pi = specification.structure == CascadeStructure::p_pi;
  loop.design = design_cascade_loop(hover.plant(axis, inner ? OwnLoop{inner->gains} : OwnLoop{}),
                                    loop.bounds, specification.method);
  if (std::isinf(loop.bounds.rate_noise_max))  // not bounded by a published loop
    std::replace(loop.design.binding.begin(), loop.design.binding.end(), std::string("value noise"),
                 std::string("authority"));
  return loop;
}

/// Poles of the closed loop with all axes.
Eigen::VectorXcd poles_of(const PidCascade& cascade, PidMethod method) {
  return internal::eigenvalues(closed_loop(cascade.plant, cascade_law(cascade.gains, method)).A);
}

/// Adds a note if the model has couplings between the axes, which the chains of the loops ignore.
void note_coupling(const ContinuousLti& hover, std::vector<std::string>& notes) {
  MatrixXd A = hover.A;
  MatrixXd B = hover.B;
  for (const AxisFacts& axis : kAxes) {
    const std::vector<Index> states = states_of(axis);
    A(states, states).setZero();
    B(states, std::vector{axis.input}).setZero();
  }
  constexpr double kCoupled = 1e-6;
  if (A.cwiseAbs().maxCoeff() > kCoupled * hover.A.cwiseAbs().maxCoeff() ||
      B.cwiseAbs().maxCoeff() > kCoupled * hover.B.cwiseAbs().maxCoeff())
    notes.emplace_back(
        "the axes are coupled: each loop was designed separately; rely on the margins and poles of "
        "the complete loop");
}

}  // namespace

ContinuousLti with_actuator_lag(const ContinuousLti& plant, double lag) {
  if (!(lag >= 0) || !std::isfinite(lag))
    throw InvalidInput(kWhere, fmt::format("lag is {} s, expected a finite number >= 0", lag));
  if (lag == 0) return plant;
  const Index nx = plant.A.rows();
  const Index nu = plant.B.cols();
  ContinuousLti lagged;
  lagged.A = MatrixXd::Zero(nx + nu, nx + nu);
  lagged.A.topLeftCorner(nx, nx) = plant.A;
  lagged.A.topRightCorner(nx, nu) = plant.B;
  lagged.A.bottomRightCorner(nu, nu).diagonal().setConstant(-1 / lag);
  lagged.B = MatrixXd::Zero(nx + nu, nu);
  lagged.B.bottomRows(nu).diagonal().setConstant(1 / lag);
  const MatrixXd C = plant.C.size() ? plant.C : MatrixXd::Identity(nx, nx);
  lagged.C = MatrixXd::Zero(C.rows(), nx + nu);
  lagged.C.leftCols(nx) = C;
  lagged.D = MatrixXd::Zero(C.rows(), nu);
  lagged.inputs = plant.inputs;
  lagged.outputs = plant.C.size() ? plant.outputs : plant.states;
  if (!plant.states.empty() && !plant.inputs.empty()) {
    lagged.states = plant.states;
    for (const Signal& input : plant.inputs)
      lagged.states.push_back({"lagged_" + input.name, input.unit});
  }
  return lagged;
}

DiscreteLti sampled_hover(const CascadeVehicle& vehicle,
                          const CascadeSpecification& specification) {
  return LoopPlants(vehicle, specification).whole();
}

PidCascade pid_cascade(const CascadeVehicle& vehicle, const CascadeSpecification& specification) {
  const LoopPlants hover(vehicle, specification);
  PidCascade cascade;
  cascade.plant = hover.whole();
  note_coupling(vehicle.hover, cascade.notes);
  std::array<CascadeAxisDesign, kCascadeAxes> designed;
  // Loops that are not nested are designed in parallel.
  for (const auto& [first, count] :
       {std::pair(std::size_t{0}, kInnerAxes), std::pair(kInnerAxes, kCascadeAxes - kInnerAxes)}) {
    const auto loop = [&, first = first](std::size_t i) {
      const CascadeAxis axis = kDesignOrder[first + i];
      const std::optional<CascadeAxis> inside = facts(axis).inside;
      designed[index_of(axis)] =
          design_axis(hover, vehicle, specification, axis,
                      inside ? &designed[index_of(*inside)].design : nullptr);
    };
    internal::in_parallel(count, internal::thread_count(0),
                          [&]() -> internal::PartWorker { return loop; }, {});
    for (std::size_t i = 0; i < count; ++i) {
      const CascadeAxis axis = kDesignOrder[first + i];
      cascade.loops.push_back(designed[index_of(axis)]);
      if (!cascade.loops.back().design.solved()) return cascade;
    }
  }
  cascade.gains.dt = specification.dt;
  for (const CascadeAxis axis : kAllCascadeAxes)
    cascade.gains.loops.push_back(
        as_written(axis, designed[index_of(axis)].design.gains, hover.sign(axis)));
  cascade.poles = poles_of(cascade, specification.method);
  return cascade;
}

PidCascade assess_cascade(const CascadeVehicle& vehicle, const CascadeSpecification& specification,
                          const CascadeGains& gains) {
  const LoopPlants hover(vehicle, specification);
  PidCascade cascade;
  cascade.plant = hover.whole();
  cascade.gains = gains;
  note_coupling(vehicle.hover, cascade.notes);
  for (const CascadeAxis axis : kDesignOrder) {
    const std::optional<GivenLoop> given = given_loop(hover, gains, specification.method, axis);
    if (!given)
      throw InvalidInput(
          kWhere, fmt::format("the gains have no loop '{}', expected all of {}", to_string(axis),
                              internal::joined(cascade_axis_names(), ", ")));
    CascadeAxisDesign loop;
    loop.axis = axis;
    loop.design.status = CascadeLoopStatus::solved;
    loop.design.gains = given->gains;
    loop.design.evidence = given->evidence;
    cascade.loops.push_back(std::move(loop));
  }
  cascade.poles = poles_of(cascade, specification.method);
  return cascade;
}

}  // namespace quadtune
