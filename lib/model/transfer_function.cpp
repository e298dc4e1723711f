// SPDX-License-Identifier: Apache-2.0
#include "quadtune/transfer_function.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/Polynomials>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/internal/balance.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

namespace {

void require_fraction(const VectorXd& num, const VectorXd& den, const std::string& where) {
  if (num.size() == 0) throw InvalidInput(where, "num is empty, expected at least one coefficient");
  if (den.size() == 0) throw InvalidInput(where, "den is empty, expected at least one coefficient");
  require_finite(num, where, "num");
  require_finite(den, where, "den");
  if (den[0] == 0)
    throw InvalidInput(where,
                       "the first coefficient of den is 0, expected a nonzero number because it "
                       "belongs to the highest power; omit leading zeros");
  const Index zeros = without_leading_zeros(num).size();
  if (zeros > den.size())
    throw InvalidInput(where, fmt::format("num has degree {}, den {}, expected no more zeros than "
                                          "poles because a differentiator has no state-space model",
                                          zeros - 1, den.size() - 1));
}

/// A constant has no realization with states.
void require_a_pole(const VectorXd& den) {
  if (den.size() < 2)
    throw InvalidInput("realize",
                       "den is a constant, expected at least one pole because a gain "
                       "alone has no states");
}

/// Controllable canonical form in the variable s/σ.
template <class Lti>
Lti canonical_form(const VectorXd& num, const VectorXd& den, double sigma) {
  const Index n = den.size() - 1;
  const VectorXd a = den / den[0];
  VectorXd b = VectorXd::Zero(n + 1);
  const VectorXd short_num = without_leading_zeros(num);
  b.tail(short_num.size()) = short_num / den[0];
  Lti plant;
  plant.A = MatrixXd::Zero(n, n);
  plant.B = MatrixXd::Zero(n, 1);
  plant.C = MatrixXd::Zero(1, n);
  plant.D = MatrixXd::Constant(1, 1, b[0]);
  plant.B(0, 0) = sigma;
  double power = 1;
  for (Index i = 0; i < n; ++i) {
    power /= sigma;
    plant.A(0, i) = -a[i + 1] * power * sigma;
    plant.C(0, i) = (b[i + 1] - b[0] * a[i + 1]) * power;
    if (i > 0) plant.A(i, i - 1) = sigma;
  }
  return plant;
}

/// A power of two close to the magnitude of the largest pole: max |aᵢ|^(1/i).
double pole_size(const VectorXd& den) {
  double size = 0;
  for (Index i = 1; i < den.size(); ++i)
    size = std::max(size, std::pow(std::abs(den[i] / den[0]), 1 / static_cast<double>(i)));
  return size > 0 && std::isfinite(size) ? std::ldexp(1.0, std::ilogb(size)) : 1.0;
}

/// Adds `delay` states for u[k - delay] in front of the plant's input.
DiscreteLti with_input_delay(const DiscreteLti& plant, Index delay) {
  if (delay == 0) return plant;
  const Index n = plant.A.rows();
  DiscreteLti delayed;
  delayed.dt = plant.dt;
  delayed.A = MatrixXd::Zero(n + delay, n + delay);
  delayed.A.topLeftCorner(n, n) = plant.A;
  delayed.A.block(0, n, n, 1) = plant.B;
  for (Index i = 0; i + 1 < delay; ++i) delayed.A(n + i, n + i + 1) = 1;
  delayed.B = MatrixXd::Zero(n + delay, 1);
  delayed.B(n + delay - 1, 0) = 1;
  delayed.C = MatrixXd::Zero(1, n + delay);
  delayed.C.leftCols(n) = plant.C;
  delayed.C(0, n) = plant.D(0, 0);
  delayed.D = MatrixXd::Zero(1, 1);
  return delayed;
}

/// The relative degree of c (λI - A)⁻¹ b + d: the number of Markov parameters d, c b, c A b, … that
/// are 0 before the first one that is not. A parameter counts as 0 if it is below the rounding error
/// of the sum that defines it. A common tolerance would fail for plants with both slow and fast
/// states.
/// @param A, b, c, d  scaled: b and c are as large as A
/// @return  more than the number of states if all vanish
Index relative_degree(const MatrixXd& A, VectorXd b, const VectorXd& c, double d) {
  const Index n = A.rows();
  const double rounding = 1e-13 * static_cast<double>(n + 1);
  const double size = A.norm() > 0 ? A.norm() : 1;
  if (std::abs(d) > rounding * size) return 0;
  VectorXd magnitudes = b.cwiseAbs();
  const MatrixXd scaled = A / size, sizes = scaled.cwiseAbs();
  for (Index k = 1; k <= n; ++k) {
    if (std::abs(c.dot(b)) > rounding * c.cwiseAbs().dot(magnitudes)) return k;
    b = (scaled * b).eval();
    magnitudes = (sizes * magnitudes).eval();
  }
  return n + 1;
}

/// Zeros of [A - λI, b; c, d]. As long as d is 0, the output c x must remain 0, which eliminates a
/// state, and its derivative becomes the new output: one state less, the same zeros (as Emami-Naeini,
/// Van Dooren 1982, for one channel). The elimination pivots, so that it keeps entries that are 0,
/// and the digits of slow states beside fast ones. If d is not 0, the zeros are the eigenvalues of
/// A - b c/d.
VectorXcd zeros_of(MatrixXd A, VectorXd b, VectorXd c, double d) {
  const VectorXd scale = internal::balance(A);
  A = (scale.cwiseInverse().asDiagonal() * A * scale.asDiagonal()).eval();
  b = b.cwiseQuotient(scale);
  c = c.cwiseProduct(scale);
  // The zeros do not depend on the units of input and output: scale all entries to the size of A.
  const double size = A.norm() > 0 ? A.norm() : 1;
  const double in = std::max(b.norm(), std::abs(d) / std::max(c.norm(), 1e-300) * size);
  const double out = std::max(c.norm(), std::abs(d) / in * size);
  if (!(in > 0) || !(out > 0)) return {};
  b *= size / in;
  c *= size / out;
  d *= size / in * (size / out);
  const Index end = A.rows() - relative_degree(A, b, c, d);  // the number of zeros
  if (end <= 0) return {};
  for (Index n = A.rows();; --n) {
    if (n == end)
      return d == 0 ? VectorXcd() : VectorXcd((A - b * c.transpose() / d).eigenvalues());
    // The output replaces the state that contributes most to it; then y = 0 and y' = 0.
    Index pivot = 0;
    c.cwiseAbs().maxCoeff(&pivot);
    const Index last = n - 1;
    A.row(pivot).swap(A.row(last));
    A.col(pivot).swap(A.col(last));
    std::swap(b[pivot], b[last]);
    std::swap(c[pivot], c[last]);
    if (c[last] == 0) return {};
    const VectorXd share = c.head(last) / c[last];  // of the other states, at most 1
    const Eigen::RowVectorXd slope = share.transpose() * A.topRows(last) + A.row(last);
    d = share.dot(b.head(last)) + b[last];
    c = slope.head(last).transpose() - slope[last] * share;
    A = (A.topLeftCorner(last, last) - A.col(last).head(last) * share.transpose()).eval();
    b = b.head(last).eval();
  }
}

template <class Lti>
VectorXcd channel_zeros(const Lti& plant, Index output, Index input) {
  validate(plant, "transmission_zeros");
  const Index nx = plant.A.rows();
  const Index ny = plant.C.size() ? plant.C.rows() : nx;
  if (output < 0 || output >= ny || input < 0 || input >= plant.B.cols())
    throw InvalidInput("transmission_zeros",
                       fmt::format("channel from input {} to output {}, expected one of {} inputs "
                                   "and {} outputs, counted from 0",
                                   input, output, plant.B.cols(), ny));
  const VectorXd c = plant.C.size() ? VectorXd(plant.C.row(output)) : VectorXd::Unit(nx, output);
  const double d = plant.D.size() ? plant.D(output, input) : 0;
  return zeros_of(plant.A, plant.B.col(input), c, d);
}

}  // namespace

std::complex<double> polynomial(const VectorXd& coefficients, std::complex<double> x) {
  std::complex<double> value = 0;
  for (const double c : coefficients) value = value * x + c;
  return value;
}

VectorXd polynomial_product(const VectorXd& p, const VectorXd& q) {
  VectorXd product = VectorXd::Zero(p.size() + q.size() - 1);
  for (Index i = 0; i < p.size(); ++i) product.segment(i, q.size()) += p[i] * q;
  return product;
}

VectorXd without_leading_zeros(const VectorXd& coefficients) {
  Index first = 0;
  while (first + 1 < coefficients.size() && coefficients[first] == 0) ++first;
  return coefficients.tail(coefficients.size() - first);
}

std::complex<double> ContinuousTransferFunction::operator()(std::complex<double> s) const {
  return polynomial(num, s) / polynomial(den, s) * std::exp(-delay * s);
}

std::complex<double> DiscreteTransferFunction::operator()(std::complex<double> z) const {
  return polynomial(num, z) / polynomial(den, z) * std::pow(z, -delay);
}

void validate(const ContinuousTransferFunction& plant, const std::string& where) {
  require_fraction(plant.num, plant.den, where);
  if (!(plant.delay >= 0) || !std::isfinite(plant.delay))
    throw InvalidInput(where, fmt::format("delay is {} s, expected a finite number >= 0 because a "
                                          "negative delay is not causal",
                                          plant.delay));
}

void validate(const DiscreteTransferFunction& plant, const std::string& where) {
  require_fraction(plant.num, plant.den, where);
  if (!(plant.dt > 0) || !std::isfinite(plant.dt))
    throw InvalidInput(where, fmt::format("dt is {} s, expected a positive number", plant.dt));
  if (plant.delay < 0)
    throw InvalidInput(where,
                       fmt::format("delay is {} samples, expected >= 0 because a negative delay "
                                   "is not causal",
                                   plant.delay));
}

VectorXcd polynomial_roots(const VectorXd& coefficients) {
  require_finite(coefficients, "polynomial_roots", "the polynomial");
  const VectorXd c = without_leading_zeros(coefficients);
  if (c.size() == 0 || c[0] == 0)
    throw InvalidInput("polynomial_roots",
                       "all coefficients are 0, expected a nonzero one "
                       "because otherwise every number is a root");
  // Roots at 0 are removed exactly; the solver requires a nonzero last coefficient.
  Index at_zero = 0;
  while (c[c.size() - 1 - at_zero] == 0) ++at_zero;
  const Index rest = c.size() - 1 - at_zero;
  VectorXcd roots = VectorXcd::Zero(rest + at_zero);
  if (rest == 1) roots[0] = -c[1] / c[0];
  if (rest > 1)
    roots.head(rest) =
        Eigen::PolynomialSolver<double, Eigen::Dynamic>(c.head(rest + 1).reverse().eval()).roots();
  return roots;
}

VectorXd polynomial_of_roots(const VectorXcd& roots, double gain) {
  VectorXcd c = VectorXcd::Zero(roots.size() + 1);
  c[0] = gain;
  for (Index i = 0; i < roots.size(); ++i)
    for (Index k = i + 1; k > 0; --k) c[k] -= roots[i] * c[k - 1];
  return c.real();
}

ContinuousLti realize(const ContinuousTransferFunction& plant) {
  validate(plant, "realize");
  require_a_pole(plant.den);
  return canonical_form<ContinuousLti>(plant.num, plant.den, pole_size(plant.den));
}

DiscreteLti realize(const DiscreteTransferFunction& plant) {
  validate(plant, "realize");
  require_a_pole(plant.den);
  auto result = canonical_form<DiscreteLti>(plant.num, plant.den, 1);
  result.dt = plant.dt;
  return with_input_delay(result, plant.delay);
}

VectorXcd transmission_zeros(const ContinuousLti& plant, Index output, Index input) {
  return channel_zeros(plant, output, input);
}
VectorXcd transmission_zeros(const DiscreteLti& plant, Index output, Index input) {
  return channel_zeros(plant, output, input);
}

}  // namespace quadtune
