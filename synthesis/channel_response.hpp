// SPDX-License-Identifier: Apache-2.0
/// The response of a loop of one channel, wherever it comes from, as margins are computed from it.
#pragma once

#include <complex>
#include <functional>
#include <vector>

#include "quadtune/synthesis/margins.hpp"

namespace quadtune::internal {

struct ChannelResponse {
  using Function = std::function<std::complex<double>(double w)>;

  Function at;               ///< L at w [rad/s]
  Function again;            ///< the same, computed in another order: it differs by rounding only
  Function sensitivity;      ///< S of the closed loop
  std::vector<double> grid;  ///< as frequency_grid()
  bool discrete = false;     ///< the last of the grid is Nyquist
  double delay = 0;          ///< [s] beside the states, of a continuous loop
  bool stable = false;       ///< when closed
};

/// Margins by a response. Without `stable` the disk is 0.
/// @param skew  as loop_margins(), finite
[[nodiscard]] LoopMargins margins_of(const ChannelResponse& response, double skew);

}  // namespace quadtune::internal
