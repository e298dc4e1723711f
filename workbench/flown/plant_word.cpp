// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flown/plant_word.hpp"

#include <fmt/format.h>

#include "quadtune/errors.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {

bool asks_for_flown_plant(const std::string& word) {
  if (word == "flown") return true;
  if (word == "ideal") return false;
  throw OptionError(
      "plant", fmt::format("plant is '{}', expected flown or ideal{}", internal::printable(word),
                           internal::did_you_mean(word, {"flown", "ideal"})));
}

}  // namespace quadtune
