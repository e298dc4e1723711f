// SPDX-License-Identifier: Apache-2.0
#include "flown/flown_body.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <array>
#include <cmath>
#include <limits>

#include "flown/flown_estimator.hpp"
#include "flown/on_board_jets.hpp"
#include "quadtune/control/allocation.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/uquad_filter.hpp"
#include "quadtune/linearize/trim.hpp"
#include "quadtune/model/rigid_body.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kWidth = 8;  ///< derivatives computed at once
using Jet = ceres::Jet<double, kWidth>;
using JetVector = Eigen::Matrix<Jet, Eigen::Dynamic, 1>;

/// Computes x' and the readings, stacked, from (x, rotor speeds with lag, commanded speeds),
/// stacked.
class Equations {
 public:
  explicit Equations(const FlightSetup& setup)
      : setup_(setup), body_(flown_vehicle(setup)), sensors_(sensors_of(setup)) {
    for (int i = 0; i < body_.rotor_count; ++i)
      if (body_.rotors[static_cast<std::size_t>(i)].lag > 0 ||
          body_.rotors[static_cast<std::size_t>(i)].lag_down > 0)
        lagging_.push_back(i);
  }

  [[nodiscard]] const std::vector<int>& lagging() const { return lagging_; }
  [[nodiscard]] Index states() const { return 12 + std::ssize(lagging_); }
  [[nodiscard]] Index rotors() const { return body_.rotor_count; }

  template <class T>
  [[nodiscard]] Eigen::Matrix<T, Eigen::Dynamic, 1> at(
      const Eigen::Matrix<T, Eigen::Dynamic, 1>& z) const {
    const StateVector<T> x = z.template head<12>();
    RotorSpeeds<T> speeds = z.tail(rotors());
    Eigen::Matrix<T, Eigen::Dynamic, 1> result(states() + kFrameSize);
    T reaction = T(0);
    for (std::size_t j = 0; j < lagging_.size(); ++j) {
      const int i = lagging_[j];
      const BasicRotor<double>& rotor = body_.rotors[static_cast<std::size_t>(i)];
      const Index row = 12 + static_cast<Index>(j);
      const T rise = (speeds(i) - z(row)) / T(std::max(rotor.lag, rotor.lag_down));
      result(row) = rise;
      reaction -= T(rotor.spin * rotor.inertia) * rise;
      speeds(i) = z(row);
    }
    const Vector3<T> velocity = x.template segment<3>(kVelocity);
    RotorLoads<T> loads =
        rotor_loads(body_, speeds, velocity, Vector3<T>(x.template segment<3>(kRates)));
    result.template tail<kFrameSize>() =
        readings<T>(x, Vector3<T>((loads.force + drag_force(body_, velocity)) / T(body_.mass)));
    loads.torque.z() += reaction;
    result.template head<12>() = state_derivative(body_, x, loads);
    return result;
  }

 private:
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, kFrameSize, 1> readings(const StateVector<T>& x,
                                                         const Vector3<T>& force) const {
    const T none = T(std::numeric_limits<double>::quiet_NaN());
    Eigen::Matrix<T, kFrameSize, 1> all = Eigen::Matrix<T, kFrameSize, 1>::Constant(none);
    const auto first = [](Reading reading) {
      return kReadingFirst[static_cast<std::size_t>(reading)];
    };
    const Matrix3<T> R_WB = rotation_of_euler(x(3), x(4), x(5));
    const Vector3<T> velocity = x.template segment<3>(kVelocity);
    const Vector3<T> rates = x.template segment<3>(kRates);
    const T height = -x(2);
    if (sensors_.accelerometer) all.template segment<3>(first(Reading::specific_force)) = force;
    if (sensors_.gyroscope) all.template segment<3>(first(Reading::rates)) = rates;
    if (sensors_.magnetometer)
      all.template segment<3>(first(Reading::magnetic_field)) =
          R_WB.transpose() * setup_.environment.magnetic_field.template cast<T>();
    if (sensors_.barometer) {
      const BarometerSensor& barometer = *sensors_.barometer;
      all(first(Reading::pressure)) =
          std::isfinite(barometer.fall)
              ? T(T(barometer.ground_pressure) + T(barometer.fall) * height)
              : barometric_pressure(height, T(barometer.ground_pressure));
    }
    if (sensors_.sonar) {
      const SonarSensor& sonar = *sensors_.sonar;
      const T range = height / R_WB(2, 2);
      if (range >= T(sonar.min_range) && range <= T(sonar.max_range))
        all(first(Reading::sonar)) = range;
    }
    if (sensors_.flow && !(height < T(sensors_.flow->min_height)) &&
        !(height > T(sensors_.flow->max_height))) {
      const FlowSensor& flow = *sensors_.flow;
      const int at = first(Reading::flow);
      const auto mean_square = [](double half) { return std::tan(half) * std::tan(half) / 3; };
      const T a = T(mean_square(flow.half_field_x)), b = T(mean_square(flow.half_field_y));
      if (setup_.flow == FlowModel::simplified) {
        const T gain = T(flow.simplified_rate_gain);
        all(at) = -velocity.x() + gain * rates.y() * height;
        all(at + 1) = -velocity.y() - gain * rates.x() * height;
      } else {
        all(at) = (velocity.z() * R_WB(2, 0) * a - velocity.x() * R_WB(2, 2)) / height -
                  rates.y() * (T(1) + a);
        all(at + 1) = (velocity.z() * R_WB(2, 1) * b - velocity.y() * R_WB(2, 2)) / height +
                      rates.x() * (T(1) + b);
      }
    }
    if (sensors_.gps) {
      all.template segment<3>(first(Reading::gps_position)) = x.template head<3>();
      all.template segment<3>(first(Reading::gps_velocity)) = R_WB * velocity;
    }
    if (sensors_.vision) all.template segment<3>(first(Reading::vision)) = x.template head<3>();
    return all;
  }

  const FlightSetup& setup_;
  RigidBody body_;
  Sensors sensors_;
  std::vector<int> lagging_;
};

VectorXd hover_speeds(const Vehicle& vehicle) {
  const TrimResult result = trim(vehicle, FlightCondition{});
  if (!result.solved())
    throw InvalidInput("flown plant", fmt::format("'{}' cannot hover: {}, expected a vehicle that "
                                                  "can",
                                                  vehicle.name, result.culprit));
  return result.u;
}

}  // namespace

MatrixXd commanded_speeds(const Vehicle& believed, const VectorXd& speeds, InputKind inputs) {
  const Index rotors = speeds.size();
  VectorXd per_thrust(rotors);
  for (Index i = 0; i < rotors; ++i) {
    const Rotor& rotor = believed.rotors[static_cast<std::size_t>(i)];
    per_thrust(i) = 1 / (2 * rotor.thrust_a2 * speeds(i) + rotor.thrust_a1);
  }
  switch (inputs) {
    case InputKind::wrench:
      return per_thrust.asDiagonal() * MatrixXd(allocation(believed).P.topRows(rotors));
    case InputKind::rotor_thrust:
      return per_thrust.asDiagonal();
    case InputKind::command:
      if (believed.motor.law == CommandLaw::speed_squared)
        return (0.5 * believed.motor.gain * speeds.cwiseInverse()).asDiagonal();
      return MatrixXd::Identity(rotors, rotors) * believed.motor.gain;
    case InputKind::rotor_speed:
      break;
  }
  return MatrixXd::Identity(rotors, rotors);
}

namespace {

/// Replaces the rotor speeds by linear combinations that each affect only thrust, roll, pitch or
/// yaw. As single speeds they would couple the axes through the rounding errors of sums that should
/// be 0.
void part_rotors(FlownBody& body) {
  constexpr Index kFirst = 12, kDown = 8;  // the accelerations of w, p, q, r are rows 8 to 11
  const Index rotors = body.A.rows() - kFirst;
  if (rotors < 4) return;
  MatrixXd effect = body.A.block(kDown, kFirst, 4, rotors);
  const VectorXd size = effect.rowwise().norm();
  if (!(size.minCoeff() > 0)) return;
  effect = (size.cwiseInverse().asDiagonal() * effect).eval();
  const Eigen::FullPivLU<MatrixXd> lu(effect);
  if (lu.rank() < 4) return;
  MatrixXd S = MatrixXd::Identity(body.A.rows(), body.A.rows());
  S.block(kFirst, kFirst, 4, rotors) = effect;
  // Changes of speed without effect on thrust and torques.
  if (rotors > 4) S.bottomRightCorner(rotors - 4, rotors) = lu.kernel().transpose();
  const MatrixXd inverse = S.inverse();
  body.A = (S * body.A * inverse).eval();
  body.B = (S * body.B).eval();
  body.C = (body.C * inverse).eval();
  static constexpr std::array<const char*, 4> kNames = {"rotors for thrust", "rotors for roll",
                                                        "rotors for pitch", "rotors for yaw"};
  for (Index i = 0; i < rotors; ++i)
    body.states[static_cast<std::size_t>(kFirst + i)].name =
        i < 4 ? kNames[static_cast<std::size_t>(i)] : "rotors against each other";
}

/// The groups of axes, see FlownAxis. Changes of the rotor speeds that affect neither thrust nor
/// torques belong to none of them.
enum class Group { north, east, altitude, yaw, none };

/// Returns the group of each state of a body after part_rotors().
std::vector<Group> groups_of_states(Index states) {
  using enum Group;
  std::vector<Group> groups = {north,    east, altitude, east, north,    yaw,  north, east,
                               altitude, east, north,    yaw,  altitude, east, north, yaw};
  groups.resize(static_cast<std::size_t>(states), none);
  return groups;
}

/// The group of each input [T τx τy τz].
constexpr std::array<Group, 4> kGroupsOfWrench = {Group::altitude, Group::east, Group::north,
                                                  Group::yaw};
/// The group of each component of the specific force.
constexpr std::array<Group, 3> kGroupsOfForce = {Group::north, Group::east, Group::altitude};

/// Sets the entries of M to 0 whose row and column belong to different groups.
/// @return  whether one of them exceeds the rounding of its row
template <class Rows, class Columns>
bool keep_groups(const Rows& rows, const Columns& columns, Eigen::Ref<MatrixXd> M) {
  constexpr double kRounding = 1e-13;
  bool coupled = false;
  for (Index i = 0; i < M.rows(); ++i) {
    const double size = M.row(i).cwiseAbs().maxCoeff();
    for (Index j = 0; j < M.cols(); ++j) {
      if (rows[static_cast<std::size_t>(i)] == columns[static_cast<std::size_t>(j)]) continue;
      coupled = coupled || std::abs(M(i, j)) > kRounding * size;
      M(i, j) = 0;
    }
  }
  return coupled;
}

}  // namespace

void separate_axes(FlownBody& body) {
  const bool lagging = body.A.rows() > 12;
  if (lagging && body.states[12].name != "rotors for thrust") return;
  const Eigen::ColPivHouseholderQR<MatrixXd> commands(body.commands);
  if (body.commands.cols() != 4 || commands.rank() < 4) return;
  const MatrixXd inverse = commands.solve(MatrixXd::Identity(body.commands.rows(), body.B.cols()));
  const std::vector<Group> states = groups_of_states(body.A.rows());
  keep_groups(states, states, body.A);
  // Without couplings, B and D keep their bytes.
  MatrixXd of_wrench = body.B * body.commands;
  if (keep_groups(states, kGroupsOfWrench, of_wrench)) body.B = of_wrench * inverse;
  const Index force = kReadingFirst[static_cast<std::size_t>(Reading::specific_force)];
  keep_groups(kGroupsOfForce, states, body.C.middleRows(force, 3));
  of_wrench = body.D.middleRows(force, 3) * body.commands;
  if (keep_groups(kGroupsOfForce, kGroupsOfWrench, of_wrench))
    body.D.middleRows(force, 3) = of_wrench * inverse;
}

FlownBody flown_body(const FlightSetup& setup, InputKind inputs, double height) {
  const Equations equations(setup);
  FlownBody result;
  result.speeds = hover_speeds(flown_vehicle(setup));
  result.x.setZero();
  result.x(2) = -height;
  const Index nx = equations.states(), rotors = equations.rotors();
  VectorXd z(nx + rotors);
  z.head<12>() = result.x;
  for (std::size_t j = 0; j < equations.lagging().size(); ++j)
    z(12 + static_cast<Index>(j)) = result.speeds(equations.lagging()[j]);
  z.tail(rotors) = result.speeds;
  MatrixXd slopes(nx + kFrameSize, nx + rotors);
  for (Index first = 0; first < z.size(); first += kWidth) {
    const Index count = std::min<Index>(kWidth, z.size() - first);
    JetVector zj = z.cast<Jet>();
    for (Index j = 0; j < count; ++j) zj(first + j).v(static_cast<int>(j)) = 1;
    const JetVector f = equations.at<Jet>(zj);
    for (Index i = 0; i < f.size(); ++i)
      slopes.row(i).segment(first, count) = f(i).v.head(count).transpose();
    result.readings.resize(kFrameSize);
    for (Index i = 0; i < kFrameSize; ++i) result.readings(i) = f(nx + i).a;
  }
  result.A = slopes.topLeftCorner(nx, nx);
  result.B = slopes.topRightCorner(nx, rotors);
  result.C = slopes.bottomLeftCorner(kFrameSize, nx);
  result.D = slopes.bottomRightCorner(kFrameSize, rotors);
  result.commands = commanded_speeds(setup.vehicle, result.speeds, inputs);
  result.states = ned_convention().states;
  for (const int i : equations.lagging())
    result.states.push_back({fmt::format("speed of rotor {}", i + 1), "rad/s"});
  result.inputs =
      input_signals(ned_convention(), inputs, static_cast<int>(rotors), setup.vehicle.motor.unit);
  part_rotors(result);
  return result;
}

}  // namespace quadtune::internal
