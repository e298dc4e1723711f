// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/matched.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <complex>

#include "period.hpp"
#include "quadtune/errors.hpp"
#include "sections.hpp"
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

/// What the method makes of a plant, and where its gain is that of the plant.
struct Matched {
  VectorXcd poles;
  VectorXcd zeros;
  double s = 0;
  double z = 1;
};

Matched matched(const VectorXcd& poles, const VectorXcd& zeros, double dt) {
  const Index at_minus_one = std::max<Index>(poles.size() - zeros.size() - 1, 0);
  Matched result;
  result.poles = (poles * dt).array().exp();
  result.zeros = VectorXcd::Constant(zeros.size() + at_minus_one, -1);
  result.zeros.head(zeros.size()) = (zeros * dt).array().exp();
  result.s = matching_point(poles, zeros, dt);
  result.z = std::exp(result.s * dt);
  if (!result.poles.allFinite() || !result.zeros.allFinite() || !std::isfinite(result.z))
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
  const Matched to = matched(polynomial_roots(plant.den), zeros, dt);
  const std::complex<double> value = polynomial(plant.num, to.s) / polynomial(plant.den, to.s);
  const double gain = (value * product(to.poles, to.z) / product(to.zeros, to.z)).real();
  DiscreteTransferFunction result;
  result.num = polynomial_of_roots(to.zeros, gain);
  result.den = polynomial_of_roots(to.poles);
  result.dt = dt;
  if (!result.num.allFinite() || !result.den.allFinite())
    internal::refuse_long_period(dt, "matched");
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
  const Matched to = matched(plant.A.eigenvalues(), transmission_zeros(plant, 0, 0), dt);
  const MatrixXd sI = to.s * MatrixXd::Identity(nx, nx);
  const double value = (C * (sI - plant.A).partialPivLu().solve(plant.B)).value() + D;
  DiscreteLti result = internal::series_of_sections(to.poles, to.zeros, to.z, value, dt);
  if (!result.A.allFinite() || !result.C.allFinite()) internal::refuse_long_period(dt, "matched");
  result.inputs = plant.inputs;
  result.outputs = plant.C.size() ? plant.outputs : plant.states;
  return result;
}

}  // namespace quadtune
