// SPDX-License-Identifier: Apache-2.0
/// A mission in numbers: where a vehicle starts, what it is asked to do, and by which limits the
/// flight is judged. mission_runner.hpp turns it into references.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "quadtune/simulation/flight_event.hpp"
#include "quadtune/simulation/metric.hpp"
#include "quadtune/simulation/smooth_path.hpp"

namespace quadtune {

/// How a flight leaves the ground.
enum class TakeOff {
  climb,   ///< the law follows a reference that climbs to the mission's first height: climb_at()
  thrust,  ///< constant thrust (1 + takeoff_gain) m g, attitude held, as the Mambo's program
};

/// Where and how a flight begins.
struct MissionStart {
  bool in_air = false;  ///< at trim, the law has the motors at once; else at rest on the ground
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< world north-east-down [m]
  double yaw = 0;                                      ///< [rad]
  double start_up = 0.5;  ///< on the ground: the motors run up to their least speed [s], ≥ 0
  TakeOff take_off_by = TakeOff::climb;  ///< what follows
  double climb_rate = 1;                 ///< of TakeOff::climb, greatest speed [m/s], > 0
  double take_off = 1;                   ///< of TakeOff::thrust, how long [s], ≥ 0

  friend bool operator==(const MissionStart&, const MissionStart&) = default;
};

/// One place and yaw for the whole flight.
struct Hover {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< world [m]
  double yaw = 0;                                      ///< [rad]

  friend bool operator==(const Hover&, const Hover&) = default;
};

/// A change of the reference: along a straight line from what it was to what is said here.
struct TimedReference {
  double from = 0;   ///< when it begins [s]
  double until = 0;  ///< when it is complete [s]; `from` is a step
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< world [m]
  double yaw = 0;                                      ///< [rad], unwrapped

  friend bool operator==(const TimedReference&, const TimedReference&) = default;
};

/// Timed references, the first a step at time 0, each complete before the next begins.
struct Script {
  std::vector<TimedReference> references;

  friend bool operator==(const Script&, const Script&) = default;
};

/// Points to fly to one after the other: follow_waypoints() says how.
struct Waypoints {
  std::vector<Eigen::Vector3d> points;  ///< world [m], at least 2, neighbours differ
  double look_ahead = 0;                ///< of the reference along the segment [m], > 0
  double transition_radius = 0;         ///< at which a waypoint is reached [m], > 0
  Nose nose = Nose::fixed;              ///< ahead: along the segment
  double yaw = 0;                       ///< of a fixed nose [rad]

  friend bool operator==(const Waypoints&, const Waypoints&) = default;
};

/// One key press.
struct KeyPress {
  double time = 0;  ///< [s]
  char key = 0;     ///< of kMissionKeys

  friend bool operator==(const KeyPress&, const KeyPress&) = default;
};

/// What the keys of a pilot do, those of the Mambo's model project and, as far as they change a set
/// point, of the uquad program's manual mode: d and a roll by ±0.05 rad, w and s pitch by ±0.05 rad
/// (both: attitude instead of position from then on), j and l yaw by ±0.2 rad, i and k height by
/// ±0.2 m, y and h height by ±0.6 m, r home, e abort.
inline constexpr char kMissionKeys[] = "dawsjlikyhre";

/// A pilot at the keyboard: each press changes the set point. Home is over the world's origin at
/// the height and yaw from before the first press, with position held again. No key goes below the
/// ground.
struct Keys {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< before the first press [m]
  double yaw = 0;                                      ///< likewise [rad]
  std::vector<KeyPress> presses;                       ///< times increase

  friend bool operator==(const Keys&, const Keys&) = default;
};

/// Motors that turn on their own for a while.
struct MotorRun {
  double begin = 0;         ///< [s]
  double duration = 0;      ///< [s], > 0
  std::vector<int> motors;  ///< 1 is the first
  double share = 0;         ///< of the command: 0 the least, 1 the greatest

  friend bool operator==(const MotorRun&, const MotorRun&) = default;
};

/// Motors one after the other, the vehicle on the ground and no law at work.
struct MotorTest {
  std::vector<MotorRun> runs;  ///< at least one; each begins after the one before has ended

  friend bool operator==(const MotorTest&, const MotorTest&) = default;
};

/// A vehicle that something carries along a path, level, its motors off: CarriedMotion tells how.
struct Carried {
  SmoothPath path;

  friend bool operator==(const Carried&, const Carried&) = default;
};

/// A SmoothPath is one that the vehicle flies.
using MissionKind = std::variant<Hover, Script, Waypoints, SmoothPath, Keys, MotorTest, Carried>;

/// The end of a flight: down at a constant rate, and motors off on the ground.
struct Landing {
  double begin = 0;          ///< [s]
  double rate = 0.3;         ///< downward [m/s], > 0
  double off_height = 0.05;  ///< believed height at or below which a stop is the ground [m], > 0

  friend bool operator==(const Landing&, const Landing&) = default;
};

/// Everything that is known of a mission.
struct Mission {
  std::string name;
  std::string description;
  double duration = 0;  ///< [s], > 0
  MissionStart start;   ///< of no account where the vehicle is carried
  MissionKind kind;
  std::optional<Landing> landing;
  std::vector<FlightEvent> events;  ///< times do not decrease; none where the vehicle is carried
  SettlingRule settling;
  std::vector<Limit> limits;   ///< each metric at most once
  std::filesystem::path file;  ///< it was read from; empty when made in memory or built in
  std::string text;            ///< the file's bytes, for the manifest's hash

  friend bool operator==(const Mission&, const Mission&) = default;
};

/// The height above the ground of the mission's first reference [m].
[[nodiscard]] double first_height(const Mission& mission);

/// When the take-off has ended [s]; 0 for a flight that starts in the air or is carried.
[[nodiscard]] double end_of_take_off(const Mission& mission);

/// The mission as the Mambo's model project begins it: a second of constant thrust, open loop.
[[nodiscard]] Mission with_thrust_take_off(Mission mission);

/// Checks everything that a mission must satisfy: times in order and within the duration, places
/// not below the ground, waypoints that differ, known keys, limits that are not negative.
/// @throws InvalidInput  naming the field, what came and what was expected.
void validate(const Mission& mission, const std::string& where);

/// Checks that a mission's motors are among those of a vehicle.
/// @param rotors  how many the vehicle has.
/// @throws InvalidInput  naming the motor.
void require_motors(const Mission& mission, int rotors, const std::string& where);

/// Largest mission file that is read [bytes], and largest file of references that one names.
inline constexpr std::size_t kMissionFileLimit = std::size_t{1} << 20;
inline constexpr std::size_t kScriptFileLimit = std::size_t{16} << 20;

/// Reads a built-in mission by name or a mission file by path (docs/formats.md). A word with a
/// slash or that ends in ".toml" is a path, and so is any other that names no built-in mission but
/// a file.
/// @throws InvalidInput  "file:line: key …" for a bad file, or the nearest built-in name.
/// @throws FileError     if the mission file cannot be read.
[[nodiscard]] Mission load_mission(const std::string& name_or_path);

/// Parses a mission from the text of a file.
/// @param origin  what messages call the file.
/// @param folder  where a file of references that the mission names lies.
/// @throws        as load_mission().
[[nodiscard]] Mission parse_mission(const std::string& text, const std::string& origin,
                                    const std::filesystem::path& folder = {});

/// Names of the built-in missions, in the order of the documentation.
[[nodiscard]] std::vector<std::string> built_in_missions();

/// Holds a flight against its mission's limits, and asks that it was flown to the end: the first
/// check is that `duration` is within 0.1 s of the mission's. A figure that is NaN passes nothing.
[[nodiscard]] Verdict judge(const Mission& mission, const MetricValues& values);

}  // namespace quadtune
