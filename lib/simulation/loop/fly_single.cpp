// SPDX-License-Identifier: Apache-2.0
#include "simulation/loop/closed_loop_flying.hpp"
#include "simulation/loop/closed_loop_making.hpp"

namespace quadtune::internal {

template std::array<FlightResult, 1> fly_together<1, 4>(const std::array<const FlightSetup*, 1>&,
                                                        const std::function<bool()>&);
template std::array<FlightResult, 1> fly_together<1, 0>(const std::array<const FlightSetup*, 1>&,
                                                        const std::function<bool()>&);
template std::array<FlightResult, 1> fly_together<1, Eigen::Dynamic>(
    const std::array<const FlightSetup*, 1>&, const std::function<bool()>&);

}  // namespace quadtune::internal
