// SPDX-License-Identifier: Apache-2.0
/// Closed loops in time: the answer to a step.
#pragma once

#include <vector>

#include "quadtune/synthesis/open_loop.hpp"
#include "quadtune/synthesis/pid_gains.hpp"

namespace quadtune {

/// What comes out after a step of size 1 at t = 0, from rest.
struct StepResponse {
  std::vector<double> t;  ///< [s], not decreasing; a jump has two values at its time
  std::vector<double> y;  ///< as many
};

/// The output of one channel after a step of its set point, with all loops closed: T = L/(1 + L).
///
/// Without delay each value is exact up to rounding. With a delay the signal that comes back is
/// taken as straight between instants that are a whole part of the delay apart: the error falls
/// with the square of their distance, at most 1/4000 of the duration, and jumps stay sharp.
///
/// @param channel   0 ≤ channel < loop.size()
/// @param duration  [s]; 0 chooses one: of a stable loop until within 2 % for good and half as long
///                  again, of an unstable one until it has left 8 or has swung ten times. A
///                  delay takes at most 400000 steps, which may shorten it.
/// @throws InvalidInput  for a channel that is not there, or a duration that is negative or not
///                       finite
[[nodiscard]] StepResponse step_response(const OpenLoop& loop, Eigen::Index channel = 0,
                                         double duration = 0);

/// The plant's output after a step of load at its input, under u = -C y: P/(1 + C P). The duration
/// as above.
/// @throws InvalidInput  where loop_of() gives more zeros than poles
[[nodiscard]] StepResponse load_step_response(const ContinuousTransferFunction& plant,
                                              const PidGains& gains, double duration = 0);

}  // namespace quadtune
