// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/matched.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "kernel/whole_samples.hpp"
#include "methods/period.hpp"
#include "methods/sections.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// Roots closer to 0 than this fraction of ‖A‖ may be a single multiple root at 0 that rounding has
/// scattered.
constexpr double kScatter = 1e-3;
/// Minimum distance of the reference point from all roots, times 1/dt.
constexpr double kClear = 0.01;

/// e^x - 1 without cancellation near 0.
std::complex<double> expm1(std::complex<double> x) {
  const double sine = std::sin(0.5 * x.imag());
  return {std::expm1(x.real()) * std::cos(x.imag()) - 2 * sine * sine,
          std::exp(x.real()) * std::sin(x.imag())};
}

/// (e^x - 1)/x, which is 1 at 0.
std::complex<double> growth(std::complex<double> x) { return x == 0.0 ? 1.0 : expm1(x) / x; }

/// The images of a plant's poles and zeros.
struct Matched {
  VectorXcd poles;
  VectorXcd zeros;
  Index at_minus_one = 0;  ///< number of zeros that are images of infinity
};

/// A nonzero root that is mapped to z = 1 would give G_d a pole or zero there that G does not have
/// at 0.
void require_no_whole_turns(const VectorXcd& roots, double dt) {
  constexpr double kRounding = 1e-12;
  // A root with a large negative real part has e^x far from 1.
  for (const std::complex<double>& root : roots)
    if (root != 0.0 && std::abs(root.real() * dt) < 1 && std::abs(growth(root * dt)) < kRounding)
      throw InvalidInput(
          "matched",
          fmt::format("dt is {} s, expected another period because a mode of {:.6g} "
                      "rad/s completes whole cycles per sample and would appear constant",
                      dt, std::abs(root.imag())));
}

Matched matched(const VectorXcd& poles, const VectorXcd& zeros, double dt) {
  Matched result;
  result.at_minus_one = std::max<Index>(poles.size() - zeros.size() - 1, 0);
  result.poles = (poles * dt).array().exp();
  result.zeros = VectorXcd::Constant(zeros.size() + result.at_minus_one, -1);
  result.zeros.head(zeros.size()) = (zeros * dt).array().exp();
  if (!result.poles.allFinite() || !result.zeros.allFinite())
    internal::refuse_long_period(dt, "matched");
  require_no_whole_turns(poles, dt);
  require_no_whole_turns(zeros, dt);
  return result;
}

/// The nonzero coefficient of the lowest power: with n roots at 0, the limit of p(s)/sⁿ for s → 0.
double lowest(const VectorXd& coefficients) {
  Index last = coefficients.size() - 1;
  while (last > 0 && coefficients[last] == 0) --last;
  return coefficients[last];
}

/// Π (z - e^(r dt)) at z = 1 over the roots r, where each root at 0 contributes dt = (z - 1)/((z -
/// 1)/dt).
std::complex<double> product_at_one(const VectorXcd& roots, double dt) {
  std::complex<double> value = 1;
  for (const std::complex<double>& root : roots) value *= root == 0.0 ? dt : -expm1(root * dt);
  return value;
}

double nearest(const VectorXcd& roots, double s) {
  return roots.size() > 0 ? (roots.array() - s).abs().minCoeff()
                          : std::numeric_limits<double>::infinity();
}

/// A real point at which G can be evaluated: 0, or the first of 0.1/dt, 0.2/dt, … away from all
/// roots.
double reference_point(const VectorXcd& poles, const VectorXcd& zeros, double dt, double norm_A) {
  const auto clear_of = [&](double s, double distance) {
    return nearest(poles, s) > distance && nearest(zeros, s) > distance;
  };
  if (clear_of(0, std::max(kScatter * norm_A, 1e-6 / dt))) return 0;
  int tenths = 1;
  while (!clear_of(0.1 * tenths / dt, kClear / dt)) ++tenths;
  return 0.1 * tenths / dt;
}

/// The product over the roots r of the ratio (z - e^(r dt))/(s - r), z = e^(s dt), at 0, divided by
/// the same ratio at s. It converts a gain that is matched at s to one that is matched at 0.
std::complex<double> from_reference(const VectorXcd& roots, double s, double dt) {
  std::complex<double> value = 1;
  for (const std::complex<double>& root : roots)
    value *= growth(root * dt) * (s - root) * dt / (std::exp(s * dt) - std::exp(root * dt));
  return value;
}

void require_one_channel(const ContinuousLti& plant, Index ny) {
  if (plant.B.cols() == 1 && ny == 1) return;
  throw InvalidInput(
      "matched",
      fmt::format(
          "the plant has {} and {}, expected one of each because zeros belong to a channel; "
          "discretize the channels one by one or use another method",
          internal::counted(plant.B.cols(), "input"), internal::counted(ny, "output")));
}

}  // namespace

DiscreteTransferFunction discretize_matched(const ContinuousTransferFunction& plant, double dt) {
  validate(plant, "matched");
  internal::require_period(dt, "matched");
  const VectorXcd poles = polynomial_roots(plant.den);
  const VectorXcd zeros = plant.num.isZero(0) ? VectorXcd() : polynomial_roots(plant.num);
  const Matched to = matched(poles, zeros, dt);
  // sⁿ G(s) at s = 0 equals ((z - 1)/dt)ⁿ G_d(z) at z = 1, where each zero at -1 contributes a
  // factor 2.
  const double value = lowest(plant.num) / lowest(plant.den);
  const std::complex<double> ratio = product_at_one(poles, dt) / product_at_one(zeros, dt);
  const double gain = std::ldexp(value * ratio.real(), -static_cast<int>(to.at_minus_one));
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
  const VectorXcd poles = plant.A.eigenvalues();
  const VectorXcd zeros = transmission_zeros(plant, 0, 0);
  const Matched to = matched(poles, zeros, dt);
  const double s = reference_point(poles, zeros, dt, plant.A.norm());
  const double z = std::exp(s * dt);
  const MatrixXd sI = s * MatrixXd::Identity(nx, nx);
  double value = (C * (sI - plant.A).partialPivLu().solve(plant.B)).value() + D;
  if (s > 0) {
    const std::complex<double> ratio = from_reference(poles, s, dt) / from_reference(zeros, s, dt);
    value *= ratio.real() * std::pow(0.5 * (z + 1), static_cast<double>(to.at_minus_one));
  }
  DiscreteLti result = internal::series_of_sections(to.poles, to.zeros, z, value, dt);
  if (!result.A.allFinite() || !result.C.allFinite()) internal::refuse_long_period(dt, "matched");
  result.inputs = plant.inputs;
  result.outputs = plant.C.size() ? plant.outputs : plant.states;
  return result;
}

}  // namespace quadtune
