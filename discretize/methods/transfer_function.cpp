// SPDX-License-Identifier: Apache-2.0
/// discretize() of transfer functions.
#include "quadtune/transfer_function.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>

#include "kernel/fraction.hpp"
#include "kernel/whole_samples.hpp"
#include "methods/period.hpp"
#include "methods/prewarp.hpp"
#include "options.hpp"
#include "quadtune/discretize/discretize.hpp"
#include "quadtune/discretize/matched.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::VectorXcd;
using Eigen::VectorXd;

/// The images of a plant's poles under a method.
VectorXcd discrete_poles(const VectorXcd& poles, double dt, DiscretizationMethod method,
                         const DiscretizationOptions& options) {
  using Method = DiscretizationMethod;
  if (method == Method::euler) return 1.0 + (poles * dt).array();
  if (method == Method::backward_euler) return (1.0 - (poles * dt).array()).inverse();
  if (method == Method::tustin) {
    const double half_step = internal::tustin_step(dt, options.prewarp, "tustin") / 2;
    const Eigen::ArrayXcd half = poles * half_step;
    return (1.0 + half) / (1.0 - half);
  }
  return (poles * dt).array().exp();
}

void require_causes(const ContinuousTransferFunction& plant, DiscretizationMethod method) {
  if (method != DiscretizationMethod::impulse || plant.num.size() < plant.den.size() ||
      plant.num[0] == 0)
    return;
  throw InvalidInput(
      "impulse",
      fmt::format("num and den have degree {}, expected fewer zeros than poles "
                  "because otherwise the impulse response contains an impulse, which cannot be "
                  "sampled",
                  plant.den.size() - 1));
}

}  // namespace

DiscreteTransferFunction discretize(const ContinuousTransferFunction& plant, double dt,
                                    DiscretizationMethod method,
                                    const DiscretizationOptions& options) {
  const std::string where = to_string(method);
  validate(plant, where);
  internal::require_period(dt, where);
  internal::refuse_prewarp(method, options.prewarp);
  if (options.delays.any())
    throw InvalidInput(where,
                       "delays of channels do not apply to a transfer function, because it "
                       "has its own delay");
  require_causes(plant, method);
  if (method == DiscretizationMethod::matched) return discretize_matched(plant, dt);

  const bool zoh = method == DiscretizationMethod::zoh;
  const internal::Samples delay =
      zoh ? internal::in_samples(plant.delay, dt, where)
          : internal::Samples{internal::whole_samples(plant.delay, dt, where)};
  DiscreteTransferFunction result;
  result.dt = dt;
  result.delay = delay.whole;
  if (plant.den.size() == 1) {
    // A delayed pure gain outputs at each sample the input of the sample before.
    result.num = plant.num.tail(1) / plant.den[0];
    result.den = VectorXd::Ones(1);
    result.delay += delay.fraction > 0 ? 1 : 0;
    return result;
  }
  const ContinuousLti core = internal::realize_for_sampling(plant, dt);
  VectorXcd poles = discrete_poles(polynomial_roots(plant.den), dt, method, options);
  DiscretizationOptions told = options;
  if (delay.fraction > 0) {
    told.delays.input = VectorXd::Constant(1, delay.fraction * dt);
    poles.conservativeResize(poles.size() + 1);
    poles[poles.size() - 1] = 0;
  }
  const DiscreteLti sampled = discretize(core, dt, method, told);
  result.den = polynomial_of_roots(poles);
  result.num = internal::numerator(sampled.A, sampled.B, sampled.C, sampled.D, result.den);
  if (!result.num.allFinite() || !result.den.allFinite()) internal::refuse_long_period(dt, where);
  return result;
}

}  // namespace quadtune
