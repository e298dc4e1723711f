// SPDX-License-Identifier: Apache-2.0
/// The names of the two plants on which a law is analysed.
#pragma once

#include <string>

namespace quadtune {

/// Whether the word selects the flown plant: true for "flown", false for "ideal".
/// @throws OptionError  "plant", for other words
[[nodiscard]] bool asks_for_flown_plant(const std::string& word);

}  // namespace quadtune
