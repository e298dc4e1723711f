// SPDX-License-Identifier: Apache-2.0
/// The equations of motion of a multirotor, one function template over the scalar: doubles
/// simulate, Ceres jets give exact Jacobians. Derivation and sources: docs/theory.md, "Rigid body".
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <string>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/model/rotation.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// More rotors than any multirotor in use; a bound keeps the equations free of allocation.
inline constexpr int kMaxRotors = 16;

/// Where the parts of the 12 states begin.
inline constexpr int kPosition = 0;  ///< px py pz, world north-east-down [m]
inline constexpr int kAttitude = 3;  ///< roll pitch yaw [rad]
inline constexpr int kVelocity = 6;  ///< u v w, body axes [m/s]
inline constexpr int kRates = 9;     ///< p q r, body axes [rad/s]

/// [position(3) roll pitch yaw velocity(3) rates(3)], the state of ned_convention().
template <class T>
using StateVector = Eigen::Matrix<T, 12, 1>;

/// [position(3) qw qx qy qz velocity(3) rates(3)]: the same without the singularity at ±90° of
/// pitch. The quaternion takes body components to world ones and has unit norm; whoever integrates
/// it restores the norm.
template <class T>
using QuaternionState = Eigen::Matrix<T, 13, 1>;

/// One speed per rotor [rad/s], at most kMaxRotors.
template <class T>
using RotorSpeeds = Eigen::Matrix<T, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxRotors, 1>;

/// What the equations need of a vehicle, with the inertia's inverse made once.
struct RigidBody {
  /// @param vehicle        mass > 0, inertia symmetric positive definite, 1..kMaxRotors rotors.
  /// @param density_ratio  air density over vehicle.air_density, ≥ 0.
  /// @throws InvalidInput  naming the field and what came.
  explicit RigidBody(const Vehicle& vehicle, double density_ratio = 1);

  double mass;            ///< [kg]
  double gravity;         ///< [m/s²]
  Eigen::Matrix3d J;      ///< [kg m²]
  Eigen::Matrix3d J_inv;  ///< [1/(kg m²)]
  Drag drag;              ///< per body axis
  double air_density;     ///< where the vehicle flies [kg/m³]
  double density_ratio;   ///< of that density to the one at which the rotor curves hold
  std::vector<Rotor> rotors;
};

/// What the rotors do to the body, in body axes.
template <class T>
struct RotorLoads {
  Vector3<T> force = Vector3<T>::Zero();             ///< [N]
  Vector3<T> torque = Vector3<T>::Zero();            ///< about the centre of mass [N m]
  Vector3<T> angular_momentum = Vector3<T>::Zero();  ///< of the turning parts, h [kg m²/s]
};

/// Force and torque left over on a body in a given motion: m v' and J w'.
template <class T>
struct NetLoad {
  Vector3<T> force;   ///< m v' [N]
  Vector3<T> torque;  ///< J w' [N m]
};

inline RigidBody::RigidBody(const Vehicle& vehicle, double ratio)
    : mass(vehicle.mass),
      gravity(vehicle.gravity),
      J(vehicle.inertia),
      drag(vehicle.drag),
      air_density(vehicle.air_density * ratio),
      density_ratio(ratio),
      rotors(vehicle.rotors) {
  const std::string where = "vehicle '" + vehicle.name + "'";
  if (!(mass > 0) || !std::isfinite(mass))
    throw InvalidInput(where,
                       "mass is " + std::to_string(mass) + " kg, expected a positive number");
  if (!std::isfinite(gravity))
    throw InvalidInput(where, "gravity is not finite, expected a number of m/s²");
  if (rotors.empty() || rotors.size() > static_cast<std::size_t>(kMaxRotors))
    throw InvalidInput(where, std::to_string(rotors.size()) + " rotors, expected 1 to " +
                                  std::to_string(kMaxRotors));
  if (!(ratio >= 0) || !std::isfinite(air_density))
    throw InvalidInput(where, "density ratio is " + std::to_string(ratio) +
                                  ", expected a number that is not negative");
  const Eigen::LLT<Eigen::Matrix3d> llt(J);
  if (!J.allFinite() || !J.isApprox(J.transpose(), 1e-10) || llt.info() != Eigen::Success)
    throw InvalidInput(where,
                       "inertia is not a symmetric positive definite matrix, expected one because "
                       "the rates follow from its inverse");
  J_inv = llt.solve(Eigen::Matrix3d::Identity());
}

/// Adds one rotor: thrust along body -z at its hub, drag torque against its spin, momentum along
/// it.
/// @param thrust  [N];  @param torque  drag torque ≥ 0 [N m];  @param speed  [rad/s].
template <class T>
void add_rotor(const Rotor& rotor, const T& thrust, const T& torque, const T& speed,
               RotorLoads<T>& loads) {
  const double s = spin_sign(rotor.spin);
  loads.force.z() -= thrust;
  loads.torque.x() -= T(rotor.position.y()) * thrust;  // r × (0, 0, -T) = (-y T, x T, 0)
  loads.torque.y() += T(rotor.position.x()) * thrust;
  loads.torque.z() -= T(s) * torque;                           // the air turns the body back
  loads.angular_momentum.z() += T(s * rotor.inertia) * speed;  // h = Σ J_r s w e_z
}

/// Loads of all rotors.
/// @param speeds  one per rotor [rad/s].
template <class T>
[[nodiscard]] RotorLoads<T> rotor_loads(const RigidBody& body, const RotorSpeeds<T>& speeds) {
  RotorLoads<T> loads;
  for (Eigen::Index i = 0; i < speeds.size(); ++i) {
    const Rotor& rotor = body.rotors[static_cast<std::size_t>(i)];
    add_rotor(rotor, T(rotor_thrust(rotor, speeds(i), body.density_ratio)),
              T(rotor_torque(rotor, speeds(i), body.density_ratio)), speeds(i), loads);
  }
  return loads;
}

/// Loads of a commanded wrench.
/// @param wrench            [T, τx, τy, τz], thrust T along body -z [N, N m].
/// @param angular_momentum  of the rotors along body z, which a wrench does not tell [kg m²/s].
template <class T>
[[nodiscard]] RotorLoads<T> wrench_loads(const Eigen::Matrix<T, 4, 1>& wrench,
                                         double angular_momentum = 0) {
  RotorLoads<T> loads;
  loads.force.z() = -wrench(0);
  loads.torque = wrench.template tail<3>();
  loads.angular_momentum.z() = T(angular_momentum);
  return loads;
}

/// Drag of the body moving at `velocity` (body axes) through still air [N].
template <class T>
[[nodiscard]] Vector3<T> drag_force(const RigidBody& body, const Vector3<T>& velocity) {
  using std::abs;
  Vector3<T> force;
  for (int i = 0; i < 3; ++i) {
    const T& v = velocity(i);
    // F_i = -(rho/2) cda_i |v_i| v_i - linear_i v_i
    force(i) =
        -T(0.5 * body.air_density * body.drag.cda(i)) * abs(v) * v - T(body.drag.linear(i)) * v;
  }
  return force;
}

/// m v' and J w' in body axes.
/// @param down      the world's z axis in body components (unit).
/// @param velocity  body axes [m/s];  @param rates  body axes [rad/s].
template <class T>
[[nodiscard]] NetLoad<T> net_load(const RigidBody& body, const Vector3<T>& down,
                                  const Vector3<T>& velocity, const Vector3<T>& rates,
                                  const RotorLoads<T>& loads) {
  const Matrix3<T> J = body.J.cast<T>();
  NetLoad<T> net;
  // m v' = F - w × m v
  net.force = loads.force + drag_force(body, velocity) + down * T(body.mass * body.gravity) -
              rates.cross(velocity) * T(body.mass);
  // J w' = τ - w × (J w + h)
  net.torque = loads.torque - rates.cross(Vector3<T>(J * rates + loads.angular_momentum));
  return net;
}

/// x' of the 12 states with Euler angles. Not for |pitch| near 90°, see euler_angles_are_regular():
/// there the rates of roll and yaw grow without bound.
template <class T>
[[nodiscard]] StateVector<T> state_derivative(const RigidBody& body, const StateVector<T>& x,
                                              const RotorLoads<T>& loads) {
  const T &roll = x(kAttitude), &pitch = x(kAttitude + 1), &yaw = x(kAttitude + 2);
  const Vector3<T> velocity = x.template segment<3>(kVelocity);
  const Vector3<T> rates = x.template segment<3>(kRates);
  const Matrix3<T> R_WB = rotation_of_euler(roll, pitch, yaw);
  const Vector3<T> down = R_WB.row(2).transpose();
  const NetLoad<T> net = net_load(body, down, velocity, rates, loads);
  StateVector<T> derivative;
  derivative.template segment<3>(kPosition) = R_WB * velocity;
  derivative.template segment<3>(kAttitude) = euler_rate_matrix(roll, pitch) * rates;
  derivative.template segment<3>(kVelocity) = net.force * T(1 / body.mass);
  derivative.template segment<3>(kRates) = body.J_inv.cast<T>() * net.torque;
  return derivative;
}

/// x' of the 13 states with a quaternion, regular in every attitude.
template <class T>
[[nodiscard]] QuaternionState<T> state_derivative(const RigidBody& body,
                                                  const QuaternionState<T>& x,
                                                  const RotorLoads<T>& loads) {
  const Eigen::Quaternion<T> q(x(3), x(4), x(5), x(6));
  const Vector3<T> velocity = x.template segment<3>(7);
  const Vector3<T> rates = x.template segment<3>(10);
  const Matrix3<T> R_WB = q.toRotationMatrix();
  const Vector3<T> down = R_WB.row(2).transpose();
  const NetLoad<T> net = net_load(body, down, velocity, rates, loads);
  QuaternionState<T> derivative;
  derivative.template head<3>() = R_WB * velocity;
  // q' = ½ q ⊗ (0, w)
  derivative(3) = T(-0.5) * q.vec().dot(rates);
  derivative.template segment<3>(4) = (rates * q.w() + q.vec().cross(rates)) * T(0.5);
  derivative.template segment<3>(7) = net.force * T(1 / body.mass);
  derivative.template segment<3>(10) = body.J_inv.cast<T>() * net.torque;
  return derivative;
}

/// The 13 states of the same motion, and back (roll 0 where the nose is straight up or down).
template <class T>
[[nodiscard]] QuaternionState<T> quaternion_state(const StateVector<T>& x) {
  const Eigen::Quaternion<T> q = quaternion_of_euler(x(3), x(4), x(5));
  QuaternionState<T> result;
  result << x.template head<3>(), q.w(), q.x(), q.y(), q.z(), x.template tail<6>();
  return result;
}
template <class T>
[[nodiscard]] StateVector<T> euler_state(const QuaternionState<T>& x) {
  const Eigen::Quaternion<T> q(x(3), x(4), x(5), x(6));
  StateVector<T> result;
  result << x.template head<3>(), euler_of_quaternion(q), x.template tail<6>();
  return result;
}

}  // namespace quadtune
