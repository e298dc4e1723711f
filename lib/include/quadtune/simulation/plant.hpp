// SPDX-License-Identifier: Apache-2.0
/// The vehicle as it moves: rigid body, rotors with lag, wind and the ground, for commands that are
/// held. Equations: docs/theory.md, "Simulated flight".
#pragma once

#include <Eigen/Core>
#include <array>

#include "quadtune/model/rigid_body.hpp"
#include "quadtune/scalar.hpp"
#include "quadtune/simulation/integrators.hpp"

namespace quadtune {

/// Where the parts of the simulated state begin: those of QuaternionState, then the rotors' speeds.
inline constexpr int kQuaternion = 3;
inline constexpr int kBodyVelocity = 7;
inline constexpr int kBodyRates = 10;
inline constexpr int kRotorSpeeds = 13;

/// Level ground at z = 0 under four feet at the corners of a square. Each foot that is in the
/// ground is pushed out by a spring with damping, and held by friction that grows with its speed up
/// to Coulomb's.
template <class P>
struct GroundContact {
  bool present = true;
  P leg_height = P(0);  ///< of the centre of mass above the feet [m]
  P leg_reach = P(0);   ///< of each foot from the centre along x and y [m]
  P stiffness = P(0);   ///< of one foot [N/m]
  P damping = P(0);     ///< of one foot [N s/m]
  P friction = P(0.6);  ///< coefficient [1]
  P slip = P(0.05);     ///< speed at which friction is 0.7 of its greatest [m/s]
};

/// Contact as stiff as the step allows: the vehicle on its feet swings with 60 rad/s, critically
/// damped, so it sinks in by 3 mm at rest, g/60².
/// @param moment  the least of the body's moments of inertia about x and y [kg m²]
/// @param reach   of the feet [m]; cut to the radius of gyration, √(moment/mass), for feet that
///                stand wider rock the vehicle faster than it swings, faster than a step can follow
template <class P>
[[nodiscard]] GroundContact<P> ground_contact(P mass, P moment, P reach, P leg_height = P(0)) {
  using std::sqrt;
  constexpr double kFrequency = 60;
  GroundContact<P> ground;
  ground.leg_height = leg_height;
  ground.leg_reach = lesser(reach, P(sqrt(moment / mass)));
  ground.stiffness = mass * P(kFrequency * kFrequency / 4);
  ground.damping = mass * P(2 * kFrequency / 4);
  return ground;
}

/// @tparam T  the scalar of state and parameters
/// @tparam N  rotors whose speed is a state: 0 (no lag: the speed is what is commanded), 4, or
///            Eigen::Dynamic for any other number up to kMaxRotors
template <class T, int N>
class Plant {
 public:
  static constexpr int kStates = N == Eigen::Dynamic ? Eigen::Dynamic : kRotorSpeeds + N;
  static constexpr int kMostStates = N == Eigen::Dynamic ? kRotorSpeeds + kMaxRotors : kStates;
  /// [position(3) quaternion wxyz(4) body velocity(3) body rates(3) rotor speeds(N)]
  using State = Eigen::Matrix<T, kStates, 1, Eigen::ColMajor, kMostStates, 1>;

  Plant() = default;
  Plant(const BasicRigidBody<T>& body, const GroundContact<T>& ground_)
      : ground(ground_), speeds(RotorSpeeds<T>::Zero(body.rotor_count)), body_(body) {
    set_air(body.air_density, body.density_ratio, body.gravity);
  }

  /// Where it flies: density [kg/m³], that over the one of the rotor curves, gravity [m/s²].
  void set_air(const T& density, const T& ratio, const T& gravity) {
    body_.air_density = density;
    body_.density_ratio = ratio;
    body_.gravity = gravity;
    for (int i = 0; i < body_.rotor_count; ++i) {
      const BasicRotor<T>& rotor = body_.rotors[static_cast<std::size_t>(i)];
      RotorNumbers& numbers = rotors_[static_cast<std::size_t>(i)];
      numbers.thrust_a2 = rotor.thrust_a2 * ratio;
      numbers.thrust_a1 = rotor.thrust_a1 * ratio;
      numbers.torque_d2 = rotor.spin * rotor.torque_d2 * ratio;
      numbers.torque_d1 = rotor.spin * rotor.torque_d1 * ratio;
      numbers.momentum = rotor.spin * rotor.inertia;
      numbers.lag_rate = select(rotor.lag > T(0), T(1) / rotor.lag, T(0));
      numbers.lag_rate_down = select(rotor.lag_down > T(0), T(1) / rotor.lag_down, T(0));
      uneven_lag_ =
          uneven_lag_ || any(rotor.lag < rotor.lag_down) || any(rotor.lag > rotor.lag_down);
    }
  }
  [[nodiscard]] const BasicRigidBody<T>& body() const { return body_; }

  /// Speeds asked of the rotors until the next call [rad/s]; those without lag have them at once.
  void command(const RotorSpeeds<T>& asked, State& x) {
    hold(asked);
    if constexpr (N != 0)
      for (int i = 0; i < body_.rotor_count; ++i) {
        const BasicRotor<T>& rotor = body_.rotors[static_cast<std::size_t>(i)];
        T& w = x(kRotorSpeeds + i);
        const T lag = select(asked(i) < w, rotor.lag_down, rotor.lag);
        w = select(lag > T(0), w, asked(i));
      }
  }

  /// The same for a state whose rotors are known to have followed the command.
  void hold(const RotorSpeeds<T>& asked) {
    speeds = asked;
    if constexpr (N == 0) held_ = rotor_loads(body_, speeds);
  }

  /// From now on the vehicle has this mass [kg]; its inertia stays.
  void set_mass(const T& mass) {
    body_.mass = mass;
    body_.inverse_mass = T(1) / mass;
  }

  /// From now on a rotor gives this share of its thrust and drag torque.
  /// @param i  the first is 0;  @param share  0 … 1
  void weaken(int i, const T& share) {
    BasicRotor<T>& rotor = body_.rotors[static_cast<std::size_t>(i)];
    for (T* number : {&rotor.thrust_a2, &rotor.thrust_a1, &rotor.torque_d2, &rotor.torque_d1,
                      &rotor.drag, &rotor.inflow, &rotor.flapping})
      *number = *number * share;
    set_air(body_.air_density, body_.density_ratio, body_.gravity);
    hold(speeds);
  }

  /// Speeds at which the rotors turn.
  [[nodiscard]] RotorSpeeds<T> rotor_speeds(const State& x) const {
    if constexpr (N == 0) {
      return speeds;
    } else if constexpr (N == Eigen::Dynamic) {
      return x.segment(kRotorSpeeds, body_.rotor_count);
    } else {
      return x.template segment<N>(kRotorSpeeds);
    }
  }

  /// Inlined into step(), so that a step's intermediate states stay in registers.
  [[nodiscard, gnu::always_inline]] State derivative(const State& x) const {
    State result;
    if constexpr (N == Eigen::Dynamic) result.resize(x.size());
    RotorLoads<T> loads = rotors(x);
    if constexpr (N != 0) {
      // w' = (asked - w) / lag; the torque that speeds a rotor up turns the body back.
      each_rotor([&](int i) __attribute__((always_inline)) {
        const RotorNumbers& rotor = rotors_[static_cast<std::size_t>(i)];
        const T missing = speeds(i) - x(kRotorSpeeds + i);
        const T rise =
            missing * (uneven_lag_ ? T(select(missing < T(0), rotor.lag_rate_down, rotor.lag_rate))
                                   : rotor.lag_rate);
        result(kRotorSpeeds + i) = rise;
        loads.torque(2) -= rotor.momentum * rise;
      });
    }
    if (body_.has_airflow || body_.has_ground_effect) add_air_loads(x, loads);
    add_contact(x, loads);
    rigid_motion(body_, x, loads, windy ? &wind : nullptr, result);
    return result;
  }

  /// What an accelerometer at the centre of mass feels: v' + w × v - g, body axes [m/s²].
  [[nodiscard]] Vector3<T> specific_force(const State& x) const {
    RotorLoads<T> loads = rotors(x);
    if (body_.has_airflow || body_.has_ground_effect) add_air_loads(x, loads);
    add_contact(x, loads);
    const Matrix3<T> R_WB = attitude(x).toRotationMatrix();
    const Vector3<T> airspeed = x.template segment<3>(kBodyVelocity) - R_WB.transpose() * wind;
    return (loads.force + drag_force(body_, airspeed)) * body_.inverse_mass;
  }

  /// One step, the quaternion brought back to its norm.
  [[nodiscard]] State step(Integrator method, const State& x, double h) const {
    State next = integrator_step(
        method,
        [this](double, const State& at) __attribute__((always_inline)) { return derivative(at); },
        0, x, h);
    restore_norm(next);
    return next;
  }

  [[nodiscard]] static Eigen::Quaternion<T> attitude(const State& x) {
    return {x(kQuaternion), x(kQuaternion + 1), x(kQuaternion + 2), x(kQuaternion + 3)};
  }

  /// One Newton step for 1/√n at n = 1: what a step leaves of the norm's error is squared.
  static void restore_norm(State& x) {
    const T n = x(3) * x(3) + x(4) * x(4) + (x(5) * x(5) + x(6) * x(6));
    const T factor = T(1.5) - T(0.5) * n;
    for (int i = kQuaternion; i < kBodyVelocity; ++i) x(i) *= factor;
  }

  GroundContact<T> ground;
  Vector3<T> wind = Vector3<T>::Zero();  ///< of the air, world axes [m/s], held
  bool windy = false;                    ///< false: wind is 0
  RotorSpeeds<T> speeds;                 ///< that are asked for [rad/s], held

 private:
  template <class Function>
  [[gnu::always_inline]] void each_rotor(Function&& f) const {
    if constexpr (N == Eigen::Dynamic) {
      for (int i = 0; i < body_.rotor_count; ++i) f(i);
    } else {
      unrolled<N>(f);
    }
  }
  [[nodiscard]] T reach() const { return ground.leg_height + ground.leg_reach + ground.leg_reach; }

  /// Loads of the rotors as they turn, without that of speeding them up.
  [[nodiscard, gnu::always_inline]] RotorLoads<T> rotors(const State& x) const {
    if constexpr (N == 0) {
      (void)x;
      return held_;
    } else {
      T thrust = T(0), roll = T(0), pitch = T(0), yaw = T(0), momentum = T(0);
      each_rotor([&](int i) __attribute__((always_inline)) {
        const RotorNumbers& rotor = rotors_[static_cast<std::size_t>(i)];
        const Vector3<T>& hub = body_.rotors[static_cast<std::size_t>(i)].position;
        const T& w = x(kRotorSpeeds + i);
        const T lift = (rotor.thrust_a2 * w + rotor.thrust_a1) * w;
        thrust += lift;
        roll -= hub.y() * lift;
        pitch += hub.x() * lift;
        yaw -= (rotor.torque_d2 * w + rotor.torque_d1) * w;
        momentum += rotor.momentum * w;
      });
      RotorLoads<T> loads;
      loads.force.z() = -thrust;
      loads.torque.x() = roll;
      loads.torque.y() = pitch;
      loads.torque.z() = yaw;
      loads.angular_momentum.z() = momentum;
      return loads;
    }
  }

  void add_air_loads(const State& x, RotorLoads<T>& loads) const {
    const RotorLoads<T> of_air = air_loads(x);
    loads.force += of_air.force;
    loads.torque += of_air.torque;
  }

  /// What the rotors' motion through the air and the ground below change of their loads.
  [[nodiscard, gnu::noinline]] RotorLoads<T> air_loads(State x) const {
    RotorLoads<T> loads;
    const Matrix3<T> R = rotation_of_quaternion(x(3), x(4), x(5), x(6));
    const RotorSpeeds<T> turning = rotor_speeds(x);
    if (body_.has_airflow) {
      Vector3<T> airspeed = x.template segment<3>(kBodyVelocity);
      if (windy) airspeed -= R.transpose() * wind;
      add_airflow(body_, turning, airspeed, Vector3<T>(x.template segment<3>(kBodyRates)), loads);
    }
    if (body_.has_ground_effect && ground.present)
      for (int i = 0; i < body_.rotor_count; ++i) {
        const BasicRotor<T>& rotor = body_.rotors[static_cast<std::size_t>(i)];
        const Vector3<T>& hub = rotor.position;
        const T height = -(x(2) + (R(2, 0) * hub.x() + R(2, 1) * hub.y() + R(2, 2) * hub.z()));
        const T lift = (ground_effect(rotor.ground_radius, height) - T(1)) *
                       rotor_thrust(rotor, turning(i), body_.density_ratio);
        loads.force.z() -= lift;
        loads.torque.x() -= hub.y() * lift;
        loads.torque.y() += hub.x() * lift;
      }
    return loads;
  }

  void add_contact(const State& x, RotorLoads<T>& loads) const {
    if (!ground.present || !any(x(2) + reach() > T(0))) return;
    const RotorLoads<T> of_ground = contact(x);
    loads.force += of_ground.force;
    loads.torque += of_ground.torque;
  }

  /// Takes a copy: what a function is given the address of does not stay in registers.
  [[nodiscard, gnu::noinline]] RotorLoads<T> contact(State x) const {
    using std::sqrt;
    RotorLoads<T> loads;
    const Matrix3<T> R_WB = attitude(x).toRotationMatrix();
    const Vector3<T> velocity = x.template segment<3>(kBodyVelocity);
    const Vector3<T> rates = x.template segment<3>(kBodyRates);
    for (const double sx : {1.0, -1.0})
      for (const double sy : {1.0, -1.0}) {
        const Vector3<T> foot(ground.leg_reach * T(sx), ground.leg_reach * T(sy),
                              ground.leg_height);
        const T depth = x(2) + R_WB.row(2).dot(foot);
        const Vector3<T> v = R_WB * Vector3<T>(velocity + rates.cross(foot));
        const MaskOf<T> touches = depth > T(0);
        // Pushed up, never pulled down.
        const T push =
            select(touches, greater(ground.stiffness * depth + ground.damping * v.z(), T(0)), T(0));
        const T slip = sqrt(v.x() * v.x() + v.y() * v.y() + ground.slip * ground.slip);
        const T drag = ground.friction * push / slip;
        const Vector3<T> force = R_WB.transpose() * Vector3<T>(-drag * v.x(), -drag * v.y(), -push);
        loads.force += force;
        loads.torque += foot.cross(force);
      }
    return loads;
  }

  /// What the equations take from a rotor, at the density that there is.
  struct RotorNumbers {
    T thrust_a2 = T(0), thrust_a1 = T(0);
    T torque_d2 = T(0), torque_d1 = T(0);  ///< with the sign of the spin
    T momentum = T(0);                     ///< of a speed of 1 rad/s, along z [kg m²]
    T lag_rate = T(0);                     ///< while the speed rises [1/s]; 0: no lag
    T lag_rate_down = T(0);                ///< while it falls
  };

  BasicRigidBody<T> body_;
  std::array<RotorNumbers, kMaxRotors> rotors_{};
  RotorLoads<T> held_;
  bool uneven_lag_ = false;  ///< whether a rotor's lag differs up and down
};

}  // namespace quadtune
