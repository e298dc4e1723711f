// SPDX-License-Identifier: Apache-2.0
#include "arguments/flown_or_ideal.hpp"

#include <fmt/format.h>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::cli {
namespace {

/// Options of the ideal plant alone: another flight than hover, other words, another cost.
constexpr const char* kIdealOptions[] = {"--at",       "--speed",  "--climb",      "--radius",
                                         "--yaw-rate", "--yaw",    "--convention", "--inputs",
                                         "--states",   "--method", "--schedule",   "--evidence"};

/// Options of a law of the flown plant that remembers its commands.
constexpr const char* kDynamicOptions[] = {"--change", "--past", "--integral"};

[[noreturn]] void refuse(const std::string& option, const std::string& why) {
  throw UsageError(fmt::format("quadtune lqr: {} {}", option, why), option);
}

/// Whether --structure asks for a matrix alone.
bool asks_for_matrix(const std::string& structure, const CommandLine& line) {
  if (structure.empty() || structure == "dynamic") return false;
  if (structure != "matrix")
    refuse("--structure",
           fmt::format("is '{}', expected dynamic or matrix{}", internal::printable(structure),
                       internal::did_you_mean(structure, {"dynamic", "matrix"})));
  for (const char* name : kDynamicOptions)
    if (line.was_given(name))
      refuse(name,
             "came with --structure matrix, expected none because that law integrates px,py,pz,yaw "
             "and does not remember its commands");
  return true;
}

/// The first option that came and belongs to the ideal plant alone; empty: none.
std::string option_of_ideal(const CommandLine& line, bool matrix) {
  for (const std::string name : kIdealOptions)
    if (line.was_given(name) && !(matrix && (name == "--convention" || name == "--inputs")))
      return name;
  return "";
}

}  // namespace

PlantChoice choose_plant(const CommandLine& line, const std::string& plant,
                         const std::string& structure, const FlownLqrArguments& flown) {
  PlantChoice choice;
  choice.matrix = asks_for_matrix(structure, line);
  const std::string of_ideal = option_of_ideal(line, choice.matrix);
  choice.flown = plant.empty() ? of_ideal.empty() : asks_for_flown_plant(plant, "lqr");
  if (choice.flown && !of_ideal.empty())
    refuse(of_ideal,
           "belongs to --plant ideal, expected a hover in the words of ned with the wrench on the "
           "flown plant");
  if (!choice.flown && structure == "dynamic" && !of_ideal.empty())
    refuse(of_ideal, "came with --structure dynamic, expected --structure matrix or none");
  if (!choice.flown && !flown.given.empty())
    refuse(*flown.given.begin(), fmt::format("belongs to the flown plant, expected none with {}",
                                             plant.empty() ? of_ideal : "--plant ideal"));
  if (plant.empty()) choice.implied_by = of_ideal;
  return choice;
}

}  // namespace quadtune::cli
