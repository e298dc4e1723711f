// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/gain_match.hpp"

#include "quadtune/errors.hpp"

namespace quadtune {

GivenGainMatch match_given_gains(const Gains& given, const LinearVehicle& plant,
                                 const LqrDesign& design, const GainMatchOptions& options,
                                 const std::string& path) {
  if ((design.R.diagonal().array() == 0).any())
    throw OptionError("R", "R has a 0; expected positive entries");
  GivenGainMatch found{in_order_of(given, plant.vehicle, design, path), {}};
  try {
    found.match = match_gains(plant.model.plant, design, found.gains.K, found.gains.K_int, options);
  } catch (const InvalidInput& error) {
    if (error.where() != "match_gains") throw;
    const std::string& why = error.message();
    if (why.find(" tie") != std::string::npos) throw OptionError("tie", "tie: " + why);
    throw InvalidInput(path, why);
  }
  return found;
}

}  // namespace quadtune
