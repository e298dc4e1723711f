// SPDX-License-Identifier: Apache-2.0
/// A vehicle's cascade and how it flies, as text, JSON and picture.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/design/vehicle_cascade.hpp"
#include "report/plots/figure.hpp"

namespace quadtune::report {

/// The cascade's report with "method", "plant", "flown", "flown_loop", and its laws as they are
/// read again.
[[nodiscard]] internal::Json to_json(const VehicleCascade& cascade);
[[nodiscard]] std::string to_text(const VehicleCascade& cascade);

/// All loops, cut at the wrench.
[[nodiscard]] Figure cascade_figure(const VehicleCascade& cascade);

}  // namespace quadtune::report
