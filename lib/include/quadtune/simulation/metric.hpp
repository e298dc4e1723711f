// SPDX-License-Identifier: Apache-2.0
/// The metrics by which a flight is judged: names, units, limits. flight_metrics.hpp defines how
/// each is computed.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace quadtune {

/// All metrics of a flight, in the order of output.
enum class Metric {
  duration,         ///< duration of the flight [s]
  settling_time,    ///< maximum time until the vehicle remains within the band [s]
  overshoot,        ///< maximum overshoot as a fraction of the step [1]
  yaw_overshoot,    ///< the same for the yaw [1]
  tracking_rms,     ///< distance from the reference, root mean square [m]
  tracking_max,     ///< distance from the reference, maximum [m]
  height_rms,       ///< height error, root mean square [m]
  height_max,       ///< height error, maximum magnitude [m]
  yaw_rms,          ///< yaw error, root mean square [rad]
  yaw_max,          ///< yaw error, maximum magnitude [rad]
  tilt_max,         ///< maximum angle between the body's z axis and the vertical [rad]
  speed_max,        ///< maximum speed [m/s]
  saturation_time,  ///< time during which a motor was at a limit [s]
  energy,           ///< energy consumption of the motors [J]
  estimate_rms,     ///< position error of the estimate, root mean square [m]
  estimate_max,     ///< position error of the estimate, maximum [m]
  position_drift,   ///< horizontal change of that error from the first to the last period [m]
  final_distance,   ///< distance from the reference at the end [m]
  touchdown_speed,  ///< maximum downward speed at touchdown [m/s]
  height_peak,      ///< maximum height above the highest reference so far [m]
};
/// Number of metrics.
inline constexpr std::size_t kMetrics = static_cast<std::size_t>(Metric::height_peak) + 1;

/// Name of a metric, e.g. "settling_time".
[[nodiscard]] const std::string& name_of(Metric metric);

/// Unit of a metric, e.g. "s"; "1" for a ratio.
[[nodiscard]] const std::string& unit_of(Metric metric);

/// Names of all metrics, in order.
[[nodiscard]] std::vector<std::string> metric_names();

/// The metric with that name; empty if the name is unknown.
[[nodiscard]] std::optional<Metric> metric_of(const std::string& name);

/// Metrics of one flight. A metric that is undefined for the flight is NaN; one that was not
/// reached, such as settling, is infinite.
struct MetricValues {
  std::array<double, kMetrics> value;  ///< by Metric

  MetricValues() { value.fill(std::numeric_limits<double>::quiet_NaN()); }
  /// Of one metric, for changes.
  double& operator[](Metric metric) { return value[static_cast<std::size_t>(metric)]; }
  /// Of one metric.
  double operator[](Metric metric) const { return value[static_cast<std::size_t>(metric)]; }
};

/// Maximum accepted value of a metric. A mission has no limit of Metric::duration, because judge()
/// always checks that the full duration was flown.
struct Limit {
  Metric metric = Metric::duration;  ///< which metric
  double max = 0;                    ///< in the metric's unit, ≥ 0

  friend bool operator==(const Limit&, const Limit&) = default;
};

/// The limit's key in a mission file: "settling_time_max_s", "tilt_max_rad", "overshoot_max".
[[nodiscard]] std::string limit_key(Metric metric);

/// Defines when the vehicle counts as being at the reference.
struct SettlingRule {
  double band = 0.05;      ///< for the position [m], > 0
  double yaw_band = 0.05;  ///< for the yaw [rad], > 0
  /// Time after a step during which tracking is not evaluated, and minimum time for which a
  /// reference must be constant for settling to be evaluated [s], ≥ 0.
  double window = 5;
  /// Bands within which the vehicle counts as settled, if the sensors are not accurate enough for
  /// `band` and `yaw_band` [m, rad]. The larger of each pair applies. Steps and overshoot are
  /// always evaluated with `band` and `yaw_band`.
  double settled_band = 0;
  double settled_yaw_band = 0;  ///< see settled_band [rad]

  friend bool operator==(const SettlingRule&, const SettlingRule&) = default;
};

/// Comparison of one metric of a flight with its limit.
struct LimitCheck {
  Metric metric = Metric::duration;  ///< which metric
  double value = 0;                  ///< value of the metric; NaN if it is undefined
  double bound = 0;                  ///< the limit
  bool at_least = false;             ///< the bound is a minimum, otherwise a maximum
  bool ok = false;                   ///< false if the value is NaN
};

/// Result of all limits of a mission.
struct Verdict {
  std::vector<LimitCheck> checks;  ///< in the order of the mission's limits
  bool ok = false;                 ///< whether every check is satisfied
};

}  // namespace quadtune
