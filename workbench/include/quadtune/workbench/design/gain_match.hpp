// SPDX-License-Identifier: Apache-2.0
/// LQR weights about a vehicle's trim that reproduce a given gain.
#pragma once

#include <string>

#include "quadtune/design.hpp"
#include "quadtune/tuning/match_gains.hpp"
#include "quadtune/workbench/design/given_gains.hpp"
#include "quadtune/workbench/design/linearize_or_refuse.hpp"

namespace quadtune {

/// Weights for given gains.
struct GivenGainMatch {
  OrderedGains gains;  ///< ordered by the states, integrals and inputs of the problem
  GainMatch match;     ///< the weights with their evidence
};

/// Searches for the weights.
/// @param given    in any convention
/// @param plant    the model in the convention of the problem
/// @param design   the problem, with the initial weights of the search
/// @param options  ties, tolerance and number of starts
/// @param path     of the gains, for messages
/// @throws OptionError   "R" if the weight of an input is 0, "tie" for ties that match_gains()
///                       rejects
/// @throws InvalidInput  as in_order_of(), or if match_gains() rejects the gains
[[nodiscard]] GivenGainMatch match_given_gains(const Gains& given, const LinearVehicle& plant,
                                               const LqrDesign& design,
                                               const GainMatchOptions& options,
                                               const std::string& path);

}  // namespace quadtune
