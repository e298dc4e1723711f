// SPDX-License-Identifier: Apache-2.0
/// How far a sampled system is from the continuous one that it stands for.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "quadtune/discretize/discretize.hpp"
#include "quadtune/lti.hpp"

namespace quadtune {

/// Errors of one sampled system. Each is 0 where nothing is lost.
struct SamplingError {
  /// max |log(z e^(-s dt))| / (|s| dt) over the poles s and z that belong to each other, nearest to
  /// nearest: by which share of its size a pole has moved. Poles that die to 1e-6 within a sample
  /// are left out. The same of a method at all dt where it
  /// moves them by a power of dt.
  double pole = 0;
  /// max |y_d[k] - y(k dt)| / max |y| after unit steps, until the slowest pole has died; infinite
  /// when the sampled system is not stable.
  double step = 0;
  /// max |G_d(e^(jw dt)) - G(jw)| / max |G| up to Nyquist; infinite likewise.
  double frequency = 0;
  bool stable = false;  ///< all |z| < 1
};

/// @param loop     stable; channels are its inputs to the outputs of the same index
/// @param sampled  as many inputs, and outputs, as `loop`
/// @throws InvalidInput  for systems that do not fit each other, or a `loop` that is not stable
[[nodiscard]] SamplingError sampling_error(const ContinuousLti& loop, const DiscreteLti& sampled);

/// One channel of a system with the states that its input reaches and its output sees, by which
/// entries are more than rounding.
/// @throws InvalidInput  for an input or output that is not there
[[nodiscard]] ContinuousLti channel_of(const ContinuousLti& plant, Eigen::Index input,
                                       Eigen::Index output);

/// Each channel of a system by a method; matched poles and zeros are taken channel by channel.
/// @return  as many inputs as outputs; the channels do not act on one another
/// @throws InvalidInput  as discretize()
[[nodiscard]] DiscreteLti discretize_channels(const ContinuousLti& loop, double dt,
                                              DiscretizationMethod method);

/// The longest period [s] up to which a method keeps a stable system stable: -2 Re s/|s|² of the
/// worst pole for forward Euler, infinite for the others.
[[nodiscard]] double stability_limit(const Eigen::VectorXcd& poles, DiscretizationMethod method);

/// The same of any way to sample, by search upwards from `dt` [s], or downwards where it is not
/// stable there, a sixteenth at a time, and bisection to 1e-9; infinite when none is met up to
/// `longest` [s], 0 when it is not stable down to dt/1e4.
/// @param sampled  the dynamics A for a period
[[nodiscard]] double stability_limit(const std::function<Eigen::MatrixXd(double)>& sampled,
                                     double dt, double longest);

}  // namespace quadtune
