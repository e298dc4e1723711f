// SPDX-License-Identifier: Apache-2.0
#include "quadtune/export_target.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/flight_code_options.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {
namespace {

std::vector<ExportTarget>& targets() {
  static std::vector<ExportTarget> all = {{"uquad", false, true, "uquad"},
                                          {"mambo", false, false, "mambo"},
                                          {"json", true, false},
                                          {"c", true, false}};
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

bool is_double_precision(const std::string& name, const std::string& where) {
  if (name == "float" || name == "double") return name == "double";
  throw InvalidInput(
      where, fmt::format("no precision '{}', expected float or double", internal::printable(name)));
}

}  // namespace quadtune
