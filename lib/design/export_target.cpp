// SPDX-License-Identifier: Apache-2.0
#include "quadtune/design/export_target.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "quadtune/design/flight_code_options.hpp"
#include "quadtune/design/flight_code_words.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {
namespace {

// C99 keywords, names of other files of an export, and names whose header would be mistaken for one
// of the C library.
constexpr std::array kTakenNames = {"auto",
                                    "break",
                                    "case",
                                    "char",
                                    "const",
                                    "double",
                                    "else",
                                    "enum",
                                    "extern",
                                    "float",
                                    "for",
                                    "goto",
                                    "if",
                                    "inline",
                                    "int",
                                    "long",
                                    "main",
                                    "register",
                                    "return",
                                    "short",
                                    "signed",
                                    "sizeof",
                                    "static",
                                    "struct",
                                    "switch",
                                    "typedef",
                                    "union",
                                    "unsigned",
                                    "void",
                                    "volatile",
                                    "while",
                                    "bool",
                                    "true",
                                    "false",
                                    "replay",
                                    "string",
                                    "m",
                                    "assert",
                                    "complex",
                                    "ctype",
                                    "errno",
                                    "fenv",
                                    "inttypes",
                                    "iso646",
                                    "limits",
                                    "locale",
                                    "math",
                                    "setjmp",
                                    "signal",
                                    "stdarg",
                                    "stdbool",
                                    "stddef",
                                    "stdint",
                                    "stdio",
                                    "stdlib",
                                    "tgmath",
                                    "time",
                                    "wchar",
                                    "wctype",
                                    "adapter",
                                    "replay_lines",
                                    "adapter_main",
                                    "adapter_mambo",
                                    "adapter_crazyflie",
                                    "adapter_px4"};

std::vector<ExportTarget>& targets() {
  const auto firmware = [](const char* name) {
    return ExportTarget{.name = name, .is_firmware = true};
  };
  static std::vector<ExportTarget> all = {
      {.name = "uquad", .needs_gains = true, .estimator = "uquad"},
      {.name = "mambo", .estimator = "mambo"},
      {.name = "json", .takes_memory = true},
      {.name = "mat", .takes_memory = true},
      {.name = "c", .takes_memory = true},
      firmware("px4"),
      firmware("ardupilot"),
      firmware("betaflight"),
      firmware("crazyflie")};
  return all;
}

auto find(const std::string& name) {
  return std::find_if(targets().begin(), targets().end(),
                      [&](const ExportTarget& target) { return target.name == name; });
}

}  // namespace

const std::vector<ExportTarget>& export_targets() { return targets(); }

void add_export_target(ExportTarget target) {
  const auto known = find(target.name);
  if (known == targets().end())
    targets().push_back(std::move(target));
  else
    *known = std::move(target);
}

const ExportTarget& export_target(const std::string& name, const std::string& where) {
  const auto found = find(name);
  if (found != targets().end()) return *found;
  std::vector<std::string> known;
  known.reserve(targets().size());
  for (const ExportTarget& target : targets()) known.push_back(target.name);
  throw InvalidInput(
      where, fmt::format("no export to '{}', expected {}{}", internal::printable(name),
                         internal::joined(known, ", "), internal::did_you_mean(name, known)));
}

void require_flight_code_name(const std::string& name, const std::string& where) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  if (!name.empty() && name.size() <= kMaxFlightCodeName && name[0] >= 'a' && name[0] <= 'z' &&
      std::all_of(name.begin(), name.end(), allowed) &&
      std::find(kTakenNames.begin(), kTakenNames.end(), name) == kTakenNames.end())
    return;
  throw InvalidInput(
      where, fmt::format("'{}' cannot be the prefix of names in C, expected 1 to {} lower-case "
                         "letters, digits and _, starting with a letter, and neither a C keyword "
                         "nor the name of a C library header",
                         internal::printable(name), kMaxFlightCodeName));
}

void require_flight_code_law(const std::string& law, const std::string& where) {
  if (law != "cascaded-pid" && law != "state-feedback")
    throw InvalidInput(where, fmt::format("no law '{}', expected cascaded-pid or state-feedback",
                                          internal::printable(law)));
}

const std::vector<std::string>& flight_code_adapters() {
  static const std::vector<std::string> all = {"main", "mambo", "crazyflie", "px4"};
  return all;
}

void require_flight_code_adapter(const std::string& adapter, const std::string& where) {
  const std::vector<std::string>& all = flight_code_adapters();
  if (std::find(all.begin(), all.end(), adapter) == all.end())
    throw InvalidInput(
        where, fmt::format("no adapter '{}', expected {}{}", internal::printable(adapter),
                           internal::joined(all, ", "), internal::did_you_mean(adapter, all)));
}

bool is_double_precision(const std::string& name, const std::string& where) {
  if (name == "float" || name == "double") return name == "double";
  throw InvalidInput(
      where, fmt::format("no precision '{}', expected float or double", internal::printable(name)));
}

}  // namespace quadtune
