// SPDX-License-Identifier: Apache-2.0
/// The frequency response of a loop with one channel, from which margins are computed.
#pragma once

#include <complex>
#include <functional>
#include <vector>

#include "quadtune/synthesis/margins.hpp"

namespace quadtune::internal {

struct ChannelResponse {
  using Function = std::function<std::complex<double>(double w)>;

  Function at;               ///< L at w [rad/s]
  Function again;            ///< L computed in another order: differs from `at` by rounding only
  Function sensitivity;      ///< S of the closed loop
  std::vector<double> grid;  ///< as frequency_grid()
  bool discrete = false;     ///< whether the last frequency of the grid is Nyquist
  double delay = 0;          ///< of a continuous loop, in addition to its states [s]
  bool stable = false;       ///< whether the closed loop is stable
};

/// Computes the margins of a loop. The disk margin of an unstable loop is 0.
/// @param skew  as for loop_margins(), finite
[[nodiscard]] LoopMargins margins_of(const ChannelResponse& response, double skew);

}  // namespace quadtune::internal
