// SPDX-License-Identifier: Apache-2.0
/// One law at several control periods, each on the flown plant of that period.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune {

/// The law at one control period.
struct FlownPeriod {
  double dt = 0;                  ///< [s]
  std::optional<FlownLoop> loop;  ///< none if there is no flown plant at this period
  std::string why;                ///< the reason if `loop` is none, otherwise empty
};

/// The flown loop of the same gains at each period, with the vehicle's own sensors and its default
/// estimator. The gains are not changed; sampled integrals use the period.
/// @param vehicle  valid
/// @param law      without a memory of its own commands, which is specific to one period
/// @param periods  [s], > 0
/// @throws InvalidInput  if the law has such a memory; as plan_flight()
[[nodiscard]] std::vector<FlownPeriod> flown_at_periods(const Vehicle& vehicle,
                                                        const Controller& law,
                                                        const std::vector<double>& periods);

}  // namespace quadtune
