// SPDX-License-Identifier: Apache-2.0
/// A mission as it is flown: the reference of each control period.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>

#include "quadtune/estimation/on_board.hpp"
#include "quadtune/simulation/mission.hpp"
#include "quadtune/simulation/waypoint_follower.hpp"

namespace quadtune {

/// What changed in a control period.
enum class MissionEvent {
  none,
  start_up,    ///< the motors run up
  take_off,    ///< the climb of the reference begins, or the time of constant thrust
  flying,      ///< the law takes over
  waypoint,    ///< a waypoint was reached
  landing,     ///< the way down begins
  motors_off,  ///< on the ground, as believed
  abort,       ///< the pilot pressed 'e'
};
/// "take_off"; "" for none.
[[nodiscard]] std::string_view to_string(MissionEvent event);

/// Flies a mission: at() is asked once per control period, with times that do not decrease.
///
/// On the ground the phases are start_up, then take_off (TakeOff::thrust only), then flying; in the
/// air flying from the beginning. In a climb (TakeOff::climb) the reference is that of the mission,
/// but no higher than climb_at(); the event is take_off when it begins and flying when it ends. A
/// motor test is FlightPhase::motors throughout, a carried vehicle FlightPhase::off with the
/// reference where it truly is. In a landing the height sinks at its rate to half a metre below the
/// ground, so that a vehicle that flies above its reference comes down too, over the place that the
/// reference had when it began (where the pilot flew by attitude: over the believed place). Once
/// the vehicle is believed to have stopped sinking for 0.4 s, at or below `off_height`, or 0.15 m
/// above its reference when that is in the ground, the motors are off for good.
///
/// Lines, circles, lemniscates and ramps of a script supply their velocity; waypoints and keys have
/// none. With the nose ahead the first yaw is the one nearest the start's, and later ones have no
/// jumps but those of a waypoint's corner, the shorter way round.
///
/// A copy goes on from where the original is. Nothing is allocated after the construction; the same
/// calls give the same bytes.
class MissionRunner {
 public:
  /// @throws InvalidInput  for a mission that validate() refuses.
  explicit MissionRunner(const Mission& mission);

  /// The reference at time t [s] from the mission's start.
  /// @param believed  the estimated state; looked at only if depends_on_estimate().
  [[nodiscard]] Reference<double> at(double t, const StateVector<double>& believed);

  /// Whether the reference depends on what the vehicle believes: waypoints, and every landing.
  [[nodiscard]] bool depends_on_estimate() const;

  /// What changed in the last call of at(); of several the most important, the one that stands last
  /// in MissionEvent.
  [[nodiscard]] MissionEvent event() const { return event_; }

  [[nodiscard]] const Mission& mission() const;

 private:
  struct Plan;

  // What each kind of mission asks for at time t, the phase aside.
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

  std::shared_ptr<const Plan> plan_;  ///< does not change, so copies share it
  MissionEvent event_ = MissionEvent::none;
  bool begun_ = false;  ///< whether at() was called
  FlightPhase phase_ = FlightPhase::off;
  bool climbs_ = false;
  bool landing_ = false;
  bool landed_ = false;
  bool sank_ = false;      ///< since the landing began
  double slow_since_ = 0;  ///< last time at which it sank [s]
  bool aborted_ = false;
  Eigen::Vector3d landing_from_ = Eigen::Vector3d::Zero();
  double landing_yaw_ = 0;
  WaypointProgress progress_;
  Eigen::Vector3d waypoint_reference_ = Eigen::Vector3d::Zero();
  double waypoint_yaw_ = 0;
  std::size_t cursor_ = 0;  ///< in the list of timed references or of set points
};

}  // namespace quadtune
