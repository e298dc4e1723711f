// SPDX-License-Identifier: Apache-2.0
/// Residuals of the calibration of a gyroscope, as cost functions of Ceres.
#pragma once

#include <ceres/ceres.h>

#include <Eigen/Core>
#include <array>

#include "imu/norm_calibration.hpp"
#include "imu/turn_integration.hpp"

namespace quadtune {

/// (U (raw) - u) / σ of a pose: the accelerometer measures the vertical.
struct PoseResidual {
  Eigen::Vector3d scaled;
  double warmth;
  double weight;
  template <class Scalar>
  bool operator()(const Scalar* acc, const Scalar* u, Scalar* residual) const {
    const Eigen::Matrix<Scalar, 3, 1> direction = norm_direction(acc, scaled, warmth);
    for (int i = 0; i < 3; ++i) residual[i] = weight * (direction(i) - u[i]);
    return true;
  }
};

/// The mean of a stationary gyroscope is its bias.
struct RestResidual {
  Eigen::Vector3d scaled;
  double warmth;
  double weight;
  template <class Scalar>
  bool operator()(const Scalar* bias, const Scalar* drift, Scalar* residual) const {
    for (int i = 0; i < 3; ++i) residual[i] = weight * (scaled(i) - bias[i] + drift[i] * warmth);
    return true;
  }
};

/// (u rotated by the gyroscope - next u) / σ. The rotation is integrated once for its 15
/// parameters, not for all 21.
class TurnResidual final : public ceres::SizedCostFunction<3, 9, 3, 3, 3, 3> {
 public:
  TurnResidual(const TurnSamples* samples, double weight) : samples_(samples), weight_(weight) {}

  bool Evaluate(double const* const* p, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::Vector3d> u(p[3]), next(p[4]);
    Eigen::Map<Eigen::Vector3d> residual(residuals);
    if (!jacobians) {
      residual = weight_ * (turned<double>(*samples_, p[0], p[1], p[2], u) - next);
      return residual.allFinite();
    }
    constexpr int kNumbers = 15;
    using Jet = ceres::Jet<double, kNumbers>;
    std::array<Jet, kNumbers> q;
    for (int k = 0; k < kNumbers; ++k) {
      const double value = k < 9 ? p[0][k] : k < 12 ? p[1][k - 9] : p[2][k - 12];
      q[static_cast<std::size_t>(k)] = Jet(value, k);
    }
    const Eigen::Matrix<Jet, 3, 3> R = rotation<Jet>(*samples_, &q[0], &q[9], &q[12]);
    Eigen::Matrix3d R0;
    for (int i = 0; i < 3; ++i) {
      Eigen::Matrix<double, kNumbers, 1> slope = Eigen::Matrix<double, kNumbers, 1>::Zero();
      for (int j = 0; j < 3; ++j) {
        R0(i, j) = R(i, j).a;
        slope += u(j) * R(i, j).v;
      }
      for (int k = 0; k < kNumbers; ++k) {
        const int block = k < 9 ? 0 : k < 12 ? 1 : 2;
        const int width = block == 0 ? 9 : 3, first = block == 0 ? 0 : block == 1 ? 9 : 12;
        if (jacobians[block]) jacobians[block][i * width + k - first] = weight_ * slope(k);
      }
    }
    residual = weight_ * (R0 * u - next);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        if (jacobians[3]) jacobians[3][3 * i + j] = weight_ * R0(i, j);
        if (jacobians[4]) jacobians[4][3 * i + j] = i == j ? -weight_ : 0;
      }
    return residual.allFinite();
  }

 private:
  const TurnSamples* samples_;
  double weight_;
};

}  // namespace quadtune
