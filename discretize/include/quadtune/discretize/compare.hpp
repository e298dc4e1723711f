// SPDX-License-Identifier: Apache-2.0
/// Errors of a sampled system relative to the continuous system that it approximates.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "quadtune/discretize/discretize.hpp"
#include "quadtune/lti.hpp"

namespace quadtune {

/// Errors of one sampled system; 0 if the approximation is exact.
struct SamplingError {
  /// max |log(z e^(-s dt))| / (|s| dt) over matched poles s and z (nearest to nearest): the
  /// relative error of the poles. Poles that decay to less than 1e-6 within a sample are excluded.
  /// Independent of dt for a method whose pole error is proportional to a power of dt.
  double pole = 0;
  /// max |y_d[k] - y(k dt)| / max |y| of unit step responses, over 7 time constants of the slowest
  /// pole, but at least 10 and at most 20000 samples; infinite if the sampled system is unstable.
  double step = 0;
  /// max |G_d(e^(jw dt)) - G(jw)| / max |G| up to the Nyquist frequency; infinite if unstable.
  double frequency = 0;
  bool stable = false;  ///< all |z| < 1
};

/// Computes the errors of a sampled system. Channel i is from input i to output i; `step` and
/// `frequency` compare only the channels.
/// @param loop     stable, with explicit C and as many outputs as inputs
/// @param sampled  with explicit C and as many inputs and outputs as `loop`
/// @throws InvalidInput  as validate(); if C is empty, if the numbers of inputs and outputs of the
///                       two systems are not all equal, or if `loop` is not stable
[[nodiscard]] SamplingError sampling_error(const ContinuousLti& loop, const DiscreteLti& sampled);

/// One channel of a system with only the states that its input reaches and its output depends on,
/// as determined by the entries that exceed rounding.
/// @throws InvalidInput  if the input or output does not exist
[[nodiscard]] ContinuousLti channel_of(const ContinuousLti& plant, Eigen::Index input,
                                       Eigen::Index output);

/// Discretizes each channel of a system by itself, which DiscretizationMethod::matched requires.
/// Channel i is from input i to output i; all other couplings are dropped.
/// @param loop    as many outputs as inputs
/// @param dt      sample period [s], 0 < dt < ∞
/// @param method  how each channel is sampled
/// @throws InvalidInput  as discretize()
[[nodiscard]] DiscreteLti discretize_channels(const ContinuousLti& loop, double dt,
                                              DiscretizationMethod method);

/// The longest sample period [s] up to which a method preserves the stability of a stable system:
/// the minimum of -2 Re s/|s|² over the poles for forward Euler, infinite for the other methods.
/// @param poles   of the continuous system [1/s]; poles at 0 are ignored
/// @param method  any
[[nodiscard]] double stability_limit(const Eigen::VectorXcd& poles, DiscretizationMethod method);

/// The same for any way to sample, by search and bisection to a relative 1e-9. The search starts at
/// `dt` [s] and goes up, or down if the system is unstable there, by a sixteenth at a time.
/// Infinite if no limit is found up to `longest` [s]; 0 if the system is unstable down to dt/1e4.
/// @param sampled  returns the dynamics A for a period
/// @param dt       start of the search [s], > 0
/// @param longest  end of the search [s]
[[nodiscard]] double stability_limit(const std::function<Eigen::MatrixXd(double)>& sampled,
                                     double dt, double longest);

}  // namespace quadtune
