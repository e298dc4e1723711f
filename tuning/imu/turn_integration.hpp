// SPDX-License-Identifier: Apache-2.0
/// Integrates the samples of a gyroscope to a rotation.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace quadtune {

/// Samples of one turn, minus an initial estimate of the bias.
struct TurnSamples {
  Eigen::VectorXd t;       ///< (n) [s]
  Eigen::Matrix3Xd raw;    ///< (3 × n) minus the bias
  Eigen::VectorXd warmth;  ///< (n) (temperature - t0) / span
  double unit = 1;         ///< unit of bias and drift [raw]
  double scale = 1;        ///< [rad/s per raw]
};

/// Rates at sample k: scale G (raw - unit (bias - drift warmth)).
template <class Scalar>
Eigen::Matrix<Scalar, 3, 1> rate_at(const TurnSamples& turn, const Scalar* G, const Scalar* bias,
                                    const Scalar* drift, Eigen::Index k) {
  Eigen::Matrix<Scalar, 3, 1> raw, rate;
  for (int i = 0; i < 3; ++i)
    raw(i) = turn.scale * (turn.raw(i, k) - turn.unit * (bias[i] - drift[i] * turn.warmth(k)));
  for (Eigen::Index i = 0; i < 3; ++i)
    rate(i) = G[3 * i] * raw(0) + G[3 * i + 1] * raw(1) + G[3 * i + 2] * raw(2);
  return rate;
}

/// Computes the rotation that maps the components of a fixed vector before the turn to those after
/// it. The attitude equation q' = q ⊗ (0, w)/2 is integrated by the classical Runge-Kutta method
/// with rates that are linear between samples [Tedaldi, Pretto, Menegatti 2014].
template <class Scalar>
Eigen::Matrix<Scalar, 3, 3> rotation(const TurnSamples& turn, const Scalar* G, const Scalar* bias,
                                     const Scalar* drift) {
  using Quaternion = Eigen::Matrix<Scalar, 4, 1>;  // w x y z
  using Rate = Eigen::Matrix<Scalar, 3, 1>;
  const auto slope = [](const Quaternion& q, const Rate& w) {
    return Quaternion(0.5 * (-q(1) * w(0) - q(2) * w(1) - q(3) * w(2)),
                      0.5 * (q(0) * w(0) + q(2) * w(2) - q(3) * w(1)),
                      0.5 * (q(0) * w(1) + q(3) * w(0) - q(1) * w(2)),
                      0.5 * (q(0) * w(2) + q(1) * w(1) - q(2) * w(0)));
  };
  Quaternion q(Scalar(1), Scalar(0), Scalar(0), Scalar(0));
  Rate w0 = rate_at(turn, G, bias, drift, 0);
  for (Eigen::Index k = 1; k < turn.t.size(); ++k) {
    const double h = turn.t(k) - turn.t(k - 1);
    const Rate w1 = rate_at(turn, G, bias, drift, k);
    const Rate middle = (w0 + w1) * Scalar(0.5);
    const Quaternion k1 = slope(q, w0);
    const Quaternion k2 = slope(q + k1 * Scalar(h / 2), middle);
    const Quaternion k3 = slope(q + k2 * Scalar(h / 2), middle);
    const Quaternion k4 = slope(q + k3 * Scalar(h), w1);
    q += (k1 + Scalar(2) * k2 + Scalar(2) * k3 + k4) * Scalar(h / 6);
    w0 = w1;
  }
  using std::sqrt;
  q /= sqrt(q.squaredNorm());
  const Scalar w = q(0), x = q(1), y = q(2), z = q(3);
  // transpose of the rotation from the body axes after to those before
  Eigen::Matrix<Scalar, 3, 3> R;
  R << 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y),
      2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x),
      2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y);
  return R;
}

template <class Scalar>
Eigen::Matrix<Scalar, 3, 1> turned(const TurnSamples& turn, const Scalar* G, const Scalar* bias,
                                   const Scalar* drift, const Eigen::Matrix<Scalar, 3, 1>& u) {
  return rotation(turn, G, bias, drift) * u;
}

}  // namespace quadtune
