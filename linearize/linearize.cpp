// SPDX-License-Identifier: Apache-2.0
#include "quadtune/linearize/linearize.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "jets.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"
#include "quadtune/model/rigid_body.hpp"

namespace quadtune {
namespace {

using internal::Jet;
using internal::JetVector;

// Entries of A below this fraction of the largest are rounding errors of the trim.
constexpr double kNoDependence = 1e-10;

// The model in ned_convention() with all states.
struct NedModel {
  Eigen::MatrixXd A;        // (12 × 12)
  Eigen::MatrixXd B;        // (12 × nu)
  Eigen::VectorXd x0_rate;  // (12)
  Eigen::VectorXd u0;       // (nu)
};

NedModel split(const internal::ValueAndJacobian& at, const Eigen::VectorXd& u0) {
  return {at.jacobian.leftCols(12), at.jacobian.rightCols(u0.size()), at.value, u0};
}

NedModel by_rotor_speeds(const RigidBody& body, const TrimResult& trim) {
  Eigen::VectorXd z(12 + trim.u.size());
  z << trim.x, trim.u;
  const auto f = [&](const JetVector& zj) -> StateVector<Jet> {
    const RotorSpeeds<Jet> speeds = zj.tail(trim.u.size());
    const StateVector<Jet> x = zj.head<12>();
    const Vector3<Jet> velocity = x.segment<3>(kVelocity), rates = x.segment<3>(kRates);
    return state_derivative(body, x, rotor_loads(body, speeds, velocity, rates));
  };
  return split(internal::differentiate(f, z, 12), trim.u);
}

NedModel by_wrench(const RigidBody& body, const TrimResult& trim) {
  const RotorLoads<double> loads = rotor_loads<double>(body, trim.u);
  Eigen::VectorXd u0(4);
  u0 << -loads.force.z(), loads.torque;
  Eigen::VectorXd z(16);
  z << trim.x, u0;
  const auto f = [&](const JetVector& zj) -> StateVector<Jet> {
    const Eigen::Matrix<Jet, 4, 1> wrench = zj.tail<4>();
    const StateVector<Jet> x = zj.head<12>();
    RotorLoads<Jet> asked = wrench_loads(wrench, loads.angular_momentum.z());
    if (body.has_airflow) {
      const Vector3<Jet> velocity = x.segment<3>(kVelocity), rates = x.segment<3>(kRates);
      add_airflow(body, trim.u, velocity, rates, asked);
    }
    return state_derivative(body, x, asked);
  };
  return split(internal::differentiate(f, z, 12), u0);
}

// ∂w/∂T of one rotor at speed w: 1/(2 a2 w + a1).
double speed_per_thrust(const BasicRotor<double>& rotor, double w, double density_ratio) {
  return 1 / ((2 * rotor.thrust_a2 * w + rotor.thrust_a1) * density_ratio);
}

// ∂w/∂c at speed w.
double speed_per_command(const MotorCommand& motor, double w) {
  return motor.law == CommandLaw::speed ? motor.gain : motor.gain / (2 * w);  // w² = gain c
}

NedModel by_inputs(const Vehicle& vehicle, const RigidBody& body, const TrimResult& trim,
                   InputKind kind) {
  if (kind == InputKind::wrench) return by_wrench(body, trim);
  NedModel model = by_rotor_speeds(body, trim);
  for (Eigen::Index i = 0; i < trim.u.size(); ++i) {
    const double w = trim.u(i);
    if (kind == InputKind::rotor_thrust) {
      model.B.col(i) *=
          speed_per_thrust(body.rotors[static_cast<std::size_t>(i)], w, body.density_ratio);
      model.u0(i) = trim.thrust(i);
    } else if (kind == InputKind::command) {
      model.B.col(i) *= speed_per_command(vehicle.motor, w);
      model.u0(i) = command_of_speed(vehicle.motor, w);
    }
  }
  return model;
}

// In a turn the position deviation e is expressed in axes that rotate with the heading:
// e = Rz(-Ωt) δp, hence e' = Rz(-Ωt) δp' - Ω ẑ × e, which makes A independent of time.
void turn_position_axes(double yaw_rate, NedModel& model) {
  model.A(kPosition, kPosition + 1) += yaw_rate;
  model.A(kPosition + 1, kPosition) -= yaw_rate;
}

std::vector<std::string> missing_states(const Eigen::MatrixXd& A,
                                        const std::vector<Eigen::Index>& kept,
                                        const std::vector<Signal>& states) {
  std::vector<bool> is_kept(12, false);
  for (const Eigen::Index i : kept) is_kept[static_cast<std::size_t>(i)] = true;
  const double min = kNoDependence * A.cwiseAbs().maxCoeff();
  std::vector<std::string> notes;
  for (const Eigen::Index i : kept)
    for (Eigen::Index j = 0; j < 12; ++j)
      if (!is_kept[static_cast<std::size_t>(j)] && std::abs(A(i, j)) > min)
        notes.push_back(fmt::format("{} depends on {}, which is not among the states",
                                    states[static_cast<std::size_t>(i)].name,
                                    states[static_cast<std::size_t>(j)].name));
  return notes;
}

void note_turning_axes(const Convention& convention, const std::vector<Eigen::Index>& kept,
                       double yaw_rate, std::vector<std::string>& notes) {
  std::string named;
  for (const Eigen::Index i : kept)
    if (convention.from_ned(i, 0) != 0 || convention.from_ned(i, 1) != 0)
      named += (named.empty() ? "" : ", ") + convention.states[static_cast<std::size_t>(i)].name;
  if (yaw_rate != 0 && !named.empty())
    notes.push_back(
        fmt::format("deviations of {} are along axes that turn with the heading, at "
                    "{:.6g} rad/s clockwise seen from above",
                    named, yaw_rate));
}

/// Without drag, a vehicle flies along a line at any speed as it hovers.
void note_missing_drag(const Vehicle& vehicle, const FlightCondition& condition,
                       std::vector<std::string>& notes) {
  const double speed = std::hypot(condition.speed, condition.climb);
  if (condition.kind == FlightKind::line && speed > 0 && !has_aerodynamics(vehicle))
    notes.push_back(
        fmt::format("the vehicle file gives no drag, so that flight at {:.6g} m/s "
                    "requires no tilt and no additional thrust, and has no speed limit",
                    speed));
}

}  // namespace

LinearizeOptions linearize_options(const LqrDesign& design) {
  LinearizeOptions options;
  options.convention = design.convention;
  options.inputs = design.input_kind;
  options.states = {StateSelection::Kind::list, design.states};
  return options;
}

Linearizer::Linearizer(const Vehicle& vehicle, const LinearizeOptions& options) {
  const Convention& c = convention(options.convention, "linearize");
  kept_ = selected_states(c, options.states, "linearize");
  const int rotors = static_cast<int>(vehicle.rotors.size());
  // Both maps are orthogonal as long as no states are left out.
  M_ = c.from_ned(kept_, Eigen::all);
  N_ = input_from_ned(c, options.inputs, rotors);
  unsolved_.convention = c.name;
  unsolved_.input_kind = options.inputs;
  unsolved_.plant.inputs = input_signals(c, options.inputs, rotors, vehicle.motor.unit);
  unsolved_.plant.states.reserve(kept_.size());
  for (const Eigen::Index i : kept_)
    unsolved_.plant.states.push_back(c.states[static_cast<std::size_t>(i)]);

  const auto nx = static_cast<Eigen::Index>(kept_.size());
  const auto nu = static_cast<Eigen::Index>(unsolved_.plant.inputs.size());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  unsolved_.plant.A = Eigen::MatrixXd::Constant(nx, nx, nan);
  unsolved_.plant.B = Eigen::MatrixXd::Constant(nx, nu, nan);
  unsolved_.x0 = unsolved_.x0_rate = Eigen::VectorXd::Constant(nx, nan);
  unsolved_.u0 = Eigen::VectorXd::Constant(nu, nan);
  result_ = unsolved_;
}

const Linearization& Linearizer::at(const Vehicle& vehicle, const TrimResult& trimmed) {
  if (!trimmed.solved()) {
    result_ = unsolved_;
    result_.trim = trimmed;
    return result_;
  }
  if (trimmed.u.size() != std::ssize(vehicle.rotors))
    throw InvalidInput("linearize",
                       fmt::format("the trim has {} rotor speeds, expected {}, the number of the "
                                   "vehicle's rotors",
                                   trimmed.u.size(), vehicle.rotors.size()));
  const RigidBody body(vehicle, trimmed.density_ratio);
  NedModel model = by_inputs(vehicle, body, trimmed, result_.input_kind);
  turn_position_axes(trimmed.yaw_rate, model);
  result_.trim = trimmed;
  result_.plant.A.noalias() = M_ * model.A * M_.transpose();
  result_.plant.B.noalias() = M_ * model.B * N_.transpose();
  result_.x0.noalias() = M_ * trimmed.x;
  result_.x0_rate.noalias() = M_ * model.x0_rate;
  result_.u0.noalias() = N_ * model.u0;
  require_finite(result_.plant.A, "linearize", "A of " + vehicle.name);
  require_finite(result_.plant.B, "linearize", "B of " + vehicle.name);
  return result_;
}

Linearization linearize(const Vehicle& vehicle, const TrimResult& trimmed,
                        const LinearizeOptions& options) {
  Linearization result = Linearizer(vehicle, options).at(vehicle, trimmed);
  if (!result.solved()) return result;
  const Convention& c = convention(options.convention, "linearize");
  const std::vector<Eigen::Index> kept = selected_states(c, options.states, "linearize");
  if (std::ssize(kept) < c.from_ned.rows()) {
    const LinearizeOptions all = {options.convention, options.inputs, {}};
    result.notes =
        missing_states(Linearizer(vehicle, all).at(vehicle, trimmed).plant.A, kept, c.states);
  }
  note_turning_axes(c, kept, trimmed.yaw_rate, result.notes);
  note_missing_drag(vehicle, trimmed.condition, result.notes);
  return result;
}

Linearization linearize(const Vehicle& vehicle, const FlightCondition& condition,
                        const LinearizeOptions& options, const TrimOptions& trim_options) {
  return linearize(vehicle, trim(vehicle, condition, trim_options), options);
}

}  // namespace quadtune
