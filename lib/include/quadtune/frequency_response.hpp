// SPDX-License-Identifier: Apache-2.0
/// Frequency responses of linear models.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <memory>

#include "quadtune/lti.hpp"

namespace quadtune {

/// Evaluates C (λI - A)⁻¹ B + D at many points λ. A is balanced and reduced to Hessenberg form
/// once, O(n³); each point then costs O(n²) per input. Reference: Laub 1981.
class FrequencyResponse {
 public:
  /// @throws InvalidInput  as validate()
  explicit FrequencyResponse(const ContinuousLti& plant);
  explicit FrequencyResponse(const DiscreteLti& plant);  ///< the same for a sampled plant
  ~FrequencyResponse();
  FrequencyResponse(FrequencyResponse&&) noexcept;
  FrequencyResponse& operator=(FrequencyResponse&&) noexcept;

  /// G(jω) of a continuous plant, G(e^(jω dt)) of a sampled one.
  /// @param w  [rad/s]
  /// @return   (ny × nu); not finite at a pole
  [[nodiscard]] Eigen::MatrixXcd at(double w) const;

  /// C (λI - A)⁻¹ B + D at any point of the complex plane.
  [[nodiscard]] Eigen::MatrixXcd at_point(std::complex<double> lambda) const;

 private:
  struct Reduced;
  std::unique_ptr<Reduced> reduced_;
};

}  // namespace quadtune
