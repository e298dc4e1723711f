// SPDX-License-Identifier: Apache-2.0
/// A sampled plant, or one taken back to continuous time, as text and JSON.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/sampling/sampled_plant.hpp"

namespace quadtune::report {

/// "A", "B", "C", "D", and "states" where delays have added to them; or "num", "den" and the delay.
/// Then "dt", "method", "inverse" and "warnings".
[[nodiscard]] internal::Json to_json(const SampledPlant& sampled);
[[nodiscard]] std::string to_text(const SampledPlant& sampled);

}  // namespace quadtune::report
