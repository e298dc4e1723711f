// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "quadtune/simulation/mission_runner.hpp"
#include "quadtune/workbench/flight/sensor_bound.hpp"

namespace quadtune {
namespace {

constexpr double kStep = 0.02;       // step at which the mission's references are evaluated [s]
constexpr double kMaxSteps = 50000;  // maximum for a long mission
constexpr double kMinHeight = 0.05;  // minimum height of the equivalent flight [m]

/// A jump of the reference, and the outputs until the next one.
struct Jump {
  Eigen::Vector3d way;  ///< [m]
  double turn;          ///< [rad]
  std::size_t first, end;
};

/// The periods in which tracking is evaluated, and the mean height of the flight.
struct Judged {
  std::vector<Jump> jumps;     ///< in flight
  std::vector<bool> tracked;   ///< outputs in which tracking is evaluated
  std::vector<bool> position;  ///< and position is commanded, not only attitude and height
  double height = 0;           ///< rms of the reference's height [m]
};

/// As in FlightMetrics: in flight, and at least the settling window after the last step.
Judged judged_periods(const Mission& mission, const std::vector<double>& times, double duration) {
  Judged judged;
  judged.tracked.assign(times.size(), false);
  judged.position.assign(times.size(), false);
  MissionRunner runner(mission);
  const bool waypoints = std::holds_alternative<Waypoints>(mission.kind);
  const double step = std::max(kStep, duration / kMaxSteps);
  StateVector<double> believed = StateVector<double>::Zero();
  believed.head<3>() = mission.start.position;
  Reference<double> before;
  bool flew = false;
  double last_step = 0, squares = 0, flown = 0;
  std::size_t next = 0;
  for (int i = 0; i * step <= duration + step && next < times.size(); ++i) {
    const double t = i * step;
    // With perfect tracking, all waypoints would be reached at once: the vehicle waits at the
    // first.
    const Reference<double> now = runner.at(t, believed);
    const bool flying = now.phase == FlightPhase::flying;
    const bool moves = flying || std::holds_alternative<Carried>(mission.kind);
    const Eigen::Vector3d way = now.position - before.position - now.velocity * step;
    const double turn = std::abs(now.yaw - before.yaw);
    const bool jumps = way.norm() > mission.settling.band || turn > mission.settling.yaw_band;
    if (flying && (!flew || jumps)) {
      last_step = t;
      if (!judged.jumps.empty()) judged.jumps.back().end = next;
      if (flew) judged.jumps.push_back({way, turn, next, times.size()});
    }
    if (!waypoints) believed.head<3>() = now.position;
    before = now;
    flew = flying;
    if (moves) {
      squares += now.position.z() * now.position.z() * step;
      flown += step;
    }
    for (; next < times.size() && times[next] < t + step; ++next) {
      judged.tracked[next] = flying && t - last_step >= mission.settling.window - step;
      judged.position[next] = judged.tracked[next] && now.track_position;
    }
  }
  judged.height = flown > 0 ? std::sqrt(squares / flown) : 0;
  return judged;
}

/// The same error where `counts` is set, 0 elsewhere.
ErrorCovariance where(const std::vector<bool>& counts, ErrorCovariance error) {
  for (std::size_t k = 0; k < counts.size(); ++k) {
    if (counts[k]) continue;
    error.variance(static_cast<Eigen::Index>(k)) = 0;
    error.covariance.col(static_cast<Eigen::Index>(k)).setZero();
  }
  return error;
}

/// The error along a direction, from errors along three axes.
ErrorCovariance along(const Eigen::Vector3d& direction, const SensorBound& bound) {
  const Eigen::Vector3d share = direction.cwiseAbs2();
  ErrorCovariance error = bound.north;
  error.variance = share(0) * bound.north.variance + share(1) * bound.east.variance +
                   share(2) * bound.height.variance;
  error.covariance = share(0) * bound.north.covariance + share(1) * bound.east.covariance +
                     share(2) * bound.height.covariance;
  return error;
}

ErrorSize over(double step, ErrorSize size) {
  size.rms /= step;
  size.rms_rarely /= step;
  size.most_rarely /= step;
  return size;
}

void keep_greater(ErrorSize& size, const ErrorSize& other) {
  if (other.most_rarely > size.most_rarely) size = other;
}

/// Adds the effect of position errors on overshoots.
void add_overshoots(MissionBound& result, const Judged& judged, const Mission& mission,
                    const std::vector<double>& times) {
  for (const Jump& jump : judged.jumps) {
    std::vector<bool> counted(times.size(), false);
    std::fill(counted.begin() + static_cast<std::ptrdiff_t>(jump.first),
              counted.begin() + static_cast<std::ptrdiff_t>(std::max(jump.first, jump.end)), true);
    const double way = jump.way.norm();
    if (way > mission.settling.band)
      keep_greater(result.overshoot,
                   over(way, error_size({along(jump.way / way, result.bound)}, times, counted)));
    if (jump.turn > mission.settling.yaw_band)
      keep_greater(result.yaw_overshoot,
                   over(jump.turn, error_size({result.bound.heading}, times, counted)));
  }
}

}  // namespace

std::optional<MissionBound> mission_bound(const FlightSetup& setup) {
  const Mission& mission = setup.mission;
  if (!setup.real_sensors || setup.estimator == EstimatorKind::truth ||
      std::holds_alternative<MotorTest>(mission.kind))
    return std::nullopt;
  MissionBound result;
  SensorBoundOptions& options = result.options;
  options.duration = duration_of(setup);
  const bool stands = !mission.start.in_air && !std::holds_alternative<Carried>(mission.kind);
  options.begin = stands ? std::min(mission.start.start_up, options.duration) : 0;
  options.calibration = options.begin;
  options.gravity = setup.vehicle.gravity;
  options.air_density = setup.vehicle.air_density;
  options.field = setup.environment.magnetic_field.head<2>().norm();
  // If the flight starts in the air, the filter starts with the calibration results given to it.
  if (!stands && setup.estimator == EstimatorKind::general)
    options.allowed.start = general_filter_settings(setup).start;
  const std::vector<double> times = bound_times(options.duration);
  const Judged judged = judged_periods(mission, times, options.duration);
  options.height = std::max(judged.height, kMinHeight);
  const std::optional<SensorBound> bound = sensor_bound(sensors_of(setup), options);
  if (!bound) return std::nullopt;
  result.bound = *bound;
  const ErrorCovariance &north = bound->north, &east = bound->east, &height = bound->height;
  const ErrorCovariance north_tracked = where(judged.position, north);
  const ErrorCovariance east_tracked = where(judged.position, east);
  result.tracking = error_size({north_tracked, east_tracked, height}, times, judged.tracked);
  result.height = error_size({height}, times, judged.tracked);
  result.heading = error_size({bound->heading}, times, judged.tracked);
  add_overshoots(result, judged, mission, times);
  result.estimate = error_size({north, east, height}, times, std::vector<bool>(times.size(), true));
  double squares = 0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (!judged.position[k]) continue;
    squares +=
        north.variance(static_cast<Eigen::Index>(k)) + east.variance(static_cast<Eigen::Index>(k));
    ++count;
  }
  result.horizontal_rms = count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0;
  const auto end = [](const ErrorCovariance& error) {
    return error.variance(error.variance.size() - 1);
  };
  result.horizontal_end = std::sqrt(end(north) + end(east));
  result.height_end = std::sqrt(end(height));
  result.heading_end = std::sqrt(end(bound->heading));
  result.final_rarely = rarely_exceeded({end(north), end(east), end(height)});
  result.drift_rarely = rarely_exceeded({end(north), end(east)});
  return result;
}

}  // namespace quadtune
