// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/firmware_filters.hpp"

#include <cmath>
#include <numbers>
#include <string>

namespace quadtune::internal {
namespace {

bool turns(CascadeAxis axis) {
  return axis == CascadeAxis::roll || axis == CascadeAxis::pitch || axis == CascadeAxis::yaw;
}

/// A cut-off of 0 disables a filter.
LowPasses filter_of(int order, double cutoff_Hz) {
  if (!(cutoff_Hz > 0)) return {};
  return {{order, cutoff_Hz}};
}

LowPasses series(LowPasses first, const LowPasses& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

LoopFilters px4_filters(CascadeAxis axis, const ParameterValues& value) {
  LoopFilters filters;
  if (!turns(axis)) {
    constexpr double kVelocityDerivative = 5;  // [Hz] MPC_VELD_LP
    filters.derivative = filter_of(1, kVelocityDerivative);
    return filters;
  }
  // The firmware ignores a cut-off above half of its rate.
  if (2 * value("IMU_GYRO_CUTOFF") < value("IMU_GYRO_RATEMAX"))
    filters.rate = filter_of(2, value("IMU_GYRO_CUTOFF"));
  filters.derivative = filter_of(1, value("IMU_DGYRO_CUTOFF"));
  if (axis == CascadeAxis::yaw && value.has("MC_YAW_TQ_CUTOFF"))
    filters.output = filter_of(1, value("MC_YAW_TQ_CUTOFF"));
  return filters;
}

LoopFilters ardupilot_filters(CascadeAxis axis, const ParameterValues& value) {
  LoopFilters filters;
  if (!turns(axis)) {
    const bool renamed = value.has("PSC_NE_VEL_P"), height = axis == CascadeAxis::altitude;
    const std::string velocity =
        renamed ? (height ? "PSC_D_VEL_" : "PSC_NE_VEL_") : (height ? "PSC_VELZ_" : "PSC_VELXY_");
    filters.error = filter_of(1, value(velocity + "FLTE"));
    filters.derivative = filter_of(1, value(velocity + "FLTD"));
    return filters;
  }
  const std::string rate = std::string("ATC_RAT_") +
                           (axis == CascadeAxis::yaw    ? "YAW"
                            : axis == CascadeAxis::roll ? "RLL"
                                                        : "PIT") +
                           "_";
  filters.rate = filter_of(2, value("INS_GYRO_FILTER"));
  filters.error = filter_of(1, value(rate + "FLTE"));
  filters.target = filter_of(1, value(rate + "FLTT"));
  filters.derivative = filter_of(1, value(rate + "FLTD"));
  return filters;
}

LoopFilters betaflight_filters(CascadeAxis axis, const ParameterValues& value) {
  if (!turns(axis)) return {};
  // If a cut-off depends on the throttle, its lower end is used.
  const auto first = [&](const std::string& name) {
    const double min = value(name + "_dyn_min_hz");
    return filter_of(1, min > 0 ? min : value(name + "_static_hz"));
  };
  LoopFilters filters;
  filters.rate = series(first("gyro_lpf1"), filter_of(1, value("gyro_lpf2_static_hz")));
  filters.derivative = series(first("dterm_lpf1"), filter_of(1, value("dterm_lpf2_static_hz")));
  // Acts on P only; its effect on the integral is negligible.
  if (axis == CascadeAxis::yaw) filters.error = filter_of(1, value("yaw_lowpass_hz"));
  return filters;
}

LoopFilters crazyflie_filters(CascadeAxis axis) {
  constexpr double kGyroscope = 80, kVelocityDerivative = 20;  // [Hz]
  LoopFilters filters;
  if (turns(axis))
    filters.rate = filter_of(2, kGyroscope);
  else
    filters.derivative = filter_of(2, kVelocityDerivative);
  return filters;
}

}  // namespace

LoopFilters loop_filters(const Firmware& firmware, CascadeAxis axis, const ParameterValues& value) {
  switch (firmware.kind) {
    case FirmwareKind::px4:
      return px4_filters(axis, value);
    case FirmwareKind::ardupilot:
      return ardupilot_filters(axis, value);
    case FirmwareKind::betaflight:
      return betaflight_filters(axis, value);
    case FirmwareKind::crazyflie:
      return crazyflie_filters(axis);
  }
  return {};
}

double derivative_time(const Firmware& firmware, CascadeAxis axis, const ParameterValues& value) {
  double sum = 0;
  for (const LowPass& filter : loop_filters(firmware, axis, value).derivative)
    sum += (filter.order == 2 ? std::numbers::sqrt2 : 1) / (2 * std::numbers::pi * filter.cutoff);
  return sum;
}

bool exists_with_error_lead(double a, double b, double lead) {
  if (!(3 * lead * a < 1)) return false;
  const double lowest = (1 + std::sqrt(1 - 3 * lead * a)) / (3 * lead);
  return ((lead * lowest - 1) * lowest + a) * lowest - b <= 0;
}

LoopRates loop_rates(const Firmware& firmware, const ParameterValues& value) {
  switch (firmware.kind) {
    case FirmwareKind::px4:
      return {value("IMU_GYRO_RATEMAX"), 200, 100};
    case FirmwareKind::ardupilot: {
      const double rate = value("SCHED_LOOP_RATE");
      return {rate, rate, rate};
    }
    case FirmwareKind::betaflight:
      return {4000, 4000, 250};  // of common boards; loops of the pilot run with kFirmwarePeriod
    case FirmwareKind::crazyflie:
      return {500, 500, 100};
  }
  return {};
}

}  // namespace quadtune::internal
