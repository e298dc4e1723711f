// SPDX-License-Identifier: Apache-2.0
/// Functions of a setup that do not depend on the lanes.
#pragma once

#include "quadtune/simulation/flight.hpp"

namespace quadtune::internal {

/// Simulates one flight per lane. All setups have one structure, see same_structure().
/// @tparam N  number of lanes;  @tparam R  number of rotors with lag, as Plant's N
template <int N, int R>
[[nodiscard]] std::array<FlightResult, N> fly_together(
    const std::array<const FlightSetup*, N>& setups, const std::function<bool()>& interrupted);

/// Describes what is wrong with the command of a user-defined law; empty if it is valid.
[[nodiscard]] std::string law_fault(const FlightSetup& setup, const Eigen::VectorXd& inputs,
                                    int expected);

/// Whether two flights differ in numbers only, so that they can share a pack.
[[nodiscard]] bool same_structure(const FlightSetup& a, const FlightSetup& b);

}  // namespace quadtune::internal
