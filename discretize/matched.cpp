// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/matched.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <functional>

#include "period.hpp"
#include "quadtune/errors.hpp"
#include "whole_samples.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;

constexpr double kNear = 1e-6;  // times 1/dt

bool near(const VectorXcd& roots, double s, double distance) {
  return roots.size() > 0 && (roots.array() - s).abs().minCoeff() < distance;
}

double matching_point(const VectorXcd& poles, const VectorXcd& zeros, double dt) {
  int tenths = 0;
  while (near(poles, 0.1 * tenths / dt, kNear / dt) || near(zeros, 0.1 * tenths / dt, kNear / dt))
    ++tenths;
  return 0.1 * tenths / dt;
}

std::complex<double> product(const VectorXcd& roots, double z) {
  std::complex<double> value = 1;
  for (const std::complex<double>& root : roots) value *= z - root;
  return value;
}

/// @param value  of the plant at a real s
DiscreteTransferFunction matched(const VectorXcd& poles, const VectorXcd& zeros,
                                 const std::function<double(double)>& value, double dt) {
  const Index at_minus_one = std::max<Index>(poles.size() - zeros.size() - 1, 0);
  const VectorXcd discrete_poles = (poles * dt).array().exp();
  VectorXcd discrete_zeros = VectorXcd::Constant(zeros.size() + at_minus_one, -1);
  discrete_zeros.head(zeros.size()) = (zeros * dt).array().exp();
  const double s = matching_point(poles, zeros, dt);
  const double z = std::exp(s * dt);
  const double gain = (value(s) * product(discrete_poles, z) / product(discrete_zeros, z)).real();
  DiscreteTransferFunction result;
  result.num = polynomial_of_roots(discrete_zeros, gain);
  result.den = polynomial_of_roots(discrete_poles);
  result.dt = dt;
  if (!result.num.allFinite() || !result.den.allFinite())
    internal::refuse_long_period(dt, "matched");
  return result;
}

void require_one_channel(const ContinuousLti& plant, Index ny) {
  if (plant.B.cols() == 1 && ny == 1) return;
  throw InvalidInput("matched",
                     fmt::format("the plant has {} inputs and {} outputs, expected one of each "
                                 "because zeros belong to a channel; take channels one by one, or "
                                 "another method",
                                 plant.B.cols(), ny));
}

}  // namespace

DiscreteTransferFunction discretize_matched(const ContinuousTransferFunction& plant, double dt) {
  validate(plant, "matched");
  internal::require_period(dt, "matched");
  const VectorXcd zeros = plant.num.isZero(0) ? VectorXcd() : polynomial_roots(plant.num);
  const auto value = [&](double s) {
    return (polynomial(plant.num, s) / polynomial(plant.den, s)).real();
  };
  DiscreteTransferFunction result = matched(polynomial_roots(plant.den), zeros, value, dt);
  result.delay = internal::whole_samples(plant.delay, dt, "matched");
  return result;
}

DiscreteLti discretize_matched(const ContinuousLti& plant, double dt) {
  validate(plant, "matched");
  internal::require_period(dt, "matched");
  const Index nx = plant.A.rows();
  require_one_channel(plant, plant.C.size() ? plant.C.rows() : nx);
  const MatrixXd C = plant.C.size() ? plant.C : MatrixXd::Identity(nx, nx);
  const double D = plant.D.size() ? plant.D(0, 0) : 0;
  const auto value = [&](double s) {
    const MatrixXd sI = s * MatrixXd::Identity(nx, nx);
    return (C * (sI - plant.A).partialPivLu().solve(plant.B)).value() + D;
  };
  DiscreteLti result =
      realize(matched(plant.A.eigenvalues(), transmission_zeros(plant, 0, 0), value, dt));
  result.inputs = plant.inputs;
  result.outputs = plant.C.size() ? plant.outputs : plant.states;
  return result;
}

}  // namespace quadtune
