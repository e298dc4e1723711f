// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/to_continuous.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <limits>

#include "kernel/exponential_kernel.hpp"
#include "kernel/fraction.hpp"
#include "kernel/matrix_logarithm.hpp"
#include "methods/prewarp.hpp"
#include "options.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;

// Verifies the result: the exponential of the logarithm must equal the matrix.
constexpr double kRoundTrip = 1e-6;

double rounding(const MatrixXd& A) {
  return 16 * static_cast<double>(A.rows()) * std::numeric_limits<double>::epsilon() * A.norm();
}

void refuse_poles_without_logarithm(const MatrixXd& A) {
  const VectorXcd poles = A.eigenvalues();
  for (const Complex& pole : poles) {
    if (std::abs(pole) <= rounding(A))
      throw InvalidInput("zoh",
                         "A has a pole at 0, expected none because no continuous mode decays to "
                         "zero in one sample; remove delays from the plant first");
    if (pole.imag() == 0 && pole.real() < 0)
      throw InvalidInput(
          "zoh",
          fmt::format("A has a pole at {:.6g}, expected none on the negative real axis, because "
                      "sampling a continuous system gives none",
                      pole.real()));
  }
}

void refuse_pole_at_minus_one(const MatrixXd& A) {
  const VectorXcd poles = A.eigenvalues();
  if ((poles.array() + Complex(1)).abs().minCoeff() > rounding(A)) return;
  throw InvalidInput("tustin",
                     "A has a pole at -1, expected none because it corresponds to a pole at "
                     "infinity");
}

ContinuousLti named_like(const DiscreteLti& plant) {
  ContinuousLti result;
  result.states = plant.states;
  result.inputs = plant.inputs;
  result.outputs = plant.outputs;
  return result;
}

}  // namespace

ContinuousLti to_continuous_zoh(const DiscreteLti& plant) {
  validate(plant, "zoh");
  refuse_poles_without_logarithm(plant.A);
  ContinuousLti result = named_like(plant);
  result.C = plant.C;
  result.D = plant.D;
  result.A = internal::matrix_logarithm(plant.A) / plant.dt;
  const Index nx = plant.A.rows();
  MatrixXd again(nx, nx);
  MatrixXd integral(nx, nx);  // ∫₀^dt e^(Aτ) dτ
  const bool solved =
      internal::exponential_and_integral(result.A, MatrixXd::Identity(nx, nx), plant.dt, again,
                                         integral) == ExponentialStatus::solved;
  if (!solved || !((again - plant.A).norm() <= kRoundTrip * plant.A.norm()))
    throw InvalidInput("zoh",
                       "A has no real logarithm to within rounding, expected a plant whose poles "
                       "are neither 0 nor on the negative real axis");
  result.B = integral.partialPivLu().solve(plant.B);
  return result;
}

ContinuousLti to_continuous_tustin(const DiscreteLti& plant, std::optional<double> prewarp) {
  validate(plant, "tustin");
  const double h = internal::tustin_step(plant.dt, prewarp, "tustin");
  refuse_pole_at_minus_one(plant.A);
  const MatrixXd I = MatrixXd::Identity(plant.A.rows(), plant.A.rows());
  const MatrixXd C = plant.C.size() ? plant.C : I;
  const MatrixXd D = plant.D.size() ? plant.D : MatrixXd::Zero(C.rows(), plant.B.cols());
  const Eigen::PartialPivLU<MatrixXd> lu(plant.A + I);
  ContinuousLti result = named_like(plant);
  if (plant.C.size() == 0) result.outputs = plant.states;
  result.A = 2 / h * lu.solve(plant.A - I);
  result.B = 2 / h * lu.solve(plant.B);
  const MatrixXd Ct = lu.transpose().solve(C.transpose());
  result.C = 2 * Ct.transpose();
  result.D = D - 0.5 * result.C * plant.B;  // C_d S B_d
  return result;
}

ContinuousLti to_continuous(const DiscreteLti& plant, DiscretizationMethod method,
                            std::optional<double> prewarp) {
  internal::refuse_prewarp(method, prewarp);
  if (method == DiscretizationMethod::zoh) return to_continuous_zoh(plant);
  if (method == DiscretizationMethod::tustin) return to_continuous_tustin(plant, prewarp);
  throw InvalidInput(to_string(method),
                     "conversion to continuous time supports only zoh and tustin");
}

ContinuousTransferFunction to_continuous(const DiscreteTransferFunction& plant,
                                         DiscretizationMethod method,
                                         std::optional<double> prewarp) {
  const std::string where = to_string(method);
  validate(plant, where);
  const double dt = plant.dt;
  ContinuousTransferFunction result;
  result.delay = plant.delay * dt;
  if (plant.den.size() == 1) {
    result.num = plant.num.tail(1) / plant.den[0];
    result.den = Eigen::VectorXd::Ones(1);
    return result;
  }
  DiscreteTransferFunction prompt = plant;
  prompt.delay = 0;
  const ContinuousLti realized = to_continuous(realize(prompt), method, prewarp);
  // Computed in units of 1/dt, because powers of s in rad/s would differ by many orders of
  // magnitude.
  VectorXcd poles = polynomial_roots(plant.den);
  if (method == DiscretizationMethod::tustin) {
    const double step = internal::tustin_step(dt, prewarp, where) / dt;
    poles = 2 / step * (poles.array() - 1.0) / (poles.array() + 1.0);
  } else {
    poles = poles.array().log();
  }
  result.den = polynomial_of_roots(poles);
  result.num =
      internal::numerator(realized.A * dt, realized.B * dt, realized.C, realized.D, result.den);
  double scale = 1;
  for (Index i = 0; i < result.den.size(); ++i, scale /= dt) {
    result.den[i] *= scale;
    result.num[i] *= scale;
  }
  return result;
}

}  // namespace quadtune
