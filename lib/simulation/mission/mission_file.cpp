// SPDX-License-Identifier: Apache-2.0
// Reads mission files; docs/formats.md describes the format.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "quadtune/errors.hpp"
#include "quadtune/internal/built_in.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/limit_reader.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/toml_reader.hpp"
#include "quadtune/model/rigid_body.hpp"
#include "quadtune/simulation/mission.hpp"
#include "simulation/loop/bounds.hpp"
#include "simulation/mission/script_csv.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;
using internal::Range;
using internal::TomlKey;
using internal::TomlTable;

// Data needed to read the remaining tables of a file.
struct Context {
  double duration;
  MissionStart start;
  std::filesystem::path folder;

  [[nodiscard]] Range times() const {
    return {0, Range::Bound::closed, duration, Range::Bound::closed};
  }
};

// Reads one of the listed words.
std::size_t read_choice(const TomlTable& table, const std::string& key,
                        const std::vector<std::string>& known) {
  const std::string word = table.text(key);
  const auto at = std::find(known.begin(), known.end(), word);
  if (at == known.end())
    throw InvalidInput(table.where(key),
                       fmt::format("{} in {} is '{}', expected '{}'{}", key, table.title(),
                                   internal::printable(word), internal::joined(known, "' or '"),
                                   internal::did_you_mean(word, known)));
  return static_cast<std::size_t>(at - known.begin());
}

// Reads north_m, east_m and height_m as north-east-down. Missing coordinates are taken from
// `fallback`, but the height may be required.
Vector3d read_place(const TomlTable& table, const Vector3d& fallback, bool needs_height) {
  Vector3d position;
  position.x() = table.number_or("north_m", fallback.x(), internal::kPlaces);
  position.y() = table.number_or("east_m", fallback.y(), internal::kPlaces);
  position.z() = needs_height || table.has("height_m")
                     ? -table.number("height_m", internal::kHeights)
                     : fallback.z();
  return position;
}

// Converts [north, east, height] of one row to north-east-down.
Vector3d point_of(const Eigen::VectorXd& row, const std::string& where, const std::string& what) {
  if (row.size() != 3)
    throw InvalidInput(where, fmt::format("{} has {} numbers, expected 3 (north, east, height)",
                                          what, row.size()));
  Vector3d position(row(0), row(1), -row(2));
  internal::require_place(position, where, what);
  return position;
}

struct NoseAndYaw {
  Nose nose;
  double yaw;
};
NoseAndYaw read_nose(const TomlTable& table, const Context& context) {
  NoseAndYaw read{Nose::fixed, context.start.yaw};
  if (table.has("nose"))
    read.nose = read_choice(table, "nose", {"fixed", "ahead"}) == 0 ? Nose::fixed : Nose::ahead;
  if (read.nose == Nose::ahead && table.has("yaw_rad"))
    throw InvalidInput(
        table.where("yaw_rad"),
        fmt::format("{} has both nose = 'ahead' and yaw_rad, expected one of them", table.title()));
  read.yaw = table.number_or("yaw_rad", read.yaw, internal::kAngles);
  return read;
}

Passage read_passage(const TomlTable& table, const Context& context) {
  Passage passage;
  passage.begin = table.number_or("begin_s", 0, context.times());
  passage.ramp = table.number_or("ramp_s", 1, internal::kDurations);
  const NoseAndYaw nose = read_nose(table, context);
  passage.nose = nose.nose;
  passage.yaw = nose.yaw;
  return passage;
}

std::vector<TomlKey> with_passage(std::vector<TomlKey> keys) {
  keys.insert(keys.end(), {{"begin", "s"}, {"ramp", "s"}, {"nose"}, {"yaw", "rad"}});
  return keys;
}

Hover read_hover(const TomlTable& table, const Context& context) {
  table.allow({{"north", "m"}, {"east", "m"}, {"height", "m"}, {"yaw", "rad"}});
  return {read_place(table, context.start.position, true),
          table.number_or("yaw_rad", context.start.yaw, internal::kAngles)};
}

Script read_references(const std::vector<TomlTable>& tables, const Context& context) {
  Script script;
  for (const TomlTable& table : tables) {
    table.allow({{"at", "s"},
                 {"ramp", "s"},
                 {"north", "m"},
                 {"east", "m"},
                 {"height", "m"},
                 {"yaw", "rad"}});
    const bool first = script.references.empty();
    TimedReference now;
    now.from = table.number("at_s", context.times());
    now.until = now.from + table.number_or("ramp_s", 0, internal::kTimes);
    if (first && now.until != 0)
      throw InvalidInput(table.where(now.from != 0 ? "at_s" : "ramp_s"),
                         fmt::format("{} in {} is {}, expected 0, because a flight needs a "
                                     "reference from its beginning",
                                     now.from != 0 ? "at_s" : "ramp_s", table.title(),
                                     now.from != 0 ? now.from : now.until));
    if (!first) {
      const TimedReference& before = script.references.back();
      if (now.from < before.until || now.until <= before.from)
        throw InvalidInput(
            table.where("at_s"),
            fmt::format("at_s in {} is {}, expected later because the previous reference "
                        "is complete at {} s",
                        table.title(), now.from, before.until));
      if (!table.has("north_m") && !table.has("east_m") && !table.has("height_m") &&
          !table.has("yaw_rad"))
        throw InvalidInput(table.where(), table.title() +
                                              " changes nothing, expected north_m, east_m, "
                                              "height_m or yaw_rad");
    }
    const Vector3d position = first ? context.start.position : script.references.back().position;
    const double yaw = first ? context.start.yaw : script.references.back().yaw;
    now.position = read_place(table, position, first);
    now.yaw = table.number_or("yaw_rad", yaw, internal::kAngles);
    script.references.push_back(now);
  }
  return script;
}

Script read_csv(const TomlTable& table, const Context& context) {
  table.allow({{"file"}, {"between"}});
  const std::filesystem::path folder = context.folder.empty() ? "." : context.folder;
  const std::string path = (folder / table.word("file")).string();  // never "-", standard input
  const bool hold = table.has("between") && read_choice(table, "between", {"ramp", "hold"}) == 1;
  const std::string text = [&] {
    try {
      return internal::read_text_file(path, kScriptFileLimit);
    } catch (const FileError& error) {
      throw InvalidInput(table.where("file"),
                         fmt::format("the references cannot be read ({}), expected a file next to "
                                     "the mission file",
                                     error.what()));
    }
  }();
  return internal::parse_script_csv(text, path, context.start,
                                    hold ? internal::Between::hold : internal::Between::ramp);
}

Waypoints read_waypoints(const TomlTable& table, const Context& context) {
  table.allow(
      {{"points", "m"}, {"look_ahead", "m"}, {"transition_radius", "m"}, {"nose"}, {"yaw", "rad"}});
  Waypoints way;
  const Eigen::MatrixXd points = table.matrix("points_m");
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const std::string where = table.where("points_m", static_cast<std::size_t>(i));
    way.points.push_back(point_of(points.row(i), where, fmt::format("waypoint {}", i + 1)));
    if (i > 0 && (way.points.back() - way.points[way.points.size() - 2]).norm() < internal::kMinWay)
      throw InvalidInput(where, fmt::format("waypoints {} and {} are the same point, expected "
                                            "points that differ because a segment has a direction",
                                            i, i + 1));
  }
  if (way.points.size() < 2)
    throw InvalidInput(table.where("points_m"),
                       "points_m in [waypoints] has 1 waypoint, expected "
                       "at least 2");
  way.look_ahead = table.number("look_ahead_m", internal::kSizes);
  way.transition_radius = table.number("transition_radius_m", internal::kSizes);
  const NoseAndYaw nose = read_nose(table, context);
  way.nose = nose.nose;
  way.yaw = nose.yaw;
  return way;
}

LinePath read_line(const TomlTable& table, const Context& context) {
  table.allow(with_passage({{"from", "m"}, {"to", "m"}, {"speed", "m_per_s"}}));
  LinePath line;
  line.from = point_of(table.vector("from_m"), table.where("from_m"), "from_m in [line]");
  line.to = point_of(table.vector("to_m"), table.where("to_m"), "to_m in [line]");
  line.speed = table.number("speed_m_per_s", internal::kSpeeds);
  line.passage = read_passage(table, context);
  return line;
}

CirclePath read_circle(const TomlTable& table, const Context& context) {
  table.allow(with_passage({{"north", "m"},
                            {"east", "m"},
                            {"height", "m"},
                            {"radius", "m"},
                            {"bearing", "rad"},
                            {"speed", "m_per_s"},
                            {"turns"}}));
  CirclePath circle;
  circle.center = read_place(table, context.start.position, true);
  circle.radius = table.number("radius_m", internal::kPlaces);
  if (circle.radius == 0)
    throw InvalidInput(table.where("radius_m"),
                       "radius_m in [circle] is 0, expected more than 0 (right turn) or less than "
                       "0 (left turn)");
  circle.bearing = table.number_or("bearing_rad", 0, internal::kAngles);
  circle.speed = table.number("speed_m_per_s", internal::kSpeeds);
  circle.turns = table.number_or("turns", 1, internal::kCounts);
  circle.passage = read_passage(table, context);
  return circle;
}

LemniscatePath read_lemniscate(const TomlTable& table, const Context& context) {
  table.allow(with_passage({{"north", "m"},
                            {"east", "m"},
                            {"height", "m"},
                            {"length", "m"},
                            {"width", "m"},
                            {"heading", "rad"},
                            {"lap", "s"},
                            {"laps"}}));
  LemniscatePath lemniscate;
  lemniscate.center = read_place(table, context.start.position, true);
  lemniscate.length = table.number("length_m", internal::kSizes);
  lemniscate.width = table.number_or("width_m", lemniscate.length / 2, internal::kSizes);
  lemniscate.heading = table.number_or("heading_rad", 0, internal::kAngles);
  lemniscate.lap = table.number("lap_s", internal::kDurations);
  lemniscate.laps = table.number_or("laps", 1, internal::kCounts);
  lemniscate.passage = read_passage(table, context);
  return lemniscate;
}

// Validates a path, so that the message names its line of the file.
template <class Path>
SmoothPath checked(const Path& path, const TomlTable& table) {
  validate(path, table.where());
  return path;
}

Keys read_keys(const TomlTable& table, const Context& context) {
  table.allow({{"north", "m"}, {"east", "m"}, {"height", "m"}, {"yaw", "rad"}, {"press"}});
  Keys keys;
  keys.position = read_place(table, context.start.position, true);
  keys.yaw = table.number_or("yaw_rad", context.start.yaw, internal::kAngles);
  for (const TomlTable& press : table.tables("press")) {
    press.allow({{"at", "s"}, {"key"}});
    const double time = press.number("at_s", context.times());
    const std::string key = press.text("key");
    if (key.size() != 1 || std::string_view(kMissionKeys).find(key) == std::string_view::npos)
      throw InvalidInput(
          press.where("key"),
          fmt::format("key in {} is '{}', expected one of {}", press.title(),
                      internal::printable(key), fmt::join(std::string_view(kMissionKeys), " ")));
    if (!keys.presses.empty() && time <= keys.presses.back().time)
      throw InvalidInput(press.where("at_s"),
                         fmt::format("at_s in {} is {}, expected more than {}, the time of the key "
                                     "before",
                                     press.title(), time, keys.presses.back().time));
    keys.presses.push_back({time, key.front()});
  }
  return keys;
}

std::vector<int> read_motor_numbers(const TomlTable& table) {
  std::vector<int> motors;
  const Eigen::VectorXd numbers = table.vector("motors");
  for (const double number : numbers) {
    if (number != std::floor(number) || number < 1 || number > kMaxRotors)
      throw InvalidInput(table.where("motors"),
                         fmt::format("motors in {} has {}, expected whole numbers from 1 to {}",
                                     table.title(), number, kMaxRotors));
    const int motor = static_cast<int>(number);
    if (std::find(motors.begin(), motors.end(), motor) != motors.end())
      throw InvalidInput(table.where("motors"), fmt::format("motors in {} has {} twice, expected "
                                                            "it once",
                                                            table.title(), motor));
    motors.push_back(motor);
  }
  if (motors.empty())
    throw InvalidInput(table.where("motors"),
                       fmt::format("motors in {} is empty, expected at least one", table.title()));
  return motors;
}

MotorTest read_motors(const std::vector<TomlTable>& tables, const Context& context) {
  MotorTest test;
  double free_from = 0;
  for (const TomlTable& table : tables) {
    table.allow({{"at", "s"}, {"for", "s"}, {"motors"}, {"share"}});
    MotorRun run;
    run.begin = table.number("at_s", context.times());
    if (run.begin < free_from)
      throw InvalidInput(table.where("at_s"),
                         fmt::format("at_s in {} is {}, expected {} or more, when the previous run "
                                     "has ended",
                                     table.title(), run.begin, free_from));
    run.duration = table.number("for_s", internal::kDurations);
    free_from = run.begin + run.duration;
    run.motors = read_motor_numbers(table);
    run.share = table.number("share", internal::kShares);
    test.runs.push_back(run);
  }
  return test;
}

/// @throws InvalidInput  if a key of the other kind of start is given
void refuse_keys_of_other_start(const TomlTable& table, bool in_air) {
  const std::vector<std::string> other =
      in_air ? std::vector<std::string>{"start_up_s", "take_off_s", "climb_rate_m_per_s"}
             : std::vector<std::string>{"height_m"};
  for (const std::string& key : other)
    if (table.has(key))
      throw InvalidInput(table.where(key),
                         fmt::format("{} in {} is for a start {}, expected at = \"{}\" or no {}",
                                     key, table.title(), in_air ? "on the ground" : "in the air",
                                     in_air ? "ground" : "air", key));
}

MissionStart read_start(const TomlTable& table) {
  MissionStart start;
  start.in_air = table.has("at") && read_choice(table, "at", {"ground", "air"}) == 1;
  refuse_keys_of_other_start(table, start.in_air);
  std::vector<TomlKey> keys = {{"at"}, {"north", "m"}, {"east", "m"}, {"yaw", "rad"}};
  if (start.in_air)
    keys.push_back({"height", "m"});
  else
    keys.insert(keys.end(), {{"start_up", "s"}, {"take_off", "s"}, {"climb_rate", "m_per_s"}});
  table.allow(keys);
  start.position = read_place(table, Vector3d::Zero(), false);
  if (start.in_air) start.position.z() = -table.number("height_m", internal::kSizes);
  start.yaw = table.number_or("yaw_rad", 0, internal::kAngles);
  start.start_up = table.number_or("start_up_s", start.start_up, internal::kTimes);
  if (table.has("take_off_s")) {
    if (table.has("climb_rate_m_per_s"))
      throw InvalidInput(table.where("climb_rate_m_per_s"),
                         "climb_rate_m_per_s and take_off_s are both given, expected one of them "
                         "because take_off_s selects constant thrust instead of a climb");
    start.take_off_by = TakeOff::thrust;
    start.take_off = table.number("take_off_s", internal::kTimes);
  }
  start.climb_rate = table.number_or("climb_rate_m_per_s", start.climb_rate, internal::kSpeeds);
  return start;
}

Landing read_landing(const TomlTable& table, const Context& context, double airborne) {
  table.allow({{"at", "s"}, {"rate", "m_per_s"}, {"off_height", "m"}});
  Landing landing;
  landing.begin = table.number("at_s", context.times());
  if (landing.begin < airborne)
    throw InvalidInput(table.where("at_s"),
                       fmt::format("at_s in [landing] is {}, expected {} or more, when the "
                                   "take-off has ended",
                                   landing.begin, airborne));
  landing.rate = table.number_or("rate_m_per_s", landing.rate, internal::kSpeeds);
  landing.off_height = table.number_or("off_height_m", landing.off_height, internal::kSizes);
  return landing;
}

SettlingRule read_settling(const TomlTable& table) {
  table.allow({{"band", "m"}, {"yaw_band", "rad"}, {"window", "s"}});
  SettlingRule rule;
  rule.band = table.number_or("band_m", rule.band, internal::kSizes);
  rule.yaw_band = table.number_or("yaw_band_rad", rule.yaw_band, internal::kSizes);
  rule.window = table.number_or("window_s", rule.window, internal::kTimes);
  return rule;
}

std::vector<Limit> read_limits(const TomlTable& table) {
  std::vector<TomlKey> keys;
  std::vector<Metric> metrics;
  for (std::size_t i = 0; i < kMetrics; ++i) {
    const auto metric = static_cast<Metric>(i);
    if (metric == Metric::duration) continue;  // fixed by the mission
    const std::string key = limit_key(metric);
    const std::size_t unit = key.rfind("_max") + 4;
    keys.push_back({key.substr(0, unit), unit < key.size() ? key.substr(unit + 1) : ""});
    metrics.push_back(metric);
  }
  table.allow(keys);
  std::vector<Limit> limits;
  for (const Metric metric : metrics) {
    const std::string key = limit_key(metric);
    if (table.has(key))
      limits.push_back({metric, internal::read_limit(table, metric, internal::kLimits)});
  }
  return limits;
}

// The keys of which a file must have exactly one.
const std::vector<std::string>& kind_names() {
  static const std::vector<std::string> names = {
      "hover", "references", "csv", "waypoints", "line", "circle", "lemniscate", "keys", "motors"};
  return names;
}

std::string kind_of(const TomlTable& file) {
  std::string kind;
  for (const std::string& name : kind_names()) {
    if (!file.has(name)) continue;
    if (!kind.empty())
      throw InvalidInput(
          file.where(name),
          fmt::format("the file has both '{}' and '{}', expected one of them", kind, name));
    kind = name;
  }
  if (kind.empty())
    throw InvalidInput(file.where(),
                       fmt::format("the file does not define a motion, expected one of {}",
                                   internal::joined(kind_names(), ", ")));
  return kind;
}

std::vector<TomlTable> read_some(const TomlTable& file, const std::string& key) {
  std::vector<TomlTable> tables = file.tables(key);
  if (tables.empty())
    throw InvalidInput(file.where(key), fmt::format("[[{}]] is empty, expected at least one", key));
  return tables;
}

MissionKind read_kind(const TomlTable& file, const std::string& kind, const Context& context) {
  if (kind == "references") return read_references(read_some(file, kind), context);
  if (kind == "motors") return read_motors(read_some(file, kind), context);
  const TomlTable table = file.table(kind);
  if (kind == "hover") return read_hover(table, context);
  if (kind == "csv") return read_csv(table, context);
  if (kind == "waypoints") return read_waypoints(table, context);
  if (kind == "keys") return read_keys(table, context);
  if (kind == "line") return checked(read_line(table, context), table);
  if (kind == "circle") return checked(read_circle(table, context), table);
  return checked(read_lemniscate(table, context), table);
}

// Reads an [[event]]: a motor fault or a change of payload.
FlightEvent read_event(const TomlTable& table) {
  table.allow({{"at", "s"}, {"motor"}, {"thrust_share"}, {"load", "kg"}});
  FlightEvent event;
  event.time = table.number("at_s", internal::kTimes);
  if (table.has("motor") == table.has("load_kg"))
    throw InvalidInput(
        table.where(),
        fmt::format("{} has {}, expected one of them", table.title(),
                    table.has("motor") ? "both motor and load_kg" : "neither motor nor load_kg"));
  if (table.has("load_kg")) {
    if (table.has("thrust_share"))
      throw InvalidInput(table.where("thrust_share"),
                         fmt::format("{} has thrust_share without motor, expected the motor that "
                                     "keeps this share of its thrust",
                                     table.title()));
    event.what = LoadChange{table.number("load_kg")};
    return event;
  }
  event.what =
      MotorFault{static_cast<int>(table.integer("motor", 1, kMaxRotors)),
                 table.number("thrust_share", {0, Range::Bound::closed, 1, Range::Bound::closed})};
  return event;
}

// Rejects tables that are meaningless if the vehicle does not fly.
void refuse_tables(const TomlTable& file, const std::vector<std::string>& names,
                   const std::string& why) {
  for (const std::string& name : names)
    if (file.has(name))
      throw InvalidInput(file.where(name),
                         fmt::format("[{}] is not allowed in a mission in which {}", name, why));
}

}  // namespace

Mission parse_mission(const std::string& text, const std::string& origin,
                      const std::filesystem::path& folder) {
  const TomlTable file = TomlTable::parse(text, origin, kMissionFileLimit);
  std::vector<TomlKey> keys = {{"name"},     {"description"}, {"duration", "s"},
                               {"start"},    {"carried"},     {"landing"},
                               {"settling"}, {"limits"},      {"event"}};
  for (const std::string& name : kind_names()) keys.push_back({name});
  file.allow(keys);
  Mission mission;
  mission.text = text;
  mission.name = file.word("name");
  mission.description = file.text_or("description", "");
  mission.duration = file.number("duration_s", internal::kDurations);
  const std::string kind = kind_of(file);
  const bool carried = file.has("carried") && file.truth("carried");
  if (carried) {
    if (kind != "line" && kind != "circle" && kind != "lemniscate")
      throw InvalidInput(file.where("carried"),
                         fmt::format("a vehicle is carried along '{}', expected line, circle or "
                                     "lemniscate",
                                     kind));
    refuse_tables(file, {"start", "landing", "event"}, "the vehicle is carried");
  }
  if (kind == "motors") refuse_tables(file, {"start", "landing"}, "motors run without a law");

  Context context{mission.duration, {}, folder};
  if (const auto table = file.maybe_table("start")) context.start = read_start(*table);
  mission.start = context.start;
  mission.kind = read_kind(file, kind, context);
  if (carried) mission.kind = Carried{std::get<SmoothPath>(mission.kind)};
  if (end_of_take_off(mission) >= mission.duration)
    throw InvalidInput(
        file.where("start"),
        fmt::format("start-up and take-off to {} m last {} s, expected less than "
                    "the mission's duration_s of {}",
                    first_height(mission), end_of_take_off(mission), mission.duration));
  if (const auto table = file.maybe_table("landing"))
    mission.landing = read_landing(*table, context, end_of_take_off(mission));
  for (const TomlTable& table : file.tables("event")) mission.events.push_back(read_event(table));
  if (const auto table = file.maybe_table("settling")) mission.settling = read_settling(*table);
  if (const auto table = file.maybe_table("limits")) mission.limits = read_limits(*table);
  validate(mission, file.where());
  return mission;
}

std::vector<std::string> built_in_missions() {
  std::vector<std::string> names;
  for (const internal::BuiltInFile& file : internal::built_in_mission_files())
    names.push_back(file.name);
  return names;
}

Mission load_mission(const std::string& name_or_path) {
  for (const internal::BuiltInFile& file : internal::built_in_mission_files())
    if (file.name == name_or_path) return parse_mission(file.text, file.path);
  if (!internal::looks_like_path(name_or_path)) {
    const std::vector<std::string> known = built_in_missions();
    // Other programs name this path after its shape.
    const bool eight = name_or_path.starts_with("figure") || name_or_path.starts_with("eight");
    throw InvalidInput("mission",
                       fmt::format("no mission '{}', expected {} or a mission file{}",
                                   internal::printable(name_or_path), internal::joined(known, ", "),
                                   eight ? "; did you mean 'lemniscate'?"
                                         : internal::did_you_mean(name_or_path, known)));
  }
  Mission mission = parse_mission(internal::read_text_file(name_or_path, kMissionFileLimit),
                                  name_or_path, std::filesystem::path(name_or_path).parent_path());
  mission.file = name_or_path;
  return mission;
}

}  // namespace quadtune
