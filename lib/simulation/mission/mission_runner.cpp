// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/mission_runner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "simulation/mission/climb.hpp"

namespace quadtune {

// The set point after a key press. It is not in the unnamed namespace because MissionRunner::Plan
// has members of this type.
struct KeySetPoint {
  double time;
  Eigen::Vector3d position;
  double yaw, roll, pitch;
  bool track_position;
};

namespace {

using Eigen::Vector3d;

// Depth below the ground to which the reference of a landing descends [m].
constexpr double kBelowGround = 0.5;

// A descent has stopped when the estimated downward speed stays below the fraction kSlow of the
// landing's rate for kStopped [s]. Above the fraction kSinks the vehicle descends.
constexpr double kSlow = 0.3, kSinks = 0.5;
constexpr double kStopped = 0.4;

// A vehicle that stops this far above its reference rests on something [m].
constexpr double kHeldUp = 0.15;

// Minimum horizontal distance of waypoints that determines a direction of the nose [m].
constexpr double kLevelWay = 1e-6;

// `yaw` plus the number of turns that brings it nearest to `to`.
double nearest_turn(double yaw, double to) {
  constexpr double kTurn = 2 * std::numbers::pi;
  return yaw + kTurn * std::round((to - yaw) / kTurn);
}

// Downward speed of an estimated state [m/s].
double sinking(const StateVector<double>& x) {
  const double roll = x(kAttitude), pitch = x(kAttitude + 1);
  return -std::sin(pitch) * x(kVelocity) + std::sin(roll) * std::cos(pitch) * x(kVelocity + 1) +
         std::cos(roll) * std::cos(pitch) * x(kVelocity + 2);
}

// Applies a key to the set point. In the Mambo's table height is -z, so its "minus" means up.
KeySetPoint pressed(KeySetPoint now, const KeyPress& press, const Keys& keys) {
  constexpr double kAngle = 0.05, kYaw = 0.2, kHeight = 0.2, kFar = 0.6;
  now.time = press.time;
  const auto tilt = [&](double& angle, double by) {
    angle += by;
    now.track_position = false;
  };
  switch (press.key) {
    case 'd':
      tilt(now.roll, kAngle);
      break;
    case 'a':
      tilt(now.roll, -kAngle);
      break;
    case 'w':
      tilt(now.pitch, kAngle);
      break;
    case 's':
      tilt(now.pitch, -kAngle);
      break;
    case 'j':
      now.yaw += kYaw;
      break;
    case 'l':
      now.yaw -= kYaw;
      break;
    case 'i':
      now.position.z() -= kHeight;
      break;
    case 'k':
      now.position.z() += kHeight;
      break;
    case 'y':
      now.position.z() -= kFar;
      break;
    case 'h':
      now.position.z() += kFar;
      break;
    case 'r':
      now = {press.time, Vector3d(0, 0, keys.position.z()), keys.yaw, 0, 0, true};
      break;
    default:  // 'e' ends the flight; validate() rejects all other keys
      break;
  }
  now.position.z() = std::min(now.position.z(), 0.0);  // not below the ground
  return now;
}

std::vector<KeySetPoint> set_points(const Keys& keys) {
  std::vector<KeySetPoint> all = {{0, keys.position, keys.yaw, 0, 0, true}};
  all.reserve(keys.presses.size() + 1);
  for (const KeyPress& press : keys.presses) all.push_back(pressed(all.back(), press, keys));
  return all;
}

// The last entry of `all` that has begun at t, or the first one. The search starts at `cursor`,
// since time usually advances to the same or the next entry.
template <class Entry, class Begin>
const Entry& entry_at(const std::vector<Entry>& all, double t, std::size_t& cursor, Begin begin) {
  const auto begun = [&](std::size_t i) { return begin(all[i]) <= t; };
  if (cursor >= all.size() || !begun(cursor)) cursor = 0;
  if (cursor + 1 < all.size() && begun(cursor + 1)) ++cursor;
  if (cursor + 1 < all.size() && begun(cursor + 1)) {
    const auto later =
        std::upper_bound(all.begin(), all.end(), t,
                         [&](double time, const Entry& entry) { return time < begin(entry); });
    cursor = static_cast<std::size_t>(later - all.begin()) - 1;
  }
  return all[cursor];
}

double abort_time(const Keys& keys) {
  for (const KeyPress& press : keys.presses)
    if (press.key == 'e') return press.time;
  return std::numeric_limits<double>::infinity();
}

MissionEvent event_of(FlightPhase phase) {
  switch (phase) {
    case FlightPhase::start_up:
      return MissionEvent::start_up;
    case FlightPhase::take_off:
      return MissionEvent::take_off;
    case FlightPhase::flying:
      return MissionEvent::flying;
    default:
      return MissionEvent::none;
  }
}

}  // namespace

std::string_view to_string(MissionEvent event) {
  switch (event) {
    case MissionEvent::none:
      return "";
    case MissionEvent::start_up:
      return "start_up";
    case MissionEvent::take_off:
      return "take_off";
    case MissionEvent::flying:
      return "flying";
    case MissionEvent::waypoint:
      return "waypoint";
    case MissionEvent::landing:
      return "landing";
    case MissionEvent::motors_off:
      return "motors_off";
    case MissionEvent::abort:
      return "abort";
  }
  return "";
}

struct MissionRunner::Plan {
  Mission mission;
  double end_of_take_off = 0;                              ///< [s]
  double first_height = 0;                                 ///< [m]
  std::vector<KeySetPoint> set_points;                     ///< for Keys missions
  double abort = std::numeric_limits<double>::infinity();  ///< time of the abort [s]
  double turns = 0;  ///< offset of the yaw of a path with the nose ahead [rad]
};

MissionRunner::MissionRunner(const Mission& mission) {
  validate(mission, "mission '" + mission.name + "'");
  auto plan = std::make_shared<Plan>();
  plan->mission = mission;
  plan->end_of_take_off = end_of_take_off(mission);
  plan->first_height = first_height(mission);
  waypoint_yaw_ = mission.start.yaw;
  if (const auto* keys = std::get_if<Keys>(&mission.kind)) {
    plan->set_points = set_points(*keys);
    plan->abort = abort_time(*keys);
  }
  if (const auto* waypoints = std::get_if<Waypoints>(&mission.kind)) {
    waypoint_reference_ = waypoints->points.front();
    if (waypoints->nose == Nose::fixed) waypoint_yaw_ = waypoints->yaw;
  }
  if (const auto* path = std::get_if<SmoothPath>(&mission.kind)) {
    const bool ahead =
        std::visit([](const auto& shape) { return shape.passage.nose == Nose::ahead; }, *path);
    const double first = path_point(*path, 0).yaw;
    if (ahead) plan->turns = nearest_turn(first, mission.start.yaw) - first;
  }
  plan_ = std::move(plan);
}

const Mission& MissionRunner::mission() const { return plan_->mission; }

bool MissionRunner::depends_on_estimate() const {
  return plan_->mission.landing || std::holds_alternative<Waypoints>(plan_->mission.kind);
}

void MissionRunner::ask(const Hover& hover, double /*t*/, Reference<double>& reference) {
  reference.position = hover.position;
  reference.yaw = hover.yaw;
}

void MissionRunner::ask(const Script& script, double t, Reference<double>& reference) {
  const std::vector<TimedReference>& all = script.references;
  const TimedReference& now =
      entry_at(all, t, cursor_, [](const TimedReference& entry) { return entry.from; });
  reference.position = now.position;
  reference.yaw = now.yaw;
  if (t >= now.until || cursor_ == 0) return;
  const TimedReference& before = all[cursor_ - 1];
  const double span = now.until - now.from;
  const double left = (now.until - t) / span;
  reference.position += (before.position - now.position) * left;
  reference.velocity = (now.position - before.position) / span;
  reference.yaw += (before.yaw - now.yaw) * left;
}

void MissionRunner::ask(const Waypoints& /*waypoints*/, double /*t*/,
                        Reference<double>& reference) {
  reference.position = waypoint_reference_;
  reference.yaw = waypoint_yaw_;
}

void MissionRunner::ask(const SmoothPath& path, double t, Reference<double>& reference) {
  const PathPoint point = path_point(path, t);
  reference.position = point.position;
  reference.velocity = point.velocity;
  reference.yaw = point.yaw + plan_->turns;
}

void MissionRunner::ask(const Keys& /*keys*/, double t, Reference<double>& reference) {
  const KeySetPoint& now = entry_at(plan_->set_points, t, cursor_,
                                    [](const KeySetPoint& set_point) { return set_point.time; });
  reference.position = now.position;
  reference.yaw = now.yaw;
  reference.roll = now.roll;
  reference.pitch = now.pitch;
  reference.track_position = now.track_position;
}

void MissionRunner::ask(const MotorTest& test, double t, Reference<double>& reference) {
  reference.position = plan_->mission.start.position;
  reference.yaw = plan_->mission.start.yaw;
  for (const MotorRun& run : test.runs) {
    if (t < run.begin || t >= run.begin + run.duration) continue;
    for (const int motor : run.motors) reference.motors(motor - 1) = run.share;
  }
}

void MissionRunner::ask(const Carried& carried, double t, Reference<double>& reference) {
  const PathPoint point = path_point(carried.path, t);
  reference.position = point.position;
  reference.velocity = point.velocity;
  reference.yaw = point.yaw;
}

void MissionRunner::ask(double t, Reference<double>& reference) {
  std::visit([&](const auto& kind) { ask(kind, t, reference); }, plan_->mission.kind);
}

FlightPhase MissionRunner::phase_at(double t) const {
  const Mission& mission = plan_->mission;
  if (std::holds_alternative<Carried>(mission.kind) || landed_ || aborted_) return FlightPhase::off;
  if (std::holds_alternative<MotorTest>(mission.kind)) return FlightPhase::motors;
  const MissionStart& start = mission.start;
  if (!start.in_air && t < start.start_up) return FlightPhase::start_up;
  if (start.take_off_by == TakeOff::thrust && t < plan_->end_of_take_off)
    return FlightPhase::take_off;
  return FlightPhase::flying;
}

void MissionRunner::follow(const StateVector<double>& believed) {
  const auto* waypoints = std::get_if<Waypoints>(&plan_->mission.kind);
  if (waypoints == nullptr) return;
  const std::size_t before = progress_.reached;
  waypoint_reference_ = follow_waypoints(*waypoints, believed.segment<3>(kPosition), progress_);
  const std::size_t now = progress_.reached;
  if (now == before) return;
  note(MissionEvent::waypoint);
  if (waypoints->nose == Nose::fixed || now >= waypoints->points.size()) return;
  const Vector3d way = waypoints->points[now] - waypoints->points[now - 1];
  if (way.head<2>().norm() > kLevelWay)
    waypoint_yaw_ = nearest_turn(std::atan2(way.y(), way.x()), waypoint_yaw_);
}

void MissionRunner::climb(double t, Reference<double>& reference) {
  const MissionStart& start = plan_->mission.start;
  const bool climbs = start.take_off_by == TakeOff::climb && t < plan_->end_of_take_off &&
                      reference.phase == FlightPhase::flying;
  if (climbs_ && !climbs) note(MissionEvent::flying);
  if (climbs && !climbs_) note(MissionEvent::take_off);
  climbs_ = climbs;
  if (!climbs) return;
  const ClimbPoint point = climb_at(plan_->first_height, start.climb_rate, t - start.start_up);
  if (-reference.position.z() <= point.height) return;
  reference.position.z() = 0 - point.height;
  reference.velocity.z() = 0 - point.speed;
}

void MissionRunner::land(double t, const StateVector<double>& believed,
                         Reference<double>& reference) {
  const Landing& landing = *plan_->mission.landing;
  if (!landing_) {
    landing_ = true;
    slow_since_ = t;
    note(MissionEvent::landing);
    Reference<double> last;
    ask(landing.begin, last);
    landing_from_ = last.position;
    landing_yaw_ = last.yaw;
    if (!last.track_position && believed.head<2>().allFinite())
      landing_from_.head<2>() = believed.head<2>();
  }
  reference = {};
  reference.position = landing_from_;
  reference.yaw = landing_yaw_;
  const double z = landing_from_.z() + landing.rate * (t - landing.begin);
  reference.position.z() = std::min(z, kBelowGround);
  reference.velocity.z() = z < kBelowGround ? landing.rate : 0;
  if (!landed_ && touches(t, believed, reference)) {
    landed_ = true;
    note(MissionEvent::motors_off);
  }
  if (!landed_) return;
  reference.position.z() = 0;
  reference.velocity.z() = 0;
}

// The estimated height may be wrong by more than a vehicle may fall, so the ground is detected by
// the motion: the vehicle no longer descends although its reference does.
bool MissionRunner::touches(double t, const StateVector<double>& believed,
                            const Reference<double>& reference) {
  const Landing& landing = *plan_->mission.landing;
  const double speed = sinking(believed), height = -believed(kPosition + 2);
  sank_ = sank_ || speed > kSinks * landing.rate;
  if (!(speed < kSlow * landing.rate) || !std::isfinite(height)) slow_since_ = t;
  if (t - slow_since_ < kStopped) return false;
  const double asked = -reference.position.z();
  return height <= landing.off_height || (sank_ && asked <= 0 && height - asked >= kHeldUp);
}

void MissionRunner::note(MissionEvent event) { event_ = std::max(event_, event); }

Reference<double> MissionRunner::at(double t, const StateVector<double>& believed) {
  if (!(t > 0)) t = 0;
  const std::optional<Landing>& landing = plan_->mission.landing;
  event_ = MissionEvent::none;
  if (!aborted_ && t >= plan_->abort) {
    aborted_ = true;
    note(MissionEvent::abort);
  }
  Reference<double> reference;
  if (landing && t >= landing->begin && !aborted_) {
    land(t, believed, reference);
  } else {
    if (phase_at(t) == FlightPhase::flying) follow(believed);
    ask(t, reference);
  }
  reference.phase = phase_at(t);
  const bool changed = !begun_ || reference.phase != phase_;
  climb(t, reference);
  // During a climb the law is already active, but the mission's event `flying` occurs at its end.
  if (changed && !climbs_) note(event_of(reference.phase));
  begun_ = true;
  phase_ = reference.phase;
  return reference;
}

}  // namespace quadtune
