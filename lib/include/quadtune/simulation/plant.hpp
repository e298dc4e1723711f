// SPDX-License-Identifier: Apache-2.0
/// Equations of motion of the simulated vehicle: rigid body, rotors with motor lag, wind and
/// ground, for commands that are constant over a step. Equations: docs/theory.md, "Simulated
/// flight".
#pragma once

#include <Eigen/Core>
#include <array>

#include "quadtune/model/rigid_body.hpp"
#include "quadtune/scalar.hpp"
#include "quadtune/simulation/integrators.hpp"

namespace quadtune {

/// Indices of the simulated state: those of QuaternionState, then the rotor speeds.
inline constexpr int kQuaternion = 3;
inline constexpr int kBodyVelocity = 7;
inline constexpr int kBodyRates = 10;
inline constexpr int kRotorSpeeds = 13;

/// Level ground at z = 0 under four feet at the corners of a square. A spring with damping pushes
/// each foot out of the ground, and friction that increases with the speed up to the Coulomb limit
/// opposes its sliding.
template <class P>
struct GroundContact {
  bool present = true;
  P leg_height = P(0);  ///< height of the centre of mass above the feet [m]
  P leg_reach = P(0);   ///< distance of each foot from the centre along x and y [m]
  P stiffness = P(0);   ///< per foot [N/m]
  P damping = P(0);     ///< per foot [N s/m]
  P friction = P(0.6);  ///< coefficient [1]
  P slip = P(0.05);     ///< speed at which friction is 0.7 of its maximum [m/s]
};

/// Contact that is as stiff as the integration step allows: the vehicle on its feet has a natural
/// frequency of 60 rad/s with critical damping, and sinks in by g/60² = 3 mm at rest.
/// @param moment  the smaller of the moments of inertia about x and y [kg m²]
/// @param reach   of the feet [m]; limited to the radius of gyration √(moment/mass), since the
///                rocking mode of a wider stance would be faster than the vertical one, and too
///                fast for the step
template <class P>
[[nodiscard]] GroundContact<P> ground_contact(P mass, P moment, P reach, P leg_height = P(0)) {
  using std::sqrt;
  constexpr double kFrequency = 60;
  GroundContact<P> ground;
  ground.leg_height = leg_height;
  ground.leg_reach = min_of(reach, P(sqrt(moment / mass)));
  ground.stiffness = mass * P(kFrequency * kFrequency / 4);
  ground.damping = mass * P(2 * kFrequency / 4);
  return ground;
}

/// Equations of motion with their parameters.
/// @tparam T  scalar type of state and parameters
/// @tparam N  number of rotors whose speed is a state: 0 (no lag: the speed is the command), 4, or
///            Eigen::Dynamic for any other number up to kMaxRotors
template <class T, int N>
class Plant {
 public:
  static constexpr int kStates = N == Eigen::Dynamic ? Eigen::Dynamic : kRotorSpeeds + N;
  static constexpr int kMaxStates = N == Eigen::Dynamic ? kRotorSpeeds + kMaxRotors : kStates;
  /// [position(3) quaternion wxyz(4) body velocity(3) body rates(3) rotor speeds(N)]
  using State = Eigen::Matrix<T, kStates, 1, Eigen::ColMajor, kMaxStates, 1>;

  Plant() = default;
  Plant(const BasicRigidBody<T>& body, const GroundContact<T>& ground_)
      : ground(ground_), speeds(RotorSpeeds<T>::Zero(body.rotor_count)), body_(body) {
    set_air(body.air_density, body.density_ratio, body.gravity);
  }

  /// Sets the air density [kg/m³], its ratio to the density of the rotor curves, and gravity
  /// [m/s²].
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
      spinning_mass_ = spinning_mass_ || any(rotor.inertia > T(0));
    }
  }
  [[nodiscard]] const BasicRigidBody<T>& body() const { return body_; }

  /// Sets the rotor speed commands until the next call [rad/s]; rotors without lag assume them at
  /// once.
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

  /// Sets the commands for a state whose rotor speeds have already been set to them.
  void hold(const RotorSpeeds<T>& asked) {
    speeds = asked;
    if constexpr (N == 0) held_ = rotor_loads(body_, speeds);
  }

  /// Sets the mass from now on [kg]; the inertia does not change.
  void set_mass(const T& mass) {
    body_.mass = mass;
    body_.inverse_mass = T(1) / mass;
  }

  /// Multiplies thrust and drag torque of a rotor by `share` from now on.
  /// @param i  index from 0;  @param share  0 … 1
  void weaken(int i, const T& share) {
    BasicRotor<T>& rotor = body_.rotors[static_cast<std::size_t>(i)];
    for (T* number : {&rotor.thrust_a2, &rotor.thrust_a1, &rotor.torque_d2, &rotor.torque_d1,
                      &rotor.drag, &rotor.inflow, &rotor.flapping})
      *number = *number * share;
    set_air(body_.air_density, body_.density_ratio, body_.gravity);
    hold(speeds);
  }

  /// Actual speeds of the rotors.
  [[nodiscard]] RotorSpeeds<T> rotor_speeds(const State& x) const {
    if constexpr (N == 0) {
      return speeds;
    } else if constexpr (N == Eigen::Dynamic) {
      return x.segment(kRotorSpeeds, body_.rotor_count);
    } else {
      return x.template segment<N>(kRotorSpeeds);
    }
  }

  /// x' with all terms.
  [[nodiscard, gnu::noinline]] State derivative(const State& x) const {
    return derivative_of<Terms::all>(x);
  }

  /// Specific force at the centre of mass: v' + w × v - g, body axes [m/s²].
  [[nodiscard]] Vector3<T> specific_force(const State& x) const {
    RotorLoads<T> loads = rotors(x);
    if (body_.has_airflow || body_.has_ground_effect) add(air_loads(x), loads);
    if (may_touch(x(2))) add(contact(x), loads);
    const Matrix3<T> R_WB = attitude(x).toRotationMatrix();
    const Vector3<T> airspeed = x.template segment<3>(kBodyVelocity) - R_WB.transpose() * wind;
    return (loads.force + drag_force(body_, airspeed)) * body_.inverse_mass;
  }

  /// Integrates one step and normalizes the quaternion.
  [[nodiscard]] State step(Integrator method, const State& x, double h) const {
    // Most steps are far from the ground.
    if (method == Integrator::runge_kutta_4 && !may_touch(x(2))) {
      T lowest = x(2);
      State next = moves_in_air() ? free_step<Terms::air>(x, h, lowest)
                                  : free_step<Terms::rotors>(x, h, lowest);
      if (!may_touch(lowest)) {
        restore_norm(next);
        return next;
      }
    }
    State next = integrator_step(
        method, [this](double, const State& at) { return derivative(at); }, 0, x, h);
    restore_norm(next);
    return next;
  }

  [[nodiscard]] static Eigen::Quaternion<T> attitude(const State& x) {
    return {x(kQuaternion), x(kQuaternion + 1), x(kQuaternion + 2), x(kQuaternion + 3)};
  }

  /// One Newton step for 1/√n at n = 1; it squares the relative error of the norm that a step
  /// leaves.
  static void restore_norm(State& x) {
    const T n = x(3) * x(3) + x(4) * x(4) + (x(5) * x(5) + x(6) * x(6));
    const T factor = T(1.5) - T(0.5) * n;
    for (int i = kQuaternion; i < kBodyVelocity; ++i) x(i) *= factor;
  }

  GroundContact<T> ground;
  Vector3<T> wind = Vector3<T>::Zero();  ///< of the air, world axes [m/s], constant over a step
  bool windy = false;                    ///< false: wind is 0
  RotorSpeeds<T> speeds;                 ///< commanded [rad/s], constant over a step

 private:
  template <class Function>
  [[gnu::always_inline]] void each_rotor(Function&& f) const {
    if constexpr (N <= 0) {  // 0 or Eigen::Dynamic
      for (int i = 0; i < body_.rotor_count; ++i) f(i);
    } else {
      unrolled<N>(f);
    }
  }
  /// The terms of a derivative. Every set contains the terms of those before it, and gives the same
  /// bytes as them where its other terms are absent.
  enum class Terms {
    rotors,  ///< rigid body and rotors, with equal lags of rising and falling speed, no wind
    air,     ///< also different lags, wind, and the loads of the air on the moving rotors
    all,     ///< also contact with the ground
  };
  [[nodiscard]] bool moves_in_air() const {
    return body_.has_airflow || body_.has_ground_effect || windy || uneven_lag_;
  }
  /// Whether a vehicle whose centre of mass is at this height [m, down] may be in contact.
  [[nodiscard]] bool may_touch(const T& z) const {
    return ground.present &&
           any(z + (ground.leg_height + ground.leg_reach + ground.leg_reach) > T(0));
  }

  /// A Runge-Kutta step without contact. Without the branch for contact in each stage, the compiler
  /// keeps more of the intermediate states in registers.
  /// @param lowest  receives the greatest z of the states of which it takes the derivative
  template <Terms kTerms>
  [[nodiscard, gnu::always_inline]] State free_step(const State& x, double h, T& lowest) const {
    return runge_kutta_4_step(
        [ this, &lowest ](double, const State& at) __attribute__((always_inline)) {
          lowest = max_of(lowest, at(2));
          return derivative_of<kTerms>(at);
        },
        0, x, h);
  }

  /// x' with a set of terms that contains all that are present.
  template <Terms kTerms>
  [[nodiscard, gnu::always_inline]] State derivative_of(const State& x) const {
    constexpr bool kAir = kTerms != Terms::rotors;
    State result;
    if constexpr (N == Eigen::Dynamic) result.resize(x.size());
    RotorLoads<T> loads = rotors(x);
    if constexpr (N != 0) {
      // w' = (asked - w) / lag
      each_rotor([&](int i) __attribute__((always_inline)) {
        const RotorNumbers& rotor = rotors_[static_cast<std::size_t>(i)];
        const T missing = speeds(i) - x(kRotorSpeeds + i);
        const T rise =
            missing * (kAir && uneven_lag_
                           ? T(select(missing < T(0), rotor.lag_rate_down, rotor.lag_rate))
                           : rotor.lag_rate);
        result(kRotorSpeeds + i) = rise;
      });
      // The torque that accelerates a rotor acts on the body with the opposite sign.
      if (spinning_mass_)
        each_rotor([&](int i) __attribute__((always_inline)) {
          const T& momentum = rotors_[static_cast<std::size_t>(i)].momentum;
          loads.angular_momentum(2) += momentum * x(kRotorSpeeds + i);
          loads.torque(2) -= momentum * result(kRotorSpeeds + i);
        });
    }
    if constexpr (kAir)
      if (body_.has_airflow || body_.has_ground_effect) add(air_loads(x), loads);
    if constexpr (kTerms == Terms::all)
      if (may_touch(x(2))) add(contact(x), loads);
    const Vector3<T>* const blowing = kAir && windy ? &wind : nullptr;
    rigid_motion(body_, x, loads, blowing, result);
    return result;
  }

  /// Loads of the rotors at their present speeds, without the torques that accelerate them.
  [[nodiscard, gnu::always_inline]] RotorLoads<T> rotors(const State& x) const {
    if constexpr (N == 0) {
      (void)x;
      return held_;
    } else {
      T thrust = T(0), roll = T(0), pitch = T(0), yaw = T(0);
      each_rotor([&](int i) __attribute__((always_inline)) {
        const RotorNumbers& rotor = rotors_[static_cast<std::size_t>(i)];
        const Vector3<T>& hub = body_.rotors[static_cast<std::size_t>(i)].position;
        const T& w = x(kRotorSpeeds + i);
        const T lift = (rotor.thrust_a2 * w + rotor.thrust_a1) * w;
        thrust += lift;
        roll -= hub.y() * lift;
        pitch += hub.x() * lift;
        yaw -= (rotor.torque_d2 * w + rotor.torque_d1) * w;
      });
      RotorLoads<T> loads;
      loads.force.z() = -thrust;
      loads.torque.x() = roll;
      loads.torque.y() = pitch;
      loads.torque.z() = yaw;
      return loads;
    }
  }

  [[gnu::always_inline]] static void add(const RotorLoads<T>& more, RotorLoads<T>& loads) {
    loads.force += more.force;
    loads.torque += more.torque;
  }

  /// Changes of the rotor loads due to the motion through the air and due to ground effect.
  [[nodiscard, gnu::always_inline]] RotorLoads<T> air_loads(const State& x) const {
    RotorLoads<T> loads;
    const Matrix3<T> R = rotation_of_quaternion(x(3), x(4), x(5), x(6));
    const auto speed = [&](int i) __attribute__((always_inline))->const T& {
      if constexpr (N == 0) {
        return speeds(i);
      } else {
        return x(kRotorSpeeds + i);
      }
    };
    if (body_.has_airflow) {
      Vector3<T> airspeed = x.template segment<3>(kBodyVelocity);
      if (windy) airspeed -= R.transpose() * wind;
      const Vector3<T> rates = x.template segment<3>(kBodyRates);
      each_rotor([&](int i) __attribute__((always_inline)) {
        add_rotor_airflow(body_.rotors[static_cast<std::size_t>(i)],
                          T(speed(i) * body_.density_ratio), airspeed, rates, loads);
      });
    }
    if (body_.has_ground_effect && ground.present)
      each_rotor([&](int i) __attribute__((always_inline)) {
        const BasicRotor<T>& rotor = body_.rotors[static_cast<std::size_t>(i)];
        const Vector3<T>& hub = rotor.position;
        const T height = -(x(2) + (R(2, 0) * hub.x() + R(2, 1) * hub.y() + R(2, 2) * hub.z()));
        const T lift = (ground_effect(rotor.ground_radius, height) - T(1)) *
                       rotor_thrust(rotor, speed(i), body_.density_ratio);
        loads.force.z() -= lift;
        loads.torque.x() -= hub.y() * lift;
        loads.torque.y() += hub.x() * lift;
      });
    return loads;
  }

  /// Takes its argument by value: an object whose address is passed does not stay in registers.
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
        // The ground pushes but never pulls.
        const T push =
            select(touches, max_of(ground.stiffness * depth + ground.damping * v.z(), T(0)), T(0));
        const T slip = sqrt(v.x() * v.x() + v.y() * v.y() + ground.slip * ground.slip);
        const T drag = ground.friction * push / slip;
        const Vector3<T> force = R_WB.transpose() * Vector3<T>(-drag * v.x(), -drag * v.y(), -push);
        loads.force += force;
        loads.torque += foot.cross(force);
      }
    return loads;
  }

  /// Coefficients of a rotor in the equations, at the present air density.
  struct RotorNumbers {
    T thrust_a2 = T(0), thrust_a1 = T(0);
    T torque_d2 = T(0), torque_d1 = T(0);  ///< with the sign of the spin
    /// Angular momentum at a speed of 1 rad/s, along z [kg m²]
    T momentum = T(0);
    T lag_rate = T(0);       ///< while the speed rises [1/s]; 0: no lag
    T lag_rate_down = T(0);  ///< while the speed falls [1/s]
  };

  BasicRigidBody<T> body_;
  std::array<RotorNumbers, kMaxRotors> rotors_{};
  RotorLoads<T> held_;
  /// Whether the lag of a rotor differs between rising and falling speed
  bool uneven_lag_ = false;
  /// Whether a rotor has a moment of inertia
  bool spinning_mass_ = false;
};

}  // namespace quadtune
