// SPDX-License-Identifier: Apache-2.0
/// Transfer functions of one input and one output. As with state-space models, continuous and
/// discrete are two types.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>

#include "quadtune/lti.hpp"

namespace quadtune {

/// G(s) = num(s)/den(s) e^(-delay s). Coefficients in descending powers of s.
struct ContinuousTransferFunction {
  Eigen::VectorXd num;  ///< at least one; no longer than den
  Eigen::VectorXd den;  ///< at least one; the first is not 0
  double delay = 0;     ///< [s], ≥ 0

  /// G(s), s [rad/s].
  [[nodiscard]] std::complex<double> operator()(std::complex<double> s) const;
};

/// G(z) = num(z)/den(z) z^(-delay), one step every dt seconds. Coefficients in descending powers of
/// z.
struct DiscreteTransferFunction {
  Eigen::VectorXd num;  ///< at least one; no longer than den
  Eigen::VectorXd den;  ///< at least one; the first is not 0
  double dt = 0;        ///< sample period [s], > 0
  int delay = 0;        ///< whole samples, ≥ 0

  /// G(z).
  [[nodiscard]] std::complex<double> operator()(std::complex<double> z) const;
};

/// Checks for emptiness, finiteness, a leading 0 of the denominator, and that there are not more
/// zeros than poles. Leading zeros of the numerator are allowed.
/// @throws InvalidInput  "where: num has degree 3, den 2, expected no more zeros than poles because
///                       …"
void validate(const ContinuousTransferFunction& plant, const std::string& where);
void validate(const DiscreteTransferFunction& plant, const std::string& where);

/// Value of a polynomial, coefficients in descending powers, by Horner's rule.
[[nodiscard]] std::complex<double> polynomial(const Eigen::VectorXd& coefficients,
                                              std::complex<double> x);

/// p · q, coefficients in descending powers; neither empty.
[[nodiscard]] Eigen::VectorXd polynomial_product(const Eigen::VectorXd& p,
                                                 const Eigen::VectorXd& q);

/// The same polynomial from its first coefficient that is not 0; of zeros alone one remains.
[[nodiscard]] Eigen::VectorXd without_leading_zeros(const Eigen::VectorXd& coefficients);

/// Roots of a polynomial, coefficients in descending powers; leading zeros are passed over. From
/// the eigenvalues of the balanced companion matrix. Empty for a constant.
/// @throws InvalidInput  when all coefficients are 0, or not finite.
[[nodiscard]] Eigen::VectorXcd polynomial_roots(const Eigen::VectorXd& coefficients);

/// gain · Π (x - root), real coefficients in descending powers. Complex roots must come in
/// conjugate pairs (to rounding); the imaginary parts that rounding leaves are dropped.
[[nodiscard]] Eigen::VectorXd polynomial_of_roots(const Eigen::VectorXcd& roots, double gain = 1);

/// Realization in controllable canonical form, states scaled by powers of two; the delay is left
/// out. nx = degree of den.
/// @throws InvalidInput  when den is a constant: a gain alone has no states.
[[nodiscard]] ContinuousLti realize(const ContinuousTransferFunction& plant);
/// The same; the delay becomes `delay` more states at the input.
[[nodiscard]] DiscreteLti realize(const DiscreteTransferFunction& plant);

/// Finite transmission zeros of one channel of a plant, by the generalized eigenvalues of its
/// system matrix [A - λI, b; c, d].
[[nodiscard]] Eigen::VectorXcd transmission_zeros(const ContinuousLti& plant, Eigen::Index output,
                                                  Eigen::Index input);
[[nodiscard]] Eigen::VectorXcd transmission_zeros(const DiscreteLti& plant, Eigen::Index output,
                                                  Eigen::Index input);

}  // namespace quadtune
