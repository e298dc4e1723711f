// SPDX-License-Identifier: Apache-2.0
/// The equations of motion of a multirotor, templates over the scalar: evaluated with doubles for
/// simulation and with Ceres jets for exact Jacobians. Derivation and sources: docs/theory.md,
/// "Rigid body".
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <type_traits>

#include "quadtune/model/rotation.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/scalar.hpp"

namespace quadtune {

/// Maximum number of rotors; the bound keeps the equations free of allocations.
inline constexpr int kMaxRotors = 16;

/// Index of the first entry of each part of the 12 states.
inline constexpr int kPosition = 0;  ///< px py pz, world north-east-down [m]
inline constexpr int kAttitude = 3;  ///< roll pitch yaw [rad]
inline constexpr int kVelocity = 6;  ///< u v w, body axes [m/s]
inline constexpr int kRates = 9;     ///< p q r, body axes [rad/s]

/// [position(3) roll pitch yaw velocity(3) rates(3)], the state of ned_convention().
template <class T>
using StateVector = Eigen::Matrix<T, 12, 1>;

/// [position(3) qw qx qy qz velocity(3) rates(3)]: the same without the singularity at a pitch of
/// ±90°. The quaternion rotates body components to world components and has unit norm; the
/// integrator must renormalize it.
template <class T>
using QuaternionState = Eigen::Matrix<T, 13, 1>;

/// One speed per rotor [rad/s], at most kMaxRotors.
template <class T>
using RotorSpeeds = Eigen::Matrix<T, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxRotors, 1>;

/// The parameters of one rotor that the equations need; they may vary between flights.
template <class P>
struct BasicRotor {
  Vector3<P> position = Vector3<P>::Zero();  ///< of the hub from the centre of mass, body axes [m]
  P spin = P(1);                             ///< spin_sign()
  P thrust_a2 = P(0);                        ///< curves as in Rotor
  P thrust_a1 = P(0);                        ///< as Rotor::thrust_a1
  P torque_d2 = P(0);                        ///< as Rotor::torque_d2
  P torque_d1 = P(0);                        ///< as Rotor::torque_d1
  P inertia = P(0);                          ///< of the rotating parts about the axis [kg m²]
  P lag = P(0);            ///< time constant while the speed rises [s]; 0 means none
  P lag_down = P(0);       ///< while the speed falls
  P drag = P(0);           ///< aerodynamics of the moving hub, as in Rotor
  P inflow = P(0);         ///< as Rotor::inflow
  P flapping = P(0);       ///< as Rotor::flapping
  P ground_radius = P(0);  ///< radius of a rotor with ground effect [m], else 0
};

/// The parameters of a vehicle that the equations need, with a precomputed inverse of the inertia.
/// P is a double, or a Pack for several vehicles at once.
template <class P>
struct BasicRigidBody {
  BasicRigidBody() = default;
  /// For P = double.
  /// @param vehicle        mass > 0, inertia symmetric positive definite, 1..kMaxRotors rotors.
  /// @param ratio          air density over vehicle.air_density, ≥ 0.
  /// @throws InvalidInput  with the field and its value.
  explicit BasicRigidBody(const Vehicle& vehicle, double ratio = 1)
      : BasicRigidBody(of_vehicle(vehicle, ratio)) {
    static_assert(std::is_same_v<P, double>, "a vehicle's numbers are doubles");
  }

  P mass;                  ///< [kg]
  P inverse_mass;          ///< [1/kg]
  P gravity;               ///< [m/s²]
  Matrix3<P> J;            ///< [kg m²]
  Matrix3<P> J_inv;        ///< [1/(kg m²)]
  Vector3<P> cda;          ///< drag coefficient times area per body axis [m²]
  Vector3<P> linear_drag;  ///< per body axis [N s/m]
  P air_density;           ///< at the place of the flight [kg/m³]
  P density_ratio;         ///< air_density over the density of the rotor curves
  // Terms that the equations may skip.
  bool has_drag = true;                          ///< false: cda and linear_drag are 0
  bool principal_axes = false;                   ///< true: J is diagonal
  bool has_airflow = false;                      ///< true: a rotor has drag, inflow or flapping
  bool has_ground_effect = false;                ///< true: a rotor has ground effect
  int rotor_count = 0;                           ///< number of rotors, 1 to kMaxRotors
  std::array<BasicRotor<P>, kMaxRotors> rotors;  ///< the first rotor_count

 private:
  static BasicRigidBody of_vehicle(const Vehicle& vehicle, double density_ratio);
};

using RigidBody = BasicRigidBody<double>;  ///< A vehicle whose constants are plain numbers.

/// The loads of the rotors on the body, in body axes.
template <class T>
struct RotorLoads {
  Vector3<T> force = Vector3<T>::Zero();             ///< [N]
  Vector3<T> torque = Vector3<T>::Zero();            ///< about the centre of mass [N m]
  Vector3<T> angular_momentum = Vector3<T>::Zero();  ///< of the rotating parts, h [kg m²/s]
};

/// Adds the loads of one rotor: thrust along body -z at its hub, drag torque against its spin, and
/// angular momentum along its spin.
/// @param rotor   position and spin
/// @param thrust  [N];  @param torque  drag torque ≥ 0 [N m];  @param speed  [rad/s].
/// @param loads   receives the sum
template <class P, class T>
void add_rotor(const BasicRotor<P>& rotor, const T& thrust, const T& torque, const T& speed,
               RotorLoads<T>& loads) {
  loads.force.z() -= thrust;
  loads.torque.x() -= T(rotor.position.y()) * thrust;  // r × (0, 0, -T) = (-y T, x T, 0)
  loads.torque.y() += T(rotor.position.x()) * thrust;
  loads.torque.z() -= T(rotor.spin) * torque;                           // reaction of the air
  loads.angular_momentum.z() += T(rotor.spin * rotor.inertia) * speed;  // h = Σ J_r s w e_z
}

/// Loads of all rotors.
/// @param body    constants of the vehicle
/// @param speeds  one per rotor [rad/s].
template <class P, class Speeds>
[[nodiscard]] RotorLoads<typename Speeds::Scalar> rotor_loads(
    const BasicRigidBody<P>& body, const Eigen::MatrixBase<Speeds>& speeds) {
  using T = typename Speeds::Scalar;
  RotorLoads<T> loads;
  for (Eigen::Index i = 0; i < speeds.size(); ++i) {
    const BasicRotor<P>& rotor = body.rotors[static_cast<std::size_t>(i)];
    const T& w = speeds(i);
    add_rotor(rotor, T(rotor_thrust(rotor, w, body.density_ratio)),
              T(rotor_torque(rotor, w, body.density_ratio)), w, loads);
  }
  return loads;
}

/// Adds the effects of the motion of one hub through the air, v = airspeed + w × r: drag in the
/// rotor's plane, thrust lost in a climb, and the moment of flapping. Linear in airspeed and rates.
/// @param rotor     position and coefficients
/// @param speed     times the ratio of the air densities, with which all terms scale [rad/s]
/// @param airspeed  of the centre of mass, body axes [m/s]
/// @param rates     body axes [rad/s]
/// @param loads     receives the sum
template <class P, class T>
[[gnu::always_inline]] inline void add_rotor_airflow(const BasicRotor<P>& rotor, const T& speed,
                                                     const Vector3<T>& airspeed,
                                                     const Vector3<T>& rates,
                                                     RotorLoads<T>& loads) {
  const T x(rotor.position.x()), y(rotor.position.y()), z(rotor.position.z());
  const T vx = airspeed(0) + (rates(1) * z - rates(2) * y);
  const T vy = airspeed(1) + (rates(2) * x - rates(0) * z);
  const T vz = airspeed(2) + (rates(0) * y - rates(1) * x);
  const T Fx = -T(rotor.drag) * speed * vx, Fy = -T(rotor.drag) * speed * vy;
  const T Fz = -T(rotor.inflow) * speed * vz;
  loads.force.x() += Fx;
  loads.force.y() += Fy;
  loads.force.z() += Fz;
  // r × F and flapping, which tilts the disc back: forward motion pitches up, motion to the right
  // rolls left.
  loads.torque.x() += y * Fz - z * Fy - T(rotor.flapping) * speed * vy;
  loads.torque.y() += z * Fx - x * Fz + T(rotor.flapping) * speed * vx;
  loads.torque.z() += x * Fy - y * Fx;
}

/// add_rotor_airflow() for all rotors.
/// @param body      constants of the vehicle
/// @param speeds    one per rotor [rad/s];  @param airspeed  of the centre of mass, body axes [m/s]
/// @param rates     body axes [rad/s]
/// @param loads     receives the sum
template <class P, class Speeds, class T>
void add_airflow(const BasicRigidBody<P>& body, const Eigen::MatrixBase<Speeds>& speeds,
                 const Vector3<T>& airspeed, const Vector3<T>& rates, RotorLoads<T>& loads) {
  for (Eigen::Index i = 0; i < speeds.size(); ++i)
    add_rotor_airflow(body.rotors[static_cast<std::size_t>(i)],
                      T(T(speeds(i)) * T(body.density_ratio)), airspeed, rates, loads);
}

/// The loads of all rotors of a vehicle that moves through the air.
/// @param body      constants of the vehicle
/// @param speeds    one per rotor [rad/s];  @param airspeed  body axes [m/s]
/// @param rates     body axes [rad/s]
template <class P, class Speeds>
[[nodiscard]] RotorLoads<typename Speeds::Scalar> rotor_loads(
    const BasicRigidBody<P>& body, const Eigen::MatrixBase<Speeds>& speeds,
    const Vector3<typename Speeds::Scalar>& airspeed,
    const Vector3<typename Speeds::Scalar>& rates) {
  RotorLoads<typename Speeds::Scalar> loads = rotor_loads(body, speeds);
  if (body.has_airflow) add_airflow(body, speeds, airspeed, rates, loads);
  return loads;
}

/// Ratio of a rotor's thrust at height h to its thrust far from the ground, 1/(1 - (r/4h)²), with h
/// bounded below by half the radius, hence at most 4/3. Source: Cheeseman and Bennett 1955.
/// @param radius  r [m], 0: no effect;  @param height  h of the hub above level ground [m]
template <class T>
[[nodiscard]] T ground_effect(const T& radius, const T& height) {
  const T min = T(0.5) * radius;
  const T ratio = select(radius > T(0), radius / (T(4) * max_of(height, min)), T(0));
  return T(1) / (T(1) - ratio * ratio);
}

/// The loads of a commanded wrench.
/// @param wrench            [T, τx, τy, τz], thrust T along body -z [N, N m].
/// @param angular_momentum  of the rotors along body z, which does not follow from the wrench [kg
///                          m²/s].
template <class T>
[[nodiscard]] RotorLoads<T> wrench_loads(const Eigen::Matrix<T, 4, 1>& wrench,
                                         double angular_momentum = 0) {
  RotorLoads<T> loads;
  loads.force.z() = -wrench(0);
  loads.torque = wrench.template tail<3>();
  loads.angular_momentum.z() = T(angular_momentum);
  return loads;
}

/// Drag of the body moving at `airspeed` (body axes) through the air [N].
template <class P, class T>
[[nodiscard, gnu::always_inline]] inline Vector3<T> drag_force(const BasicRigidBody<P>& body,
                                                               const Vector3<T>& airspeed) {
  using std::abs;
  const P half_density = 0.5 * body.air_density;
  // F_i = -(rho/2) cda_i |v_i| v_i - linear_i v_i
  const auto along = [&](int i) {
    return T(-(T(half_density * body.cda(i)) * abs(airspeed(i)) + T(body.linear_drag(i))) *
             airspeed(i));
  };
  return {along(0), along(1), along(2)};
}

/// v' in body axes [m/s²].
/// @param body      constants of the vehicle
/// @param down      the world's z axis in body components (unit).
/// @param velocity  body axes [m/s];  @param rates  body axes [rad/s].
/// @param force     of the rotors [N].
/// @param airspeed  velocity through the air, body axes [m/s].
template <class P, class T>
[[nodiscard, gnu::always_inline]] inline Vector3<T> linear_acceleration(
    const BasicRigidBody<P>& body, const Vector3<T>& down, const Vector3<T>& velocity,
    const Vector3<T>& rates, const Vector3<T>& force, const Vector3<T>& airspeed) {
  const T gravity = T(body.gravity), inverse_mass = T(body.inverse_mass);
  const T &p = rates(0), &q = rates(1), &r = rates(2);
  const T &u = velocity(0), &v = velocity(1), &w = velocity(2);
  // v' = F/m + g - w × v
  const Vector3<T> free(down(0) * gravity + (r * v - q * w), down(1) * gravity + (p * w - r * u),
                        down(2) * gravity + (q * u - p * v));
  if (!body.has_drag)
    return {force(0) * inverse_mass + free(0), force(1) * inverse_mass + free(1),
            force(2) * inverse_mass + free(2)};
  const Vector3<T> drag = drag_force(body, airspeed);
  return {(force(0) + drag(0)) * inverse_mass + free(0),
          (force(1) + drag(1)) * inverse_mass + free(1),
          (force(2) + drag(2)) * inverse_mass + free(2)};
}

/// J w' in body axes [N m].
template <class P, class T>
[[nodiscard, gnu::always_inline]] inline Vector3<T> net_torque(const BasicRigidBody<P>& body,
                                                               const Vector3<T>& rates,
                                                               const RotorLoads<T>& loads) {
  const T &p = rates(0), &q = rates(1), &r = rates(2);
  const Vector3<T>& h = loads.angular_momentum;
  // J w' = τ - w × L with L = J w + h
  T Lx, Ly, Lz;
  if (body.principal_axes) {
    Lx = T(body.J(0, 0)) * p + h(0);
    Ly = T(body.J(1, 1)) * q + h(1);
    Lz = T(body.J(2, 2)) * r + h(2);
  } else {
    Lx = T(body.J(0, 0)) * p + T(body.J(0, 1)) * q + T(body.J(0, 2)) * r + h(0);
    Ly = T(body.J(1, 0)) * p + T(body.J(1, 1)) * q + T(body.J(1, 2)) * r + h(1);
    Lz = T(body.J(2, 0)) * p + T(body.J(2, 1)) * q + T(body.J(2, 2)) * r + h(2);
  }
  return {loads.torque(0) - (q * Lz - r * Ly), loads.torque(1) - (r * Lx - p * Lz),
          loads.torque(2) - (p * Ly - q * Lx)};
}

/// w' for the torque J w' [rad/s²].
template <class P, class T>
[[nodiscard, gnu::always_inline]] inline Vector3<T> angular_acceleration(
    const BasicRigidBody<P>& body, const Vector3<T>& torque) {
  const Matrix3<P>& I = body.J_inv;
  if (body.principal_axes)
    return {T(I(0, 0)) * torque(0), T(I(1, 1)) * torque(1), T(I(2, 2)) * torque(2)};
  return {T(I(0, 0)) * torque(0) + T(I(0, 1)) * torque(1) + T(I(0, 2)) * torque(2),
          T(I(1, 0)) * torque(0) + T(I(1, 1)) * torque(1) + T(I(1, 2)) * torque(2),
          T(I(2, 0)) * torque(0) + T(I(2, 1)) * torque(1) + T(I(2, 2)) * torque(2)};
}

/// x' of the 12 states with Euler angles. Not valid for |pitch| near 90°, see
/// euler_angles_are_regular(): the rates of roll and yaw are unbounded there.
template <class P, class T>
[[nodiscard]] StateVector<T> state_derivative(const BasicRigidBody<P>& body,
                                              const StateVector<T>& x, const RotorLoads<T>& loads) {
  const T &roll = x(kAttitude), &pitch = x(kAttitude + 1), &yaw = x(kAttitude + 2);
  const Vector3<T> velocity = x.template segment<3>(kVelocity);
  const Vector3<T> rates = x.template segment<3>(kRates);
  const Matrix3<T> R_WB = rotation_of_euler(roll, pitch, yaw);
  const Vector3<T> down = R_WB.row(2).transpose();
  StateVector<T> derivative;
  derivative.template segment<3>(kPosition) = R_WB * velocity;
  derivative.template segment<3>(kAttitude) = euler_rate_matrix(roll, pitch) * rates;
  derivative.template segment<3>(kVelocity) =
      linear_acceleration(body, down, velocity, rates, loads.force, velocity);
  derivative.template segment<3>(kRates) =
      angular_acceleration(body, net_torque(body, rates, loads));
  return derivative;
}

/// R_WB of a unit quaternion, with its entries expanded.
template <class T>
[[nodiscard, gnu::always_inline]] inline Matrix3<T> rotation_of_quaternion(const T& qw, const T& qx,
                                                                           const T& qy,
                                                                           const T& qz) {
  const T x2 = qx + qx, y2 = qy + qy, z2 = qz + qz;
  const T xx = qx * x2, yy = qy * y2, zz = qz * z2;
  const T xy = qx * y2, xz = qx * z2, yz = qy * z2;
  const T wx = qw * x2, wy = qw * y2, wz = qw * z2;
  Matrix3<T> R;
  R(0, 0) = T(1) - (yy + zz);
  R(0, 1) = xy - wz;
  R(0, 2) = xz + wy;
  R(1, 0) = xy + wz;
  R(1, 1) = T(1) - (xx + zz);
  R(1, 2) = yz - wx;
  R(2, 0) = xz - wy;
  R(2, 1) = yz + wx;
  R(2, 2) = T(1) - (xx + yy);
  return R;
}

/// x' of the 13 states with a quaternion, regular in every attitude.
/// @param body        constants of the vehicle
/// @param x           13 numbers, the first entries of a longer state
/// @param loads       of the rotors, in body axes
/// @param wind        velocity of the air, world axes [m/s]; nullptr: no wind
/// @param derivative  13 numbers
template <class P, class T, class From, class To>
[[gnu::always_inline]] inline void rigid_motion(const BasicRigidBody<P>& body, const From& x,
                                                const RotorLoads<T>& loads, const Vector3<T>* wind,
                                                To& derivative) {
  const T &qw = x(3), &qx = x(4), &qy = x(5), &qz = x(6);
  const Vector3<T> velocity(x(7), x(8), x(9));
  const Vector3<T> rates(x(10), x(11), x(12));
  const Matrix3<T> R = rotation_of_quaternion(qw, qx, qy, qz);
  const Vector3<T> down(R(2, 0), R(2, 1), R(2, 2));
  Vector3<T> airspeed = velocity;
  if (wind != nullptr)
    for (int i = 0; i < 3; ++i)
      airspeed(i) -= R(0, i) * (*wind)(0) + R(1, i) * (*wind)(1) + R(2, i) * (*wind)(2);
  const Vector3<T> speeding =
      linear_acceleration(body, down, velocity, rates, loads.force, airspeed);
  const Vector3<T> turning = angular_acceleration(body, net_torque(body, rates, loads));
  unrolled<3>([&](int i) __attribute__((always_inline)) {
    derivative(i) = R(i, 0) * velocity(0) + R(i, 1) * velocity(1) + R(i, 2) * velocity(2);
    derivative(7 + i) = speeding(i);
    derivative(10 + i) = turning(i);
  });
  // q' = ½ q ⊗ (0, w)
  const T p = T(0.5) * rates(0), q = T(0.5) * rates(1), r = T(0.5) * rates(2);
  derivative(3) = -(qx * p + qy * q + qz * r);
  derivative(4) = qw * p + (qy * r - qz * q);
  derivative(5) = qw * q + (qz * p - qx * r);
  derivative(6) = qw * r + (qx * q - qy * p);
}

/// The derivative of the 13 states, without wind.
template <class P, class T>
[[nodiscard]] QuaternionState<T> state_derivative(const BasicRigidBody<P>& body,
                                                  const QuaternionState<T>& x,
                                                  const RotorLoads<T>& loads) {
  QuaternionState<T> derivative;
  rigid_motion<P, T>(body, x, loads, nullptr, derivative);
  return derivative;
}

/// Converts the 12 states to the 13.
template <class T>
[[nodiscard]] QuaternionState<T> quaternion_state(const StateVector<T>& x) {
  const Eigen::Quaternion<T> q = quaternion_of_euler(x(3), x(4), x(5));
  QuaternionState<T> result;
  result << x.template head<3>(), q.w(), q.x(), q.y(), q.z(), x.template tail<6>();
  return result;
}

/// The 12 states with the Euler angles of the quaternion; the inverse of quaternion_state(). Roll
/// is 0 if the nose points straight up or down.
template <class T>
[[nodiscard]] StateVector<T> euler_state(const QuaternionState<T>& x) {
  const Eigen::Quaternion<T> q(x(3), x(4), x(5), x(6));
  StateVector<T> result;
  result << x.template head<3>(), euler_of_quaternion(q), x.template tail<6>();
  return result;
}

}  // namespace quadtune
