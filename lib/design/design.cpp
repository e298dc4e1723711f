// SPDX-License-Identifier: Apache-2.0
// Reads design files, whose format is documented in docs/formats.md.
#include "quadtune/design.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "design/cascade_table.hpp"
#include "design/export_tables.hpp"
#include "design/kalman_table.hpp"
#include "design/lqr_table.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/toml_reader.hpp"

namespace quadtune {
namespace {

using internal::Range;
using internal::TomlKey;
using internal::TomlTable;

FlightCondition read_trim(const TomlTable& table) {
  FlightCondition condition;
  condition.kind = flight_kind(table.text("at"), table.where("at"));
  const bool moves = condition.kind == FlightKind::line || condition.kind == FlightKind::circle;
  std::vector<TomlKey> keys = {{"at"}, {"yaw", "rad"}};
  if (moves) keys.push_back({"speed", "m_per_s"});
  if (condition.kind != FlightKind::hover) keys.push_back({"climb", "m_per_s"});
  if (condition.kind == FlightKind::circle) keys.push_back({"radius", "m"});
  if (condition.kind == FlightKind::spin) keys.push_back({"yaw_rate", "rad_per_s"});
  table.allow(keys);
  condition.yaw = table.number_or("yaw_rad", 0);
  condition.speed = table.number_or("speed_m_per_s", 0, Range::not_negative());
  condition.climb = table.number_or("climb_m_per_s", 0);
  if (condition.kind == FlightKind::circle) {
    condition.speed = table.number("speed_m_per_s", Range::positive());
    condition.radius = table.number("radius_m");
    if (condition.radius == 0)
      throw InvalidInput(table.where("radius_m"),
                         "trim.radius_m is 0, expected a positive radius (right "
                         "turn) or a negative one (left turn)");
  }
  if (condition.kind == FlightKind::spin) {
    condition.yaw_rate = table.number("yaw_rate_rad_per_s");
    if (condition.yaw_rate == 0)
      throw InvalidInput(table.where("yaw_rate_rad_per_s"),
                         "trim.yaw_rate_rad_per_s is 0, expected a positive rate (right turn) or a "
                         "negative one (left turn)");
  }
  return condition;
}

Vehicle read_vehicle(const TomlTable& file, const std::filesystem::path& folder) {
  const std::string word = file.text("vehicle");
  const std::vector<std::string> known = built_in_vehicles();
  if (std::find(known.begin(), known.end(), word) != known.end()) return load_vehicle(word);
  const std::filesystem::path path = folder / word;
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) {
    // A word without a slash could be interpreted as a built-in name.
    return load_vehicle(path.has_parent_path() ? path.string() : "./" + path.string());
  }
  throw InvalidInput(file.where("vehicle"),
                     fmt::format("no vehicle '{}' and no such file, expected {} or a vehicle file "
                                 "in the design's folder{}",
                                 internal::printable(word), internal::joined(known, ", "),
                                 internal::did_you_mean(word, known)));
}

MissionRequest read_mission_request(const TomlTable& table, const Design& design,
                                    const std::filesystem::path& folder) {
  table.allow({{"name"}, {"controller"}, {"estimator"}, {"sensors"}, {"flow"}, {"wind"}});
  MissionRequest request;
  request.where = table.where();
  request.mission = table.text("name");
  if (request.mission.ends_with(".toml") && !folder.empty())
    request.mission = (folder / request.mission).string();
  request.controller =
      table.text_or("controller", design.cascade ? "cascaded-pid" : "state-feedback");
  const std::vector<std::string> known = {"cascaded-pid", "state-feedback"};
  if (request.controller != known[0] && request.controller != known[1])
    throw InvalidInput(table.where("controller"),
                       fmt::format("controller in {} is '{}', expected cascaded-pid or "
                                   "state-feedback{}",
                                   table.title(), internal::printable(request.controller),
                                   internal::did_you_mean(request.controller, known)));
  const bool cascade = request.controller == known[0];
  if (cascade ? !design.cascade : !has_feedback(design))
    throw InvalidInput(
        table.where("controller"),
        fmt::format("{} flies {}, but the file has no {}, expected the law that the "
                    "mission tests",
                    table.title(), request.controller, cascade ? "[cascade]" : "[lqr]"));
  request.estimator = table.text_or("estimator", "");
  request.sensors = table.text_or("sensors", request.sensors);
  request.flow = table.text_or("flow", request.flow);
  request.wind = table.text_or("wind", request.wind);
  return request;
}

}  // namespace

Design parse_design(const std::string& text, const std::string& origin,
                    const std::filesystem::path& folder) {
  const TomlTable file = TomlTable::parse(text, origin);
  file.allow({{"name"},
              {"description"},
              {"vehicle"},
              {"trim"},
              {"lqr"},
              {"kalman"},
              {"estimator"},
              {"cascade"},
              {"mission"},
              {"export"},
              {"published"}});
  Design design;
  design.text = text;
  design.name = file.word("name");
  design.description = file.text_or("description", "");
  design.vehicle = read_vehicle(file, folder);
  if (const auto table = file.maybe_table("trim")) design.condition = read_trim(*table);
  if (const auto table = file.maybe_table("lqr")) {
    if (!internal::on_flown_plant(*table))
      design.lqr = internal::read_lqr(*table, design.vehicle, folder);
    else if (design.condition.kind != FlightKind::hover)
      throw InvalidInput(
          table->where("plant"),
          fmt::format("lqr.plant is 'flown' in a design whose trim is a {}, expected "
                      "a hover",
                      to_string(design.condition.kind)));
    else if (design.condition.yaw != 0)
      throw InvalidInput(
          table->where("plant"),
          fmt::format("lqr.plant is 'flown' in a design whose trim has the yaw {} rad, expected 0 "
                      "because the flown plant hovers with the nose to the north",
                      design.condition.yaw));
    else
      design.lqi = internal::read_lqi(*table, folder);
  }
  for (const TomlTable& table : file.tables("kalman")) {
    design.kalman.push_back(internal::read_kalman(table, folder));
    for (std::size_t i = 0; i + 1 < design.kalman.size(); ++i)
      if (design.kalman[i].name == design.kalman.back().name)
        throw InvalidInput(table.where("name"),
                           fmt::format("filter '{}' is defined twice, expected "
                                       "unique names",
                                       design.kalman[i].name));
  }
  if (const auto table = file.maybe_table("estimator"))
    design.estimator = internal::read_estimator(*table, folder, design.vehicle);
  if (const auto table = file.maybe_table("cascade"))
    design.cascade = internal::read_cascade(*table);
  if (!has_feedback(design) && design.kalman.empty() && !design.cascade)
    throw InvalidInput(file.where(),
                       "the file requests no design, expected [lqr], [[kalman]] or "
                       "[cascade]");
  if (const auto table = file.maybe_table("published"))
    design.published = internal::read_published(*table, design.lqr);
  for (const TomlTable& table : file.tables("mission"))
    design.missions.push_back(read_mission_request(table, design, folder));
  design.exports = internal::read_exports(file, design);
  return design;
}

Design load_design(const std::filesystem::path& path) {
  Design design = parse_design(internal::read_text_file(path.string(), internal::kTomlLimit),
                               path.string(), path.parent_path());
  design.file = path;
  return design;
}

}  // namespace quadtune
