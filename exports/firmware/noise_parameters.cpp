// SPDX-License-Identifier: Apache-2.0
// Converts the noises of the general filter to those of a firmware's estimator. docs/theory.md,
// "Cascades of autopilots".
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/exports/firmware.hpp"

namespace quadtune {
namespace {

/// Length of a prediction step of the firmware's filter [s].
double prediction_step(FirmwareKind kind) {
  switch (kind) {
    case FirmwareKind::px4:
      return 0.010;
    case FirmwareKind::ardupilot:
      return 0.012;
    case FirmwareKind::crazyflie:
      return 0.001;
    case FirmwareKind::betaflight:
      break;
  }
  throw InvalidInput(to_string(kind),
                     "noise of the estimator was asked for, expected none, because this firmware "
                     "has no estimator of position");
}

class NoiseWriter {
 public:
  explicit NoiseWriter(const Firmware& firmware)
      : facts_(parameter_facts(firmware)), step_(prediction_step(firmware.kind)) {}

  /// Sets a parameter from a white noise or a random walk that acts in each prediction step.
  void density(const std::string& name, double density) { set(name, filter_noise(density, step_)); }
  void variance(const std::string& name, double variance) { set(name, std::sqrt(variance)); }
  template <class Aid>
  void variance_of(const std::string& name, const std::optional<Aid>& aid) {
    if (!aid) return;
    if constexpr (requires { aid->aid; })
      variance(name, aid->aid.variance);
    else
      variance(name, aid->variance);
  }

  FirmwareParameters result;

 private:
  void set(const std::string& name, double value) {
    const auto facts = std::find_if(facts_.begin(), facts_.end(),
                                    [&](const ParameterFacts& one) { return one.name == name; });
    const double low = facts->min.value_or(0), high = facts->max.value_or(value);
    const double held = std::clamp(value, low, std::max(low, high));
    if (held != value)
      result.notes.push_back(
          fmt::format("{} would be {:.3g} {}, limited to {:.3g}, the end of the "
                      "published range",
                      name, value, facts->unit, held));
    // The defaults include the effect of airframe vibration on the sensors.
    constexpr double kMuchLess = 0.2;
    if (held < kMuchLess * facts->usual)
      result.notes.push_back(fmt::format(
          "{} is {:.3g} {}, much less than the default of {:.3g}, which allows for vibration: "
          "inspect the innovations of a flight before you rely on it",
          name, held, facts->unit, facts->usual));
    result.values.push_back({name, held});
  }

  std::vector<ParameterFacts> facts_;
  double step_;
};

}  // namespace

FirmwareParameters noise_parameters(const Firmware& firmware, const GeneralFilterSettings& filter) {
  NoiseWriter write(firmware);
  const double gyroscope = filter.gyroscope.density.maxCoeff();
  const double accelerometer = filter.accelerometer.density.maxCoeff();
  const auto if_known = [](double value, const auto& use) {
    if (value > 0) use(value);
  };
  switch (firmware.kind) {
    case FirmwareKind::px4:
      if_known(gyroscope, [&](double n) { write.density("EKF2_GYR_NOISE", n); });
      if_known(accelerometer, [&](double n) { write.density("EKF2_ACC_NOISE", n); });
      if_known(filter.gyroscope.walk, [&](double n) { write.density("EKF2_GYR_B_NOISE", n); });
      if_known(filter.accelerometer.walk, [&](double n) { write.density("EKF2_ACC_B_NOISE", n); });
      write.variance_of("EKF2_BARO_NOISE", filter.pressure);
      write.variance_of("EKF2_RNG_NOISE", filter.range);
      write.variance_of("EKF2_GPS_P_NOISE", filter.gps_position);
      write.variance_of("EKF2_GPS_V_NOISE", filter.gps_velocity);
      write.variance_of("EKF2_HEAD_NOISE", filter.heading);
      write.variance_of("EKF2_OF_N_MIN", filter.flow);
      write.variance_of("EKF2_EVP_NOISE", filter.vision);
      break;
    case FirmwareKind::ardupilot:
      if_known(gyroscope, [&](double n) { write.density("EK3_GYRO_P_NSE", n); });
      if_known(accelerometer, [&](double n) { write.density("EK3_ACC_P_NSE", n); });
      if_known(filter.gyroscope.walk, [&](double n) { write.density("EK3_GBIAS_P_NSE", n); });
      if_known(filter.accelerometer.walk, [&](double n) { write.density("EK3_ABIAS_P_NSE", n); });
      write.variance_of("EK3_ALT_M_NSE", filter.pressure);
      write.variance_of("EK3_RNG_M_NSE", filter.range);
      write.variance_of("EK3_POSNE_M_NSE", filter.gps_position);
      write.variance_of("EK3_VELNE_M_NSE", filter.gps_velocity);
      write.variance_of("EK3_VELD_M_NSE", filter.gps_velocity);
      write.variance_of("EK3_YAW_M_NSE", filter.heading);
      write.variance_of("EK3_FLOW_M_NSE", filter.flow);
      break;
    case FirmwareKind::crazyflie:
      if_known(accelerometer, [&](double n) { write.density("kalman.pNAcc_xy", n); });
      if_known(accelerometer, [&](double n) { write.density("kalman.pNAcc_z", n); });
      if_known(gyroscope, [&](double n) { write.density("kalman.mNGyro_rollpitch", n); });
      if_known(gyroscope, [&](double n) { write.density("kalman.mNGyro_yaw", n); });
      write.variance_of("kalman.mNBaro", filter.pressure);
      break;
    case FirmwareKind::betaflight:
      break;
  }
  return write.result;
}

bool is_noise_parameter(const std::string& name) {
  return name.starts_with("EKF2_") || name.starts_with("EK3_") || name.starts_with("kalman.");
}

}  // namespace quadtune
