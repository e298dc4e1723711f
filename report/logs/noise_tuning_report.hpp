// SPDX-License-Identifier: Apache-2.0
/// The noise covariances that were found for a filter, as text and as JSON.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/logs/tuned_noise.hpp"

namespace quadtune::report {

/// Which logs came, how the fit went, what it gained: a word and what is said of it.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> facts_of(const TunedNoise& tuned);

[[nodiscard]] internal::Json to_json(const TunedNoise& tuned);
[[nodiscard]] std::string to_text(const TunedNoise& tuned);

}  // namespace quadtune::report
