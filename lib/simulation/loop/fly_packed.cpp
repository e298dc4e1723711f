// SPDX-License-Identifier: Apache-2.0
#include "simulation/loop/closed_loop_flying.hpp"
#include "simulation/loop/closed_loop_making.hpp"

namespace quadtune::internal {

template std::array<FlightResult, kPackLanes> fly_together<kPackLanes, 4>(
    const std::array<const FlightSetup*, kPackLanes>&, const std::function<bool()>&);
template std::array<FlightResult, kPackLanes> fly_together<kPackLanes, 0>(
    const std::array<const FlightSetup*, kPackLanes>&, const std::function<bool()>&);

}  // namespace quadtune::internal
