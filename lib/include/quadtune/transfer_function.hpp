// SPDX-License-Identifier: Apache-2.0
/// Single-input single-output transfer functions. As with state-space models, continuous and
/// discrete ones are different types.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>

#include "quadtune/lti.hpp"

namespace quadtune {

/// G(s) = num(s)/den(s) e^(-delay s). Coefficients in descending powers of s.
struct ContinuousTransferFunction {
  Eigen::VectorXd num;  ///< at least one coefficient; not longer than den
  Eigen::VectorXd den;  ///< at least one coefficient; the first is not 0
  double delay = 0;     ///< [s], ≥ 0

  /// G(s), s [rad/s].
  [[nodiscard]] std::complex<double> operator()(std::complex<double> s) const;
};

/// G(z) = num(z)/den(z) z^(-delay), one step every dt seconds. Coefficients in descending powers of
/// z.
struct DiscreteTransferFunction {
  Eigen::VectorXd num;  ///< at least one coefficient; not longer than den
  Eigen::VectorXd den;  ///< at least one coefficient; the first is not 0
  double dt = 0;        ///< sample period [s], > 0
  int delay = 0;        ///< whole samples, ≥ 0

  /// G(z).
  [[nodiscard]] std::complex<double> operator()(std::complex<double> z) const;
};

/// Checks that the coefficients exist and are finite, that the leading coefficient of the
/// denominator is not 0, that the transfer function is proper, and that the delay is finite and
/// not negative. Leading zeros of the numerator are allowed.
/// @throws InvalidInput  "where: num has degree 3, den 2, expected no more zeros than poles because
///                       …"
void validate(const ContinuousTransferFunction& plant, const std::string& where);

/// The same for a discrete transfer function; dt must be positive and finite.
void validate(const DiscreteTransferFunction& plant, const std::string& where);

/// The value of a polynomial with coefficients in descending powers, by Horner's rule.
[[nodiscard]] std::complex<double> polynomial(const Eigen::VectorXd& coefficients,
                                              std::complex<double> x);

/// The product p · q, coefficients in descending powers; neither may be empty.
[[nodiscard]] Eigen::VectorXd polynomial_product(const Eigen::VectorXd& p,
                                                 const Eigen::VectorXd& q);

/// The same polynomial without leading zero coefficients; the zero polynomial keeps one
/// coefficient.
[[nodiscard]] Eigen::VectorXd without_leading_zeros(const Eigen::VectorXd& coefficients);

/// The roots of a polynomial with coefficients in descending powers, as eigenvalues of the balanced
/// companion matrix. Leading zeros are ignored. Empty for a constant.
/// @throws InvalidInput  if all coefficients are 0 or one is not finite.
[[nodiscard]] Eigen::VectorXcd polynomial_roots(const Eigen::VectorXd& coefficients);

/// gain · Π (x - root) with real coefficients in descending powers. Complex roots must occur in
/// conjugate pairs (up to rounding); imaginary parts due to rounding are dropped.
[[nodiscard]] Eigen::VectorXd polynomial_of_roots(const Eigen::VectorXcd& roots, double gain = 1);

/// Realization in controllable canonical form with states scaled by powers of two, without the
/// delay. nx is the degree of den.
/// @throws InvalidInput  if den is a constant, because a pure gain has no states.
[[nodiscard]] ContinuousLti realize(const ContinuousTransferFunction& plant);
/// The same for a discrete transfer function, but the states are not scaled, and the delay adds
/// `delay` states at the input.
[[nodiscard]] DiscreteLti realize(const DiscreteTransferFunction& plant);

/// Finite transmission zeros of one channel of a plant: the generalized eigenvalues of its system
/// matrix [A - λI, b; c, d]. The channel leads from `input` to `output`, both counted from 0.
///
/// @throws InvalidInput  as validate(), or if the plant has no such channel
[[nodiscard]] Eigen::VectorXcd transmission_zeros(const ContinuousLti& plant, Eigen::Index output,
                                                  Eigen::Index input);

/// The same for a discrete plant.
[[nodiscard]] Eigen::VectorXcd transmission_zeros(const DiscreteLti& plant, Eigen::Index output,
                                                  Eigen::Index input);

}  // namespace quadtune
