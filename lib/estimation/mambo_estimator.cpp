// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/mambo_estimator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estimation/checks.hpp"

namespace quadtune {
namespace {

template <class T>
void validate_mambo(const MamboEstimatorSettings<T>& settings, const std::string& where) {
  validate(attitude_settings(settings), where);
  if (!(settings.calibration_time >= 0) || !std::isfinite(settings.calibration_time))
    throw InvalidInput(where, fmt::format("calibration_time is {} s, expected 0 or more and finite",
                                          settings.calibration_time));
  require_variance(settings.altitude_Q, "altitude_Q", " m2/s2", where);
  require_positive(settings.altitude_R, "altitude_R", " m2", where);
  require_variance(settings.velocity_Q, "velocity_Q", " m2/s2", where);
  require_positive(settings.velocity_R, "velocity_R", " m2/s2", where);
  require_not_negative(settings.sonar_min, "sonar_least", " m", where);
  if (!(settings.sonar_min < settings.sonar_max))
    throw InvalidInput(where, fmt::format("sonar_least is {} m and sonar_greatest {} m, expected "
                                          "sonar_least < sonar_greatest because echoes lie "
                                          "between them",
                                          settings.sonar_min, settings.sonar_max));
  require_not_negative(settings.sonar_jump, "sonar_jump", " m", where);
  require_not_negative(settings.sonar_deviation, "sonar_deviation", " m", where);
  require_not_negative(settings.sonar_recovery_time, "sonar_recovery_time", " s", where);
  require_positive(settings.flow_scale, "flow_scale", "", where);
  // Negative values are for a sensor with the sign convention of the original package, Oliveira
  // 2020 (6.8).
  if (!std::isfinite(settings.flow_compensation_x + settings.flow_compensation_y))
    throw InvalidInput(where,
                       fmt::format("flow_compensation is {} and {}, expected finite numbers",
                                   settings.flow_compensation_x, settings.flow_compensation_y));
  require_not_negative(settings.gyro_lag, "gyro_lag", " s", where);
  if (settings.aligned_periods < 0 || settings.aligned_periods > kMaxAlignedPeriods)
    throw InvalidInput(where, fmt::format("aligned_periods is {}, expected 0 to {}",
                                          settings.aligned_periods, kMaxAlignedPeriods));
  require_not_negative(settings.flow_min_height, "flow_least_height", " m", where);
  require_not_negative(settings.flow_timeout, "flow_timeout", " s", where);
  require_not_negative(settings.flow_disagreement, "flow_disagreement", " m/s", where);
  require_variance(settings.position_Q, "position_Q", " m2", where);
  require_positive(settings.vision_R, "vision_R", " m2", where);
}

}  // namespace

int flow_alignment_periods(double gyro_lag, double flow_delay, double dt) {
  if (gyro_lag == 0 && flow_delay == 0) return 0;
  // Either the flow waits for the gyroscope readings or the readings wait for the flow. A flow may
  // be up to one period older than its delay when it is processed.
  const double apart = std::max(gyro_lag - flow_delay, flow_delay + dt - gyro_lag);
  return static_cast<int>(std::min<double>(2 + std::ceil(apart / dt), kMaxAlignedPeriods));
}

void validate(const MamboEstimatorSettings<double>& settings, const std::string& where) {
  validate_mambo(settings, where);
}

void validate(const MamboEstimatorSettings<float>& settings, const std::string& where) {
  validate_mambo(settings, where);
}

}  // namespace quadtune
