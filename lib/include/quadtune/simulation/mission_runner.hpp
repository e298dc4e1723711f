// SPDX-License-Identifier: Apache-2.0
/// Computes the reference of a mission for each control period.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>

#include "quadtune/estimation/on_board.hpp"
#include "quadtune/simulation/mission.hpp"
#include "quadtune/simulation/waypoint_follower.hpp"

namespace quadtune {

/// Events of a mission.
enum class MissionEvent {
  none,
  start_up,    ///< the motors start to run up
  take_off,    ///< the climb of the reference or the interval of constant thrust begins
  flying,      ///< the law becomes active
  waypoint,    ///< a waypoint was reached
  landing,     ///< the descent begins
  motors_off,  ///< the vehicle is estimated to be on the ground
  abort,       ///< the pilot pressed 'e'
};
/// Name, e.g. "take_off"; "" for no event.
[[nodiscard]] std::string_view to_string(MissionEvent event);

/// Runs a mission. at() is called once per control period, with times that do not decrease.
///
/// On the ground the phases are start_up, then take_off (TakeOff::thrust only), then flying; in the
/// air the phase is flying from the beginning. In a climb (TakeOff::climb) the reference is that of
/// the mission, but not higher than climb_at(); the event is take_off when the climb begins and
/// flying when it ends. The phase of a motor test is always FlightPhase::motors, that of a carried
/// vehicle always FlightPhase::off, with the true motion as reference.
///
/// In a landing the reference height decreases at its rate to half a metre below the ground, so
/// that a vehicle that flies above its reference also reaches the ground. The horizontal reference
/// is that at the beginning of the landing, or the estimated position if the pilot controlled the
/// attitude. The motors are switched off for good after the vehicle is estimated to have stopped
/// descending for 0.4 s, at or below `off_height`, or at most 0.15 m above its reference when that
/// is in the ground.
///
/// Lines, circles, lemniscates and ramps of a script provide a reference velocity; waypoints and
/// keys do not. With the nose ahead, the first yaw is the equivalent angle nearest to the yaw at
/// the start; later yaws are continuous except at the corner of a waypoint, where the reference
/// turns the shorter way.
///
/// A copy continues from the state of the original. No memory is allocated after construction; the
/// same calls give identical bytes.
class MissionRunner {
 public:
  /// @throws InvalidInput  if validate() rejects the mission
  explicit MissionRunner(const Mission& mission);

  /// Reference at time t [s] since the start of the mission.
  /// @param believed  estimated state; used only if depends_on_estimate()
  [[nodiscard]] Reference<double> at(double t, const StateVector<double>& believed);

  /// Whether the reference depends on the estimated state: with waypoints and in every landing.
  [[nodiscard]] bool depends_on_estimate() const;

  /// The event of the last call of at(). If there were several, the one declared last in
  /// MissionEvent.
  [[nodiscard]] MissionEvent event() const { return event_; }

  [[nodiscard]] const Mission& mission() const;

 private:
  struct Plan;

  // Computes the reference of each kind of mission at time t, except the phase.
  void ask(const Hover& hover, double t, Reference<double>& reference);
  void ask(const Script& script, double t, Reference<double>& reference);
  void ask(const Waypoints& waypoints, double t, Reference<double>& reference);
  void ask(const SmoothPath& path, double t, Reference<double>& reference);
  void ask(const Keys& keys, double t, Reference<double>& reference);
  void ask(const MotorTest& test, double t, Reference<double>& reference);
  void ask(const Carried& carried, double t, Reference<double>& reference);
  void ask(double t, Reference<double>& reference);

  [[nodiscard]] FlightPhase phase_at(double t) const;
  void follow(const StateVector<double>& believed);
  void climb(double t, Reference<double>& reference);
  void land(double t, const StateVector<double>& believed, Reference<double>& reference);
  [[nodiscard]] bool touches(double t, const StateVector<double>& believed,
                             const Reference<double>& reference);
  void note(MissionEvent event);

  std::shared_ptr<const Plan> plan_;  ///< constant, and therefore shared by copies
  MissionEvent event_ = MissionEvent::none;
  bool begun_ = false;  ///< whether at() has been called
  FlightPhase phase_ = FlightPhase::off;
  bool climbs_ = false;
  bool landing_ = false;
  bool landed_ = false;
  bool sank_ = false;      ///< since the landing began
  double slow_since_ = 0;  ///< last time at which the vehicle descended [s]
  bool aborted_ = false;
  Eigen::Vector3d landing_from_ = Eigen::Vector3d::Zero();
  double landing_yaw_ = 0;
  WaypointProgress progress_;
  Eigen::Vector3d waypoint_reference_ = Eigen::Vector3d::Zero();
  double waypoint_yaw_ = 0;
  std::size_t cursor_ = 0;  ///< index into the timed references or set points
};

}  // namespace quadtune
