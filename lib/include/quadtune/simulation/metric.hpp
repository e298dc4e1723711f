// SPDX-License-Identifier: Apache-2.0
/// The figures by which a flight is judged: names, units, limits. How each is measured is said in
/// flight_metrics.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace quadtune {

/// Every figure of a flight, in the order in which they are printed.
enum class Metric {
  duration,         ///< how long it was flown [s]
  settling_time,    ///< until the vehicle stays where it should, the worst [s]
  overshoot,        ///< beyond where it should be, as a share of the step, the worst [1]
  yaw_overshoot,    ///< the same of the yaw [1]
  tracking_rms,     ///< distance from the reference, root mean square [m]
  tracking_max,     ///< and greatest [m]
  height_rms,       ///< its vertical part, root mean square [m]
  height_max,       ///< and greatest size [m]
  yaw_rms,          ///< yaw off the reference, root mean square [rad]
  yaw_max,          ///< and greatest size [rad]
  tilt_max,         ///< greatest angle between the body's z axis and the vertical [rad]
  speed_max,        ///< greatest speed [m/s]
  saturation_time,  ///< for which some motor was at a limit [s]
  energy,           ///< of the motors [J]
  estimate_rms,     ///< distance from the true to the believed position, root mean square [m]
  estimate_max,     ///< and greatest [m]
  position_drift,   ///< how far that error went horizontally from first to last [m]
  final_distance,   ///< distance from the reference at the end [m]
  touchdown_speed,  ///< downward speed at which the ground was met, the worst [m/s]
  height_peak,      ///< greatest height above the highest reference so far [m]
};
inline constexpr std::size_t kMetrics = static_cast<std::size_t>(Metric::height_peak) + 1;

/// "settling_time" and "s"; the unit of a share is "1".
[[nodiscard]] const std::string& name_of(Metric metric);
[[nodiscard]] const std::string& unit_of(Metric metric);

/// Names of all, in order.
[[nodiscard]] std::vector<std::string> metric_names();

/// The metric of that name; none for another word.
[[nodiscard]] std::optional<Metric> metric_of(const std::string& name);

/// What one flight measured. A figure that the flight does not have is NaN, one that it did not
/// reach is infinite.
struct MetricValues {
  std::array<double, kMetrics> value;

  MetricValues() { value.fill(std::numeric_limits<double>::quiet_NaN()); }
  double& operator[](Metric metric) { return value[static_cast<std::size_t>(metric)]; }
  double operator[](Metric metric) const { return value[static_cast<std::size_t>(metric)]; }
};

/// The greatest value of a metric that is accepted.
struct Limit {
  Metric metric = Metric::duration;
  double most = 0;  ///< in the metric's unit, ≥ 0

  friend bool operator==(const Limit&, const Limit&) = default;
};

/// The limit's key in a mission file: "settling_time_max_s", "tilt_max_rad", "overshoot_max".
[[nodiscard]] std::string limit_key(Metric metric);

/// What counts as being where the reference is.
struct SettlingRule {
  double band = 0.05;      ///< of the position [m], > 0
  double yaw_band = 0.05;  ///< of the yaw [rad], > 0
  /// How long after a step tracking is not yet judged, and how long a reference must stand still
  /// for settling to be judged [s], ≥ 0.
  double window = 5;
  /// Bands within which the vehicle counts as settled where the sensors cannot know better than
  /// `band` and `yaw_band` [m, rad]; those apply where these are smaller. Steps are found, and
  /// overshoot is measured, by `band` and `yaw_band`.
  double settled_band = 0;
  double settled_yaw_band = 0;

  friend bool operator==(const SettlingRule&, const SettlingRule&) = default;
};

/// One limit held against one flight.
struct LimitCheck {
  Metric metric = Metric::duration;
  double value = 0;  ///< what was measured; NaN where there was nothing to measure
  double bound = 0;
  bool at_least = false;  ///< the bound is the least value, else the greatest
  bool ok = false;        ///< never for NaN
};

/// All of a mission's limits.
struct Verdict {
  std::vector<LimitCheck> checks;
  bool ok = false;  ///< whether every check is
};

}  // namespace quadtune
