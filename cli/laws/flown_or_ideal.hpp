// SPDX-License-Identifier: Apache-2.0
/// The option --plant, which several verbs share.
#pragma once

#include <string>

namespace quadtune::cli {

/// Whether the flown plant is asked for: "flown", not "ideal".
/// @param verb  for the message, e.g. "margins"
/// @throws UsageError  for another word
[[nodiscard]] bool asks_for_flown_plant(const std::string& plant, const std::string& verb);

}  // namespace quadtune::cli
