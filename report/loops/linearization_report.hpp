// SPDX-License-Identifier: Apache-2.0
/// The linear model of a vehicle about a trim.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/linearize/linearize.hpp"

namespace quadtune::report {

/// A, B and the trim with the names of states and inputs; the notes in JSON only.
/// @param model  solved
[[nodiscard]] internal::Json to_json(const Linearization& model);
[[nodiscard]] std::string to_text(const Linearization& model);

}  // namespace quadtune::report
