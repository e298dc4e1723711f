// SPDX-License-Identifier: Apache-2.0
/// The uncertainty that a vehicle's file states of its own numbers, as a campaign draws it.
#pragma once

#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/campaign/uncertainty.hpp"

namespace quadtune {

/// Adds what the vehicle's [spread] states of quantities that `uncertainty` does not vary yet:
/// mass, inertia_x, inertia_y, inertia_z, thrust and motor_lag, each normal about 1 with half the
/// spread as its standard deviation, truncated at 1 ± 1.5 times the spread, the lower end at
/// least 0.05. They are independent of each other and of the other quantities. A vehicle
/// without lag gets no motor_lag.
void add_spread(const Vehicle& vehicle, Uncertainty& uncertainty);

}  // namespace quadtune
