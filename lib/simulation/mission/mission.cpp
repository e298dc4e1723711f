// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/mission.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/model/rigid_body.hpp"
#include "simulation/loop/bounds.hpp"
#include "simulation/mission/climb.hpp"

namespace quadtune {
namespace {

using internal::require_place;
using internal::require_within;

[[noreturn]] void refuse(const std::string& where, const std::string& message) {
  throw InvalidInput(where, message);
}

void check(const Hover& hover, const std::string& where) {
  require_place(hover.position, where, "the hover");
  require_within(hover.yaw, internal::kAngles, where, "yaw of the hover", "rad");
}

void check(const Script& script, const std::string& where) {
  if (script.references.empty()) refuse(where, "there are no references, expected at least one");
  const TimedReference* before = nullptr;
  int number = 0;
  for (const TimedReference& now : script.references) {
    const std::string what = fmt::format("reference {}", ++number);
    require_place(now.position, where, what);
    require_within(now.yaw, internal::kAngles, where, "yaw of " + what, "rad");
    require_within(now.from, internal::kTimes, where, "time of " + what, "s");
    require_within(now.until, internal::kTimes, where, "end of " + what, "s");
    if (now.until < now.from)
      refuse(where, fmt::format("{} ends at {} s and begins at {} s, expected a ramp that is not "
                                "negative",
                                what, now.until, now.from));
    if (before == nullptr && now.until != 0)
      refuse(where,
             fmt::format("{} is complete at {} s, expected 0 because a flight needs a reference "
                         "from its beginning",
                         what, now.until));
    // A ramp may begin at the time of the preceding step, but two steps at one time are rejected,
    // since the first would have no effect.
    if (before != nullptr && (now.from < before->until || now.until <= before->from))
      refuse(where,
             fmt::format("{} begins at {} s, expected later because the previous one is complete "
                         "at {} s",
                         what, now.from, before->until));
    before = &now;
  }
}

void check(const Waypoints& way, const std::string& where) {
  if (way.points.size() < 2)
    refuse(where, fmt::format("the mission has {}, expected at least 2",
                              internal::counted(way.points.size(), "waypoint")));
  require_within(way.look_ahead, internal::kSizes, where, "look-ahead distance", "m");
  require_within(way.transition_radius, internal::kSizes, where, "transition radius", "m");
  require_within(way.yaw, internal::kAngles, where, "yaw", "rad");
  for (std::size_t i = 0; i < way.points.size(); ++i) {
    require_place(way.points[i], where, fmt::format("waypoint {}", i + 1));
    if (i > 0 && (way.points[i] - way.points[i - 1]).norm() < internal::kMinWay)
      refuse(where, fmt::format("waypoints {} and {} are the same point, expected points that "
                                "differ because a segment has a direction",
                                i, i + 1));
  }
}

void check(const SmoothPath& path, const std::string& where) { validate(path, where); }
void check(const Carried& carried, const std::string& where) { validate(carried.path, where); }

void check(const Keys& keys, const std::string& where) {
  require_place(keys.position, where, "the first set point");
  require_within(keys.yaw, internal::kAngles, where, "yaw of the first set point", "rad");
  const KeyPress* before = nullptr;
  for (const KeyPress& press : keys.presses) {
    require_within(press.time, internal::kTimes, where, "time of a key press", "s");
    if (press.key == 0 || std::string_view(kMissionKeys).find(press.key) == std::string_view::npos)
      refuse(where, fmt::format("no key '{}', expected one of {}",
                                internal::printable(std::string_view(&press.key, 1)),
                                fmt::join(std::string_view(kMissionKeys), " ")));
    if (before != nullptr && press.time <= before->time)
      refuse(where,
             fmt::format("key '{}' is pressed at {} s, expected later than the previous key '{}', "
                         "at {} s",
                         press.key, press.time, before->key, before->time));
    before = &press;
  }
}

void check(const MotorTest& test, const std::string& where) {
  if (test.runs.empty()) refuse(where, "no motor runs, expected at least one");
  double free_from = 0;
  for (const MotorRun& run : test.runs) {
    require_within(run.begin, internal::kTimes, where, "begin of a motor's run", "s");
    require_within(run.duration, internal::kDurations, where, "duration of a motor's run", "s");
    require_within(run.share, internal::kShares, where, "share of a motor's command", "");
    if (run.begin < free_from)
      refuse(where,
             fmt::format("motors run from {} s, expected {} s or later, when the previous run "
                         "has ended",
                         run.begin, free_from));
    free_from = run.begin + run.duration;
    if (run.motors.empty()) refuse(where, "a run has no motors, expected at least one");
    std::set<int> seen;
    for (const int motor : run.motors) {
      if (motor < 1 || motor > kMaxRotors)
        refuse(where, fmt::format("no motor {}, expected 1 to {}", motor, kMaxRotors));
      if (!seen.insert(motor).second)
        refuse(where, fmt::format("motor {} is named twice in a run, expected once", motor));
    }
  }
}

void check(const MissionStart& start, const std::string& where) {
  require_place(start.position, where, "the start");
  require_within(start.yaw, internal::kAngles, where, "yaw of the start", "rad");
  require_within(start.start_up, internal::kTimes, where, "time of start-up", "s");
  require_within(start.take_off, internal::kTimes, where, "time of take-off", "s");
  require_within(start.climb_rate, internal::kSpeeds, where, "climb rate of the start", "m/s");
  const double height = 0 - start.position.z();  // never -0
  if (start.in_air != (height > 0))
    refuse(where, fmt::format("the start is {} at a height of {} m, expected {}",
                              start.in_air ? "in the air" : "on the ground", height,
                              start.in_air ? "more than 0" : "0"));
}

void check(const Landing& landing, double airborne, const std::string& where) {
  require_within(landing.begin, internal::kTimes, where, "begin of the landing", "s");
  require_within(landing.rate, internal::kSpeeds, where, "rate of the landing", "m/s");
  require_within(landing.off_height, internal::kSizes, where, "off height of the landing", "m");
  if (landing.begin < airborne)
    refuse(where, fmt::format("the landing begins at {} s, expected no earlier than {} s, when the "
                              "take-off ends",
                              landing.begin, airborne));
}

void check(const SettlingRule& rule, const std::string& where) {
  require_within(rule.band, internal::kSizes, where, "settling band", "m");
  require_within(rule.yaw_band, internal::kSizes, where, "settling band of the yaw", "rad");
  require_within(rule.window, internal::kTimes, where, "settling window", "s");
  require_within(rule.settled_band, internal::kLimits, where, "settled band", "m");
  require_within(rule.settled_yaw_band, internal::kLimits, where, "settled band of the yaw", "rad");
}

void check(const std::vector<Limit>& limits, const std::string& where) {
  std::set<Metric> seen;
  for (const Limit& limit : limits) {
    const auto index = static_cast<std::size_t>(limit.metric);
    if (index >= kMetrics || limit.metric == Metric::duration)
      refuse(where, "a limit is for an unknown metric or the duration, expected another metric");
    require_within(limit.max, internal::kLimits, where, "limit of " + name_of(limit.metric),
                   unit_of(limit.metric));
    if (!seen.insert(limit.metric).second)
      refuse(where, fmt::format("{} is limited twice, expected once", name_of(limit.metric)));
  }
}

}  // namespace

double first_height(const Mission& mission) {
  struct First {
    double operator()(const Hover& hover) const { return hover.position.z(); }
    double operator()(const Script& script) const {
      return script.references.empty() ? 0 : script.references.front().position.z();
    }
    double operator()(const Waypoints& waypoints) const {
      return waypoints.points.empty() ? 0 : waypoints.points.front().z();
    }
    double operator()(const SmoothPath& path) const { return path_point(path, 0).position.z(); }
    double operator()(const Keys& keys) const { return keys.position.z(); }
    double operator()(const MotorTest&) const { return 0; }
    double operator()(const Carried&) const { return 0; }
  };
  return 0 - std::visit(First(), mission.kind);
}

double end_of_take_off(const Mission& mission) {
  const MissionStart& start = mission.start;
  if (start.in_air || std::holds_alternative<Carried>(mission.kind) ||
      std::holds_alternative<MotorTest>(mission.kind))
    return 0;
  return start.start_up + (start.take_off_by == TakeOff::climb
                               ? climb_duration(first_height(mission), start.climb_rate)
                               : start.take_off);
}

Mission with_thrust_take_off(Mission mission) {
  mission.start.take_off_by = TakeOff::thrust;
  mission.start.take_off = 1;
  // The constant thrust determines the height of the take-off, so a limit of the height does not
  // apply.
  std::erase_if(mission.limits,
                [](const Limit& limit) { return limit.metric == Metric::height_peak; });
  return mission;
}

void validate(const Mission& mission, const std::string& where) {
  require_within(mission.duration, internal::kDurations, where, "duration", "s");
  check(mission.start, where);
  std::visit([&](const auto& kind) { check(kind, where); }, mission.kind);
  if (mission.landing) {
    if (std::holds_alternative<MotorTest>(mission.kind) ||
        std::holds_alternative<Carried>(mission.kind))
      refuse(where, "a mission that does not fly has a landing, expected none");
    check(*mission.landing, end_of_take_off(mission), where);
  }
  if (std::holds_alternative<MotorTest>(mission.kind) && mission.start.in_air)
    refuse(where, "a motor test starts in the air, expected on the ground");
  validate(mission.events, mission.duration, where);
  if (!mission.events.empty() && std::holds_alternative<Carried>(mission.kind))
    refuse(where, "a carried vehicle has events, expected none because its motion is prescribed");
  check(mission.settling, where);
  check(mission.limits, where);
}

void require_motors(const Mission& mission, int rotors, const std::string& where) {
  const auto* test = std::get_if<MotorTest>(&mission.kind);
  if (test == nullptr) return;
  for (const MotorRun& run : test->runs)
    for (const int motor : run.motors)
      if (motor > rotors)
        refuse(where,
               fmt::format("mission '{}' runs motor {}, expected 1 to {} because the vehicle has "
                           "no more",
                           mission.name, motor, rotors));
}

}  // namespace quadtune
