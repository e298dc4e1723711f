// SPDX-License-Identifier: Apache-2.0
/// Step responses of closed loops.
#pragma once

#include <vector>

#include "quadtune/synthesis/open_loop.hpp"
#include "quadtune/synthesis/pid/pid_gains.hpp"

namespace quadtune {

/// The response to a unit step at t = 0, from rest.
struct StepResponse {
  std::vector<double> t;  ///< [s], not decreasing; a jump has two samples at its time
  std::vector<double> y;  ///< one value per time
};

/// Computes the output of one channel after a step of its set point, with all loops closed:
/// T = L/(1 + L).
///
/// Without delay each value is exact up to rounding. With a delay, the delayed signal is
/// interpolated linearly between time steps; the delay is an integer multiple of the step. The
/// error decreases with the square of the step, which is at most 1/4000 of the duration, and jumps
/// remain exact.
///
/// @param loop      under negative feedback
/// @param channel   0 ≤ channel < loop.size()
/// @param duration  [s]; 0: automatic. For a stable loop it is usually 1.1 to 2 times the 2 %
///                  settling time; for an unstable one the response ends when it exceeds 8 in
///                  magnitude or has oscillated ten times. A discrete loop has at least 5 and at
///                  most 400000 steps; a loop with a delay has at most 400000. These limits take
///                  precedence over the duration.
/// @throws InvalidInput  if the channel does not exist, or the duration is negative or not finite
[[nodiscard]] StepResponse step_response(const OpenLoop& loop, Eigen::Index channel = 0,
                                         double duration = 0);

/// Computes the output of the plant after a unit load step at its input with u = -C y: P/(1 + C P).
/// The duration is as for step_response().
/// @throws InvalidInput  as OpenLoop for loop_of(), e.g. if it has more zeros than poles, or if the
///                       duration is negative or not finite
[[nodiscard]] StepResponse load_step_response(const ContinuousTransferFunction& plant,
                                              const PidGains& gains, double duration = 0);

}  // namespace quadtune
