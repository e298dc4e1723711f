// SPDX-License-Identifier: Apache-2.0
/// Calibration of a sensor that measures a vector of known norm.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "quadtune/tuning/imu_calibration.hpp"

namespace quadtune {

/// Input of norm_calibration(), which fits |M (raw - b + d e (t - t0))| = norm.
struct NormProblem {
  Eigen::Matrix3Xd raw;           ///< (3 × poses)
  Eigen::VectorXd temperature;    ///< (poses) [°C]; used where with_temperature
  double norm = 1;                ///< [unit]
  bool with_temperature = false;  ///< for z only, as in the flight program
  double max_error = 0.05;
};

/// The same with parameters of order 1: U = [θ0 θ1 θ2; 0 θ3 θ4; 0 0 θ5], β = θ6..8, κ = θ9; the
/// direction is U ((raw - centre)/size - β + κ e_z (t - t0)/span).
struct NormScaling {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< [raw]
  double size = 1;                                   ///< [raw]
  double t0 = 0;                                     ///< [°C]
  double span = 1;                                   ///< [°C]

  [[nodiscard]] Eigen::Vector3d scaled(const Eigen::Vector3d& raw) const {
    return (raw - centre) / size;
  }
};
inline constexpr int kNormParameters = 10;

template <class Scalar>
Eigen::Matrix<Scalar, 3, 1> norm_direction(const Scalar* p, const Eigen::Vector3d& scaled,
                                           double warmth) {
  const Scalar x = scaled(0) - p[6], y = scaled(1) - p[7], z = scaled(2) - p[8] + p[9] * warmth;
  return {p[0] * x + p[1] * y + p[2] * z, p[3] * y + p[4] * z, p[5] * z};
}

/// A solution with the intermediate results that later stages need.
struct NormSolution {
  SensorCalibration calibration;
  NormScaling scaling;
  Eigen::VectorXd parameters;  ///< kNormParameters
  double noise = 0;            ///< standard deviation of a pose's norm, relative
  std::vector<char> used;      ///< for each pose
};

[[nodiscard]] NormSolution norm_calibration(const NormProblem& problem);

/// Factors M = T K⁻¹, T with a unit diagonal.
void split(SensorCalibration& calibration);

}  // namespace quadtune
