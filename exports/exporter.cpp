// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/exporter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "built_in_exporters.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"

namespace quadtune {
namespace {

std::vector<Exporter>& all() {
  static std::vector<Exporter> exporters = [] {
    std::vector<Exporter> own = {exports::uquad_exporter(), exports::mambo_exporter(),
                                 exports::json_exporter(), exports::mat_exporter(),
                                 exports::flight_code_exporter()};
    for (Exporter& firmware : exports::firmware_exporters()) own.push_back(std::move(firmware));
    return own;
  }();
  return exporters;
}

auto find(const std::string& name) {
  return std::find_if(all().begin(), all().end(),
                      [&](const Exporter& exporter) { return exporter.target.name == name; });
}

}  // namespace

const std::vector<Exporter>& exporters() { return all(); }

void add_exporter(Exporter exporter) {
  add_export_target(exporter.target);
  const auto known = find(exporter.target.name);
  if (known == all().end())
    all().push_back(std::move(exporter));
  else
    *known = std::move(exporter);
}

std::string to_string(const ExportKind& kind) { return kind.name(); }

ExportKind export_kind(const std::string& name, const std::string& where) {
  if (find(name) != all().end()) return ExportKind(name);
  std::vector<std::string> known;
  known.reserve(all().size());
  for (const Exporter& exporter : all()) known.push_back(exporter.target.name);
  throw InvalidInput(
      where, fmt::format("no export '{}', expected {}{}", name, internal::joined(known, ", "),
                         internal::did_you_mean(name, known)));
}

const Exporter& exporter_of(const ExportKind& kind, const std::string& where) {
  return *find(export_kind(kind.name(), where).name());
}

}  // namespace quadtune
