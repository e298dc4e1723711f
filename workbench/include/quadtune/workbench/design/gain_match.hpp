// SPDX-License-Identifier: Apache-2.0
/// Weights of an LQR about a vehicle's trim whose gain is a given one.
#pragma once

#include <string>

#include "quadtune/design.hpp"
#include "quadtune/tuning/match_gains.hpp"
#include "quadtune/workbench/design/given_gains.hpp"
#include "quadtune/workbench/design/linearize_or_refuse.hpp"

namespace quadtune {

struct GivenGainMatch {
  OrderedGains gains;  ///< as the problem has its states, integrals and inputs
  GainMatch match;
};

/// Searches for the weights.
/// @param design  the problem, with the weights where the search begins
/// @param path    of the gains, for messages
/// @throws OptionError   "R" for a weight of 0 of an input, "tie" for ties that match_gains()
///                       refuses
/// @throws InvalidInput  as in_order_of(), and for gains that match_gains() refuses
[[nodiscard]] GivenGainMatch match_given_gains(const Gains& given, const LinearVehicle& plant,
                                               const LqrDesign& design,
                                               const GainMatchOptions& options,
                                               const std::string& path);

}  // namespace quadtune
