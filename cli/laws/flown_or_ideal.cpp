// SPDX-License-Identifier: Apache-2.0
#include "laws/flown_or_ideal.hpp"

#include <fmt/format.h>

#include "program/program.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::cli {

bool asks_for_flown_plant(const std::string& plant, const std::string& verb) {
  if (plant == "flown") return true;
  if (plant == "ideal") return false;
  throw UsageError(
      fmt::format("quadtune {}: --plant is '{}', expected flown or ideal{}", verb,
                  internal::printable(plant), internal::did_you_mean(plant, {"flown", "ideal"})),
      "--plant");
}

}  // namespace quadtune::cli
