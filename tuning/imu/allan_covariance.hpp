// SPDX-License-Identifier: Apache-2.0
/// Means and covariances of overlapping Allan variances of Gaussian noise.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "quadtune/tuning/allan.hpp"

namespace quadtune {

using NoiseVariances = std::array<double, kAllanNoises>;  ///< Q², N², B², K²

/// Expected σ²(tau) of each noise for a coefficient of 1: 3/tau², 1/tau, 2 ln 2/π, tau/3.
[[nodiscard]] NoiseVariances allan_variance_of_noises(double tau);

/// The covariance of two overlapping Allan variances as a quadratic form in the variances of the
/// noises.
class AllanCovariance {
 public:
  /// @param samples  of the rate;  @param m1, m2  samples in a mean;  @param dt  [s]
  AllanCovariance(std::size_t samples, std::size_t m1, std::size_t m2, double dt);

  [[nodiscard]] double at(const NoiseVariances& noises) const;

 private:
  NoiseVariances products_[kAllanNoises]{};  ///< of the pairs of noises
};

}  // namespace quadtune
