// SPDX-License-Identifier: Apache-2.0
/// Definition of a mission: start, set points over time, and the limits by which the flight is
/// judged. mission_runner.hpp computes the references.
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

/// Take-off method.
enum class TakeOff {
  /// The law follows a reference that climbs to the first height of the mission: climb_at()
  climb,
  thrust,  ///< constant thrust (1 + takeoff_gain) m g with attitude hold, as in the Mambo's program
};

/// Start of a flight.
struct MissionStart {
  /// true: at trim, with the law active at once; false: at rest on the ground
  bool in_air = false;
  /// World north-east-down [m]; z < 0 if the flight starts in the air, else 0.
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double yaw = 0;  ///< [rad]
  /// On the ground: time in which the motors run up to their minimum speed [s], ≥ 0
  double start_up = 0.5;
  TakeOff take_off_by = TakeOff::climb;  ///< take-off after the run-up
  double climb_rate = 1;                 ///< of TakeOff::climb, maximum speed [m/s], > 0
  double take_off = 1;                   ///< of TakeOff::thrust, duration [s], ≥ 0

  friend bool operator==(const MissionStart&, const MissionStart&) = default;
};

/// Constant position and yaw for the whole flight.
struct Hover {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< world [m]
  double yaw = 0;                                      ///< [rad]

  friend bool operator==(const Hover&, const Hover&) = default;
};

/// A change of the reference: linear interpolation from the previous values to these.
struct TimedReference {
  double from = 0;   ///< beginning of the change [s]
  double until = 0;  ///< end of the change [s]; equal to `from` for a step
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< world [m]
  double yaw = 0;                                      ///< [rad], not wrapped

  friend bool operator==(const TimedReference&, const TimedReference&) = default;
};

/// Timed references. The first is a step at time 0; each is complete before the next begins.
struct Script {
  std::vector<TimedReference> references;  ///< at least one

  friend bool operator==(const Script&, const Script&) = default;
};

/// Points to be reached in order; follow_waypoints() computes the reference.
struct Waypoints {
  std::vector<Eigen::Vector3d> points;  ///< world [m], at least 2, consecutive points differ
  /// Distance of the reference ahead along the segment [m], > 0
  double look_ahead = 0;
  double transition_radius = 0;  ///< distance at which a waypoint counts as reached [m], > 0
  Nose nose = Nose::fixed;       ///< ahead: in the direction of the segment
  double yaw = 0;                ///< for Nose::fixed [rad]

  friend bool operator==(const Waypoints&, const Waypoints&) = default;
};

/// A key press of the pilot.
struct KeyPress {
  double time = 0;  ///< [s]
  char key = 0;     ///< one of kMissionKeys

  friend bool operator==(const KeyPress&, const KeyPress&) = default;
};

/// Keys of the Mambo's model project and, if they change a set point, of the manual mode of the
/// uquad program: d and a change roll by ±0.05 rad, w and s pitch by ±0.05 rad (all four switch
/// from position to attitude set points), j and l yaw by ±0.2 rad, i and k height by ±0.2 m, y and
/// h height by ±0.6 m, the first of each pair by the positive amount; r is home, e is abort.
inline constexpr char kMissionKeys[] = "dawsjlikyhre";

/// A pilot at the keyboard; each press changes the set point. Home returns to position set points
/// above the world's origin with the initial height and yaw. No key moves the height below the
/// ground.
struct Keys {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< before the first press [m]
  double yaw = 0;                                      ///< before the first press [rad]
  std::vector<KeyPress> presses;                       ///< times increase

  friend bool operator==(const Keys&, const Keys&) = default;
};

/// An interval in which individual motors run.
struct MotorRun {
  double begin = 0;         ///< [s]
  double duration = 0;      ///< [s], > 0
  std::vector<int> motors;  ///< numbered from 1
  double share = 0;         ///< command as a fraction of the range: 0 is the minimum, 1 the maximum

  friend bool operator==(const MotorRun&, const MotorRun&) = default;
};

/// Motor test: motors run one after the other on the ground without a control law.
struct MotorTest {
  std::vector<MotorRun> runs;  ///< at least one; each begins after the previous one has ended

  friend bool operator==(const MotorTest&, const MotorTest&) = default;
};

/// A vehicle that is carried along a path, level and with its motors off; see CarriedMotion.
struct Carried {
  SmoothPath path;  ///< position over time

  friend bool operator==(const Carried&, const Carried&) = default;
};

/// A SmoothPath is flown by the vehicle; a Carried path is not.
using MissionKind = std::variant<Hover, Script, Waypoints, SmoothPath, Keys, MotorTest, Carried>;

/// Landing: descent at a constant rate, then motor stop on the ground.
struct Landing {
  double begin = 0;   ///< [s]
  double rate = 0.3;  ///< downward [m/s], > 0
  /// Estimated height at or below which a stop of the descent counts as ground contact [m], > 0
  double off_height = 0.05;

  friend bool operator==(const Landing&, const Landing&) = default;
};

/// Complete definition of a mission.
struct Mission {
  std::string name;                 ///< e.g. "hover"
  std::string description;          ///< one line; may be empty
  double duration = 0;              ///< [s], > 0
  MissionStart start;               ///< ignored if the vehicle is carried
  MissionKind kind;                 ///< what the reference does
  std::optional<Landing> landing;   ///< empty: the flight ends in the air
  std::vector<FlightEvent> events;  ///< times do not decrease; empty if the vehicle is carried
  SettlingRule settling;            ///< when the vehicle counts as being at the reference
  std::vector<Limit> limits;        ///< each metric at most once
  /// Source file; empty if the mission is built in or was created in memory
  std::filesystem::path file;
  std::string text;  ///< content of the file, for the hash in the manifest

  friend bool operator==(const Mission&, const Mission&) = default;
};

/// Height of the mission's first reference above the ground [m].
[[nodiscard]] double first_height(const Mission& mission);

/// End of the take-off [s]; 0 for a flight that starts in the air, is carried or is a motor test.
[[nodiscard]] double end_of_take_off(const Mission& mission);

/// Replaces the take-off by that of the Mambo's model project: one second of constant thrust, while
/// the attitude is controlled. Removes a limit of Metric::height_peak, because the thrust
/// determines the height.
[[nodiscard]] Mission with_thrust_take_off(Mission mission);

/// Checks all requirements on a mission: times in order and within the duration, positions not
/// below the ground, distinct waypoints, known keys, limits not negative.
/// @throws InvalidInput  naming the field, its value and the expected one
void validate(const Mission& mission, const std::string& where);

/// Checks that the vehicle has the motors that a MotorTest runs. Motors that Mission::events names
/// are checked by require_possible().
/// @param mission  accepted by validate()
/// @param rotors   number of rotors of the vehicle
/// @param where    beginning of messages
/// @throws InvalidInput  naming the motor
void require_motors(const Mission& mission, int rotors, const std::string& where);

/// Maximum size of a mission file [bytes].
inline constexpr std::size_t kMissionFileLimit = std::size_t{1} << 20;
/// Maximum size of a reference file that a mission names [bytes].
inline constexpr std::size_t kScriptFileLimit = std::size_t{16} << 20;

/// Loads a built-in mission by name or a mission file by path (docs/formats.md). A word that
/// contains a slash or ends in ".toml" is a path; so is any other word that is not the name of a
/// built-in mission but of an existing file.
/// @throws InvalidInput  "file:line: key …" for an invalid file; for an unknown name, with the most
///                       similar built-in name
/// @throws FileError     if the mission file cannot be read
[[nodiscard]] Mission load_mission(const std::string& name_or_path);

/// Parses a mission from the text of a file.
/// @param text    content of the file
/// @param origin  name of the text in messages
/// @param folder  folder of the reference file that the mission may name
/// @throws        as load_mission()
[[nodiscard]] Mission parse_mission(const std::string& text, const std::string& origin,
                                    const std::filesystem::path& folder = {});

/// Names of the built-in missions, in the order of the documentation.
[[nodiscard]] std::vector<std::string> built_in_missions();

/// Compares the metrics of a flight with the limits of its mission. The first check requires a
/// complete flight: `duration` within 0.1 s of the mission's. A metric that is NaN fails its check.
[[nodiscard]] Verdict judge(const Mission& mission, const MetricValues& values);

}  // namespace quadtune
