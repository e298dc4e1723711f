// SPDX-License-Identifier: Apache-2.0
/// The two plants on which a law is judged, by name.
#pragma once

#include <string>

namespace quadtune {

/// Whether the word asks for the flown plant: "flown", not "ideal".
/// @throws OptionError  naming "plant", for another word
[[nodiscard]] bool asks_for_flown_plant(const std::string& word);

}  // namespace quadtune
