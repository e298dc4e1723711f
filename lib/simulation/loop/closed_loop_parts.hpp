// SPDX-License-Identifier: Apache-2.0
/// What a setup means before anything is flown.
#pragma once

#include "quadtune/simulation/flight.hpp"

namespace quadtune::internal {

/// One flight a lane; setups are of one structure, see same_structure().
/// @tparam N  lanes;  @tparam R  rotors with lag, as Plant's N
template <int N, int R>
[[nodiscard]] std::array<FlightResult, N> fly_together(
    const std::array<const FlightSetup*, N>& setups, const std::function<bool()>& interrupted);

/// What is wrong with the inputs that an OwnController's law asks for; empty if they can be flown.
[[nodiscard]] std::string law_fault(const FlightSetup& setup, const Eigen::VectorXd& inputs,
                                    int expected);

/// Whether two flights differ in numbers only and can share a pack.
[[nodiscard]] bool same_structure(const FlightSetup& a, const FlightSetup& b);

}  // namespace quadtune::internal
