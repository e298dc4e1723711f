// SPDX-License-Identifier: Apache-2.0
/// Responses of linear models to sines.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <memory>

#include "quadtune/lti.hpp"

namespace quadtune {

/// C (λI - A)⁻¹ B + D at many points λ: A is balanced and reduced to Hessenberg form once, O(n³);
/// a point costs O(n²) for each input. Reference: Laub 1981.
class FrequencyResponse {
 public:
  /// @throws InvalidInput  as validate()
  explicit FrequencyResponse(const ContinuousLti& plant);
  explicit FrequencyResponse(const DiscreteLti& plant);
  ~FrequencyResponse();
  FrequencyResponse(FrequencyResponse&&) noexcept;
  FrequencyResponse& operator=(FrequencyResponse&&) noexcept;

  /// G(jω), or G(e^(jω dt)).
  /// @param w  [rad/s]
  /// @return   (ny × nu); not finite at a pole
  [[nodiscard]] Eigen::MatrixXcd at(double w) const;

  /// C (λI - A)⁻¹ B + D anywhere in the plane.
  [[nodiscard]] Eigen::MatrixXcd at_point(std::complex<double> lambda) const;

 private:
  struct Reduced;
  std::unique_ptr<Reduced> reduced_;
};

}  // namespace quadtune
