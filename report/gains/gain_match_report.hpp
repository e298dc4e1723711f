// SPDX-License-Identifier: Apache-2.0
/// Weights that were found for a gain: as text, as JSON and as a design file.
#pragma once

#include <string>

#include "quadtune/flight_condition.hpp"
#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/tuning/match_gains.hpp"

namespace quadtune::report {

struct GainMatchReport {
  const Vehicle& vehicle;
  const std::string& vehicle_word;  ///< a built-in vehicle, or its file
  FlightCondition flight;           ///< about which the plant is linear
  const std::string& file;          ///< of the gains
  const Eigen::MatrixXd& K;
  const Eigen::MatrixXd& K_int;
  const GainMatch& match;
  double tolerance;
};

[[nodiscard]] internal::Json to_json(const GainMatchReport& report);
[[nodiscard]] std::string to_text(const GainMatchReport& report);

/// A design file with the weights, and with the given gain as the published one, so that
/// `quadtune design` tells how near it comes.
/// @param path     it will be written to: a vehicle file is named from there
/// @param command  for the first line
[[nodiscard]] std::string design_file(const GainMatchReport& report, const std::string& path,
                                      const std::string& command);

}  // namespace quadtune::report
