// SPDX-License-Identifier: Apache-2.0
// The estimator of an autopilot board: a general filter that runs more slowly than the rate loop,
// with the means of the samples since its last step.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "quadtune/estimation/general_filter.hpp"
#include "quadtune/workbench/firmware/firmware_law.hpp"

namespace quadtune {
namespace {

/// Approximate rate of the filter [Hz].
constexpr double kFilterRate = 200;

/// Averages the fresh samples of an inertial sensor.
struct MeanReading {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;

  void take(const Sample<Eigen::Vector3d, double>& sample) {
    if (!sample.fresh || !sample.value.allFinite()) return;
    sum += sample.value;
    ++count;
  }
  /// Stores the mean in a sample, and restarts.
  void give(Sample<Eigen::Vector3d, double>& sample) {
    sample.fresh = count > 0;
    if (count > 0) sample.value = sum / count;
    *this = {};
  }
};

/// Marks a sample as fresh if one arrived since the last step of the filter.
template <class Value>
void remember(Sample<Value, double>& sample, bool& came) {
  sample.fresh = std::exchange(came, false) || sample.fresh;
}

class BoardEstimator final : public FlightEstimator {
 public:
  BoardEstimator(GeneralFilterSettings settings, GeneralFilterState<double> state, int every)
      : settings_(std::move(settings)), state_(std::move(state)), every_(every) {}

  [[nodiscard]] Estimate<double> update(const EstimatorInput& input) override {
    const SensorFrame<double>& now = input.sensors;
    rates_.take(now.rates);
    force_.take(now.specific_force);
    if (now.rates.fresh && now.rates.value.allFinite())
      newest_rates_ = now.rates.value.cwiseQuotient(settings_.gyroscope.scale);
    if (count_++ % every_ == 0) {
      SensorFrame<double> frame = now;
      rates_.give(frame.rates);
      force_.give(frame.specific_force);
      remember(frame.magnetic_field, came_.magnetic_field);
      remember(frame.pressure, came_.pressure);
      remember(frame.sonar, came_.sonar);
      remember(frame.flow, came_.flow);
      remember(frame.gps_position, came_.gps_position);
      remember(frame.gps_velocity, came_.gps_velocity);
      remember(frame.vision, came_.vision);
      estimate_ = step<double>(settings_, state_, frame, input.on_ground);
    } else {
      came_.magnetic_field |= now.magnetic_field.fresh;
      came_.pressure |= now.pressure.fresh;
      came_.sonar |= now.sonar.fresh;
      came_.flow |= now.flow.fresh;
      came_.gps_position |= now.gps_position.fresh;
      came_.gps_velocity |= now.gps_velocity.fresh;
      came_.vision |= now.vision.fresh;
      // They were counted when the filter ran.
      estimate_.innovation_square = estimate_.innovation_freedom = 0;
    }
    if (!input.on_ground) estimate_.x.segment<3>(kRates) = newest_rates_ - state_.gyro_bias;
    return estimate_;
  }

 private:
  struct Came {
    bool magnetic_field = false, pressure = false, sonar = false, flow = false,
         gps_position = false, gps_velocity = false, vision = false;
  };

  GeneralFilterSettings settings_;
  GeneralFilterState<double> state_;
  int every_;
  long count_ = 0;
  MeanReading rates_, force_;
  Came came_;
  Eigen::Vector3d newest_rates_ = Eigen::Vector3d::Zero();
  Estimate<double> estimate_;
};

/// One sensor sample per sample of the board, with the noise density of the vehicle file.
void read_each_sample(SensorFaults& faults, double rate) {
  faults.noise *= std::sqrt(rate / faults.rate);
  faults.rate = rate;
}

void read_each_sample(Sensors& sensors, double rate) {
  if (sensors.gyroscope) read_each_sample(*sensors.gyroscope, rate);
  if (sensors.accelerometer) read_each_sample(*sensors.accelerometer, rate);
}

/// The settings of a filter that runs once every `every` samples.
GeneralFilterSettings board_filter(FlightSetup setup, double dt, int every) {
  std::get<OwnController>(setup.controller).dt = dt * every;
  read_each_sample(setup.vehicle.sensors, 1 / (dt * every));
  // Numbers of a file belong to its period: values that depend on it are derived from the
  // sensors.
  GeneralFilterSettings settings = general_filter_settings(setup);
  setup.general_filter.reset();
  const GeneralFilterSettings of_sensors = general_filter_settings(setup);
  settings.gyroscope.lag = of_sensors.gyroscope.lag;
  settings.gyroscope.variance = of_sensors.gyroscope.variance;
  settings.accelerometer.lag = of_sensors.accelerometer.lag;
  settings.accelerometer.variance = of_sensors.accelerometer.variance;
  // The mean of several samples corresponds to their midpoint in time.
  settings.gyroscope.lag += 0.5 * (every - 1) * dt;
  settings.accelerometer.lag += 0.5 * (every - 1) * dt;
  validate(settings, "estimator general");
  return settings;
}

}  // namespace

void fly_on_board(FlightSetup& setup) {
  const double dt = control_period(setup);
  const bool filters = setup.estimator == EstimatorKind::general;
  const int every = std::max(1, static_cast<int>(std::lround(1 / (kFilterRate * dt))));
  if (filters) {
    const GeneralFilterSettings settings = board_filter(setup, dt, every);
    const bool moves =
        setup.mission.start.in_air || std::holds_alternative<Carried>(setup.mission.kind);
    const Sensors sensors = sensors_of(setup);
    setup.own_estimator = {
        "general", [settings, every, moves, sensors](const EstimatorStart& start) {
          GeneralFilterState<double> state = general_filter_start<double>(settings, start.state);
          // Its biases were estimated before the flight, as with the general filter of other laws.
          if (moves && sensors.gyroscope && sensors.accelerometer)
            set_biases<double>(
                state, sensors.gyroscope->bias.cwiseQuotient(settings.gyroscope.scale),
                sensors.accelerometer->bias.cwiseQuotient(settings.accelerometer.scale));
          if (moves && settings.pressure && sensors.barometer)
            state.pressure_height = sensors.barometer->faults.bias(0) /
                                    (settings.pressure->slope() * settings.pressure->aid.scale);
          return std::make_unique<BoardEstimator>(settings, state, every);
        }};
    setup.estimator = EstimatorKind::own;
  }
  read_each_sample(setup.vehicle.sensors, 1 / dt);
  if (setup.flown) read_each_sample(setup.flown->sensors, 1 / dt);
}

}  // namespace quadtune
