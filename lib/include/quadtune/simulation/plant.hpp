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
  Plant(const BasicRigidBody<T>& body_, const GroundContact<T>& ground_)
      : body(body_), ground(ground_), speeds(RotorSpeeds<T>::Zero(body.rotor_count)) {
    for (int i = 0; i < body.rotor_count; ++i) {
      const T lag = body.rotors[static_cast<std::size_t>(i)].lag;
      lag_rate_[static_cast<std::size_t>(i)] = select(lag > T(0), T(1) / lag, T(0));
    }
  }

  /// Speeds asked of the rotors until the next call [rad/s]; those without lag have them at once.
  void command(const RotorSpeeds<T>& asked, State& x) {
    speeds = asked;
    if constexpr (N == 0) {
      held_ = rotor_loads(body, speeds);
    } else {
      for (int i = 0; i < body.rotor_count; ++i) {
        const T lag = body.rotors[static_cast<std::size_t>(i)].lag;
        x(kRotorSpeeds + i) = select(lag > T(0), x(kRotorSpeeds + i), asked(i));
      }
    }
  }

  /// Speeds at which the rotors turn.
  [[nodiscard]] RotorSpeeds<T> rotor_speeds(const State& x) const {
    if constexpr (N == 0) {
      return speeds;
    } else {
      return x.segment(kRotorSpeeds, body.rotor_count);
    }
  }

  [[nodiscard]] State derivative(const State& x) const {
    State result;
    if constexpr (N == Eigen::Dynamic) result.resize(x.size());
    RotorLoads<T> loads = rotors(x);
    if constexpr (N != 0) {
      // w' = (asked - w) / lag; the torque that speeds a rotor up turns the body back.
      for (int i = 0; i < count(); ++i) {
        const BasicRotor<T>& rotor = body.rotors[static_cast<std::size_t>(i)];
        const T rise = (speeds(i) - x(kRotorSpeeds + i)) * lag_rate_[static_cast<std::size_t>(i)];
        result(kRotorSpeeds + i) = rise;
        loads.torque.z() -= rotor.spin * rotor.inertia * rise;
      }
    }
    if (ground.present && any(x(2) + reach() > T(0))) add_contact(x, loads);
    rigid_motion(body, x, loads, windy ? &wind : nullptr, result);
    return result;
  }

  /// What an accelerometer at the centre of mass feels: v' + w × v - g, body axes [m/s²].
  [[nodiscard]] Vector3<T> specific_force(const State& x) const {
    RotorLoads<T> loads = rotors(x);
    if (ground.present && any(x(2) + reach() > T(0))) add_contact(x, loads);
    const Matrix3<T> R_WB = attitude(x).toRotationMatrix();
    const Vector3<T> airspeed = x.template segment<3>(kBodyVelocity) - R_WB.transpose() * wind;
    return (loads.force + drag_force(body, airspeed)) * body.inverse_mass;
  }

  /// One step, the quaternion brought back to its norm.
  [[nodiscard]] State step(Integrator method, const State& x, double h) const {
    State next = integrator_step(
        method, [this](double, const State& at) { return derivative(at); }, 0, x, h);
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

  BasicRigidBody<T> body;
  GroundContact<T> ground;
  Vector3<T> wind = Vector3<T>::Zero();  ///< of the air, world axes [m/s], held
  bool windy = false;                    ///< false: wind is 0
  RotorSpeeds<T> speeds;                 ///< that are asked for [rad/s], held

 private:
  [[nodiscard]] int count() const { return N == Eigen::Dynamic ? body.rotor_count : N; }
  [[nodiscard]] T reach() const { return ground.leg_height + ground.leg_reach + ground.leg_reach; }

  [[nodiscard]] RotorLoads<T> rotors(const State& x) const {
    if constexpr (N == 0) {
      (void)x;
      return held_;
    } else if constexpr (N == Eigen::Dynamic) {
      return rotor_loads(body, x.segment(kRotorSpeeds, body.rotor_count));
    } else {
      return rotor_loads(body, x.template segment<N>(kRotorSpeeds));
    }
  }

  void add_contact(const State& x, RotorLoads<T>& loads) const {
    using std::sqrt;
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
  }

  std::array<T, kMaxRotors> lag_rate_{};  ///< [1/s]; 0: no lag
  RotorLoads<T> held_;
};

}  // namespace quadtune
