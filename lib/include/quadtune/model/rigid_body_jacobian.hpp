// SPDX-License-Identifier: Apache-2.0
/// The Jacobian of the equations of motion in closed form, for filters that need it in every
/// period. Elsewhere it is computed with jets. Derivation: docs/theory.md, "Estimators on board".
#pragma once

#include "quadtune/model/rigid_body.hpp"

namespace quadtune {

/// The nonzero 3 × 3 blocks of ∂x'/∂x, named by rows and columns. Only the position's rate depends
/// on the yaw; in the other blocks the third column for the attitude is 0.
template <class T>
struct StateJacobian {
  Matrix3<T> position_attitude;  ///< by attitude
  Matrix3<T> position_velocity;  ///< R_WB
  Matrix3<T> attitude_attitude;  ///< by attitude
  Matrix3<T> attitude_rates;     ///< by body rates
  Matrix3<T> velocity_attitude;  ///< by attitude
  Matrix3<T> velocity_velocity;  ///< by body velocity
  Matrix3<T> velocity_rates;     ///< by body rates
  Matrix3<T> rates_rates;        ///< by body rates
};

/// [a]×, with [a]× b = a × b.
template <class T>
[[nodiscard]] Matrix3<T> cross_matrix(const Vector3<T>& a) {
  Matrix3<T> M;
  M << T(0), -a.z(), a.y(),  //
      a.z(), T(0), -a.x(),   //
      -a.y(), a.x(), T(0);
  return M;
}

/// ∂/∂x of state_derivative(body, x, loads) with 12 states and constant loads. Like that
/// function, not valid for |pitch| near 90°.
template <class T>
[[nodiscard]] StateJacobian<T> state_jacobian(const RigidBody& body, const StateVector<T>& x,
                                              const RotorLoads<T>& loads) {
  using std::abs, std::cos, std::sin;
  const T sr = sin(x(3)), cr = cos(x(3)), sp = sin(x(4)), cp = cos(x(4));
  const T sy = sin(x(5)), cy = cos(x(5));
  const Vector3<T> v = x.template segment<3>(kVelocity);
  const Vector3<T> w = x.template segment<3>(kRates);
  StateJacobian<T> A;

  // p' = R v
  Matrix3<T>& R = A.position_velocity;
  R << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,   //
      -sp, cp * sr, cp * cr;
  const Vector3<T> p = R * v;
  // ∂R/∂roll exchanges the second and third column of R; ∂R/∂yaw rotates p' by 90° about z.
  A.position_attitude.col(0) = R.col(2) * v.y() - R.col(1) * v.z();
  /// Horizontal component of p' along the heading.
  const T along = cp * v.x() + sp * (sr * v.y() + cr * v.z());
  const T& p_ahead = p.z();  // ∂along/∂pitch
  A.position_attitude.col(1) << cy * p_ahead, sy * p_ahead, -along;
  A.position_attitude.col(2) << -p.y(), p.x(), T(0);

  // angles' = E w
  const T across = w.y() * sr + w.z() * cr;
  const T pitch_rate = w.y() * cr - w.z() * sr;
  const T secant = T(1) / cp, tangent = sp * secant;
  A.attitude_attitude << pitch_rate * tangent, across * secant * secant, T(0),  //
      -across, T(0), T(0),                                                      //
      pitch_rate * secant, across * tangent * secant, T(0);
  A.attitude_rates << T(1), sr * tangent, cr * tangent,  //
      T(0), cr, -sr,                                     //
      T(0), sr * secant, cr * secant;

  // v' = F/m + D(v)/m + g down - w × v
  const T g = T(body.gravity);
  A.velocity_attitude << T(0), -g * cp, T(0),  //
      g * cp * cr, -g * sp * sr, T(0),         //
      -g * cp * sr, -g * sp * cr, T(0);
  A.velocity_velocity = -cross_matrix(w);
  for (int i = 0; i < 3; ++i)
    A.velocity_velocity(i, i) -=
        (T(body.air_density * body.cda(i)) * abs(v(i)) + T(body.linear_drag(i))) * T(1 / body.mass);
  A.velocity_rates = cross_matrix(v);

  // J w' = τ - w × (J w + h)
  const Matrix3<T> J = body.J.cast<T>();
  const Vector3<T> momentum = J * w + loads.angular_momentum;
  A.rates_rates =
      body.J_inv.cast<T>() * Matrix3<T>(cross_matrix(momentum) - Matrix3<T>(cross_matrix(w) * J));
  return A;
}

}  // namespace quadtune
