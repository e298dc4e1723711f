// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flight/sensor_bound.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

constexpr int kOutputs = 400;
constexpr int kStarts = 16;

/// The variance of a sample, including quantization, if no sample is lost.
double variance_of(const SensorFaults& faults, double noise) {
  const double rounding = faults.quantum * faults.quantum / 12;
  return (noise * noise + rounding) / (1 - faults.dropout);
}

bool present(const SensorFaults& faults) { return faults.rate > 0 && faults.dropout < 1; }

LinearSensor sensor_of(const SensorFaults& faults, double noise, Eigen::VectorXd H,
                       double unit = 1) {
  return {faults.rate, faults.delay, std::move(H), variance_of(faults, noise) * unit * unit};
}

Eigen::VectorXd unit(int n, int i) { return Eigen::VectorXd::Unit(n, i); }

double square(double x) { return x * x; }

/// Variance of the bias after averaging over `calibration` seconds; without averaging, that of the
/// bias drawn at turn-on.
double bias_variance(const SensorFaults& faults, int axis, double calibration) {
  const double samples = faults.rate * calibration, drawn = square(faults.turn_on_bias(axis));
  if (!(samples > 0)) return drawn;
  const double mean = variance_of(faults, faults.noise(axis)) / std::max(samples, 1.0);
  return mean + square(faults.bias_walk(axis)) * calibration / 3;
}

double bias_walk(const SensorFaults& faults, int axis, double allowed) {
  return square(std::max(faults.bias_walk(axis), allowed));
}

Eigen::Index add_state(ErrorModel& model, double P0, double Q, double decay) {
  const Eigen::Index n = model.A.rows();
  for (Eigen::MatrixXd* matrix : {&model.A, &model.Q, &model.P0})
    matrix->conservativeResizeLike(Eigen::MatrixXd::Zero(n + 1, n + 1));
  model.decay.conservativeResizeLike(Eigen::VectorXd::Zero(n + 1));
  for (LinearSensor& sensor : model.sensors)
    sensor.H.conservativeResizeLike(Eigen::VectorXd::Zero(n + 1));
  model.P0(n, n) = P0;
  model.Q(n, n) = Q;
  model.decay(n) = decay;
  return n;
}

/// Adds a sensor that measures H x, with its own slow errors as additional states.
/// @param sensor  H for the states of the motion
/// @param unit   ratio of the unit of H x to that of the faults
/// @param least  lower limits that the filter assumes: standard deviation of the bias at turn-on
///               and its walk, in units of H x
void add_sensor(ErrorModel& model, const SensorFaults& faults, int axis, LinearSensor sensor,
                double unit, std::pair<double, double> min = {0, 0}) {
  const double turn_on = std::max(std::abs(unit) * faults.turn_on_bias(axis), min.first);
  const double walk = std::max(std::abs(unit) * faults.bias_walk(axis), min.second);
  const double correlated = std::abs(unit) * faults.correlated_noise(axis);
  sensor.H.conservativeResizeLike(Eigen::VectorXd::Zero(model.A.rows()));
  model.sensors.push_back(std::move(sensor));
  const auto shows = [&](Eigen::Index state) { model.sensors.back().H(state) = 1; };
  if (turn_on > 0 || walk > 0) shows(add_state(model, square(turn_on), square(walk), 0));
  if (correlated > 0)
    shows(add_state(model, square(correlated), 2 * square(correlated) / faults.correlation,
                    1 / faults.correlation));
}

/// While the vehicle is stationary, its motion is known and the sensors reveal their slow errors.
/// @param motion  number of the first states, those of the motion and the inertial sensors
void stand(ErrorModel& model, Eigen::Index motion, double duration) {
  const Eigen::Index slow = model.A.rows() - motion;
  if (slow == 0 || !(duration > 0)) return;
  ErrorModel standing;
  standing.A.setZero(slow, slow);
  standing.Q = model.Q.bottomRightCorner(slow, slow);
  standing.P0 = model.P0.bottomRightCorner(slow, slow);
  standing.decay = model.decay.tail(slow);
  for (LinearSensor sensor : model.sensors) {
    sensor.H = sensor.H.tail(slow).eval();
    if (!sensor.H.isZero(0)) standing.sensors.push_back(std::move(sensor));
  }
  model.P0.bottomRightCorner(slow, slow) = best_filter_covariance(standing, duration);
}

/// The noise of a sample that is held for 1/rate, as a spectral density [unit² s].
double density(const SensorFaults& faults, double noise) {
  return variance_of(faults, noise) / faults.rate;
}

/// The velocity errors, with the sample clock of the position.
SensorFaults velocity_of(const GpsSensor& gps) {
  SensorFaults velocity;
  velocity.rate = gps.position.rate;
  velocity.delay = gps.position.delay;
  velocity.dropout = gps.position.dropout;
  velocity.noise = gps.velocity_noise;
  return velocity;
}

bool sees_flow(const Sensors& sensors, const SensorBoundOptions& options) {
  return sensors.flow && present(sensors.flow->faults) &&
         options.height >= sensors.flow->min_height && options.height <= sensors.flow->max_height;
}

bool hears_echo(const Sensors& sensors, const SensorBoundOptions& options) {
  return sensors.sonar && present(sensors.sonar->faults) &&
         options.height >= sensors.sonar->min_range && options.height <= sensors.sonar->max_range;
}

/// One horizontal axis: position, velocity, tilt, bias of the gyroscope, bias of the accelerometer.
///
///     p' = v,  v' = -g θ - b_a - n_a,  θ' = -b_g - n_g
///
/// @param axis  0 north, 1 east; for east, tilt and b_g have the opposite signs
ErrorModel horizontal_model(const Sensors& sensors, const SensorBoundOptions& options, int axis) {
  const SensorFaults& gyro = *sensors.gyroscope;
  const SensorFaults& force = *sensors.accelerometer;
  const double gyro_noise = gyro.noise(1 - axis), force_noise = force.noise(axis);
  ErrorModel model;
  model.A.setZero(5, 5);
  model.A(0, 1) = 1;
  model.A(1, 2) = -options.gravity;
  model.A(1, 4) = -1;
  model.A(2, 3) = -1;
  model.Q.setZero(5, 5);
  model.Q(1, 1) = density(force, force_noise);
  model.Q(2, 2) = density(gyro, gyro_noise);
  model.Q(3, 3) = bias_walk(gyro, 1 - axis, options.allowed.gyro_walk);
  model.Q(4, 4) = bias_walk(force, axis, options.allowed.force_walk);
  model.P0.setZero(5, 5);
  const StartDeviations& start = options.allowed.start;
  model.P0.diagonal() << square(start.position), square(start.velocity), square(start.tilt),
      square(start.gyro_bias) + bias_variance(gyro, 1 - axis, options.calibration),
      square(start.force_bias) + bias_variance(force, axis, options.calibration);
  if (sees_flow(sensors, options)) {
    // -h (flow + c gyro) = v - h c b_g + noise of both
    const FlowSensor& flow = *sensors.flow;
    const double tangent = std::tan(axis == 0 ? flow.half_field_x : flow.half_field_y);
    const double c = 1 + tangent * tangent / 3, h = options.height;
    Eigen::VectorXd H = unit(5, 1);
    H(3) = -h * c;
    const double noise = std::hypot(flow.faults.noise(axis), flow.noise_per_height * h);
    LinearSensor sensor = sensor_of(flow.faults, noise, H, h);
    sensor.R += h * h * c * c * variance_of(gyro, gyro_noise) / (1 - flow.faults.dropout);
    add_sensor(model, flow.faults, axis, std::move(sensor), h);
  }
  if (sensors.gps && present(sensors.gps->position)) {
    const SensorFaults& gps = sensors.gps->position;
    add_sensor(model, gps, axis, sensor_of(gps, gps.noise(axis), unit(5, 0)), 1);
    const SensorFaults velocity = velocity_of(*sensors.gps);
    add_sensor(model, velocity, axis, sensor_of(velocity, velocity.noise(axis), unit(5, 1)), 1);
  }
  if (sensors.vision && present(*sensors.vision))
    add_sensor(model, *sensors.vision, axis,
               sensor_of(*sensors.vision, sensors.vision->noise(axis), unit(5, 0)), 1);
  stand(model, 5, options.begin);
  return model;
}

/// Height, climb rate, bias of the accelerometer: p' = v, v' = -b_a - n_a.
ErrorModel vertical_model(const Sensors& sensors, const SensorBoundOptions& options) {
  const SensorFaults& force = *sensors.accelerometer;
  ErrorModel model;
  model.A.setZero(3, 3);
  model.A(0, 1) = 1;
  model.A(1, 2) = -1;
  model.Q.setZero(3, 3);
  model.Q(1, 1) = density(force, force.noise(2));
  model.Q(2, 2) = bias_walk(force, 2, options.allowed.force_walk);
  model.P0.setZero(3, 3);
  const StartDeviations& start = options.allowed.start;
  model.P0.diagonal() << square(start.position), square(start.velocity),
      square(start.force_bias) + bias_variance(force, 2, options.calibration);
  const auto add = [&](const SensorFaults& faults, int axis, Eigen::VectorXd H) {
    add_sensor(model, faults, axis, sensor_of(faults, faults.noise(axis), std::move(H)), 1);
  };
  if (hears_echo(sensors, options)) add(sensors.sonar->faults, 0, unit(3, 0));
  if (sensors.barometer && present(sensors.barometer->faults)) {
    const BarometerSensor& barometer = *sensors.barometer;
    const double fall = std::isfinite(barometer.fall) ? std::abs(barometer.fall)
                                                      : options.air_density * options.gravity;
    // The pressure at the ground is unknown.
    if (fall > 0)
      add_sensor(model, barometer.faults, 0,
                 sensor_of(barometer.faults, barometer.faults.noise(0), unit(3, 0), 1 / fall),
                 1 / fall, {options.allowed.start.pressure_height, options.allowed.pressure_walk});
  }
  if (sensors.gps && present(sensors.gps->position)) {
    add(sensors.gps->position, 2, unit(3, 0));
    add(velocity_of(*sensors.gps), 2, unit(3, 1));
  }
  if (sensors.vision && present(*sensors.vision)) add(*sensors.vision, 2, unit(3, 0));
  stand(model, 3, options.begin);
  return model;
}

/// Heading and the gyroscope's bias: ψ' = -b_g - n_g.
ErrorModel heading_model(const Sensors& sensors, const SensorBoundOptions& options) {
  const SensorFaults& gyro = *sensors.gyroscope;
  ErrorModel model;
  model.A.setZero(2, 2);
  model.A(0, 1) = -1;
  model.Q.setZero(2, 2);
  model.Q(0, 0) = density(gyro, gyro.noise(2));
  model.Q(1, 1) = bias_walk(gyro, 2, options.allowed.gyro_walk);
  model.P0.setZero(2, 2);
  const StartDeviations& start = options.allowed.start;
  model.P0.diagonal() << square(start.yaw),
      square(start.gyro_bias) + bias_variance(gyro, 2, options.calibration);
  if (sensors.magnetometer && present(*sensors.magnetometer) && options.field > 0)
    // Across the field, B sin ψ.
    add_sensor(model, *sensors.magnetometer, 1,
               sensor_of(*sensors.magnetometer, sensors.magnetometer->noise(1), unit(2, 0),
                         1 / options.field),
               1 / options.field);
  stand(model, 2, options.begin);
  return model;
}

void require_positive(double value, const char* name, const char* si) {
  if (!(value > 0) || !std::isfinite(value))
    throw InvalidInput("sensor bound",
                       fmt::format("the {} is {} {}, expected more than 0", name, value, si));
}

std::vector<std::string> used_by(const Sensors& sensors, const SensorBoundOptions& options) {
  std::vector<std::string> used = {"gyroscope", "accelerometer"};
  const auto add = [&](bool has, const char* name) {
    if (has) used.emplace_back(name);
  };
  add(sees_flow(sensors, options), "optical flow");
  add(hears_echo(sensors, options), "sonar");
  add(sensors.barometer && present(sensors.barometer->faults), "barometer");
  add(sensors.magnetometer && present(*sensors.magnetometer), "magnetometer");
  add(sensors.gps && present(sensors.gps->position), "GPS");
  add(sensors.vision && present(*sensors.vision), "vision");
  return used;
}

}  // namespace

std::vector<double> bound_times(double duration) {
  const double spacing = duration / (kOutputs - 0.5);
  std::vector<double> times;
  times.reserve(kOutputs);
  for (int k = 0; k < kOutputs; ++k) times.push_back((k + 0.5) * spacing);
  return times;
}

std::optional<SensorBound> sensor_bound(const Sensors& sensors, const SensorBoundOptions& options) {
  require_positive(options.height, "height", "m");
  require_positive(options.gravity, "gravity", "m/s2");
  require_positive(options.air_density, "air density", "kg/m3");
  require_positive(options.duration, "duration", "s");
  const DriftAllowance& allowed = options.allowed;
  const StartDeviations& start = allowed.start;
  for (const double deviation : {allowed.gyro_walk, allowed.force_walk, allowed.pressure_walk,
                                 start.position, start.velocity, start.tilt, start.yaw,
                                 start.gyro_bias, start.force_bias, start.pressure_height})
    if (!(deviation >= 0) || !std::isfinite(deviation))
      throw InvalidInput(
          "sensor bound",
          fmt::format("an allowance for drift is {}, expected 0 or more and finite", deviation));
  if (!(options.begin >= 0 && options.calibration >= 0 && options.field >= 0) ||
      !std::isfinite(options.begin + options.calibration + options.field))
    throw InvalidInput("sensor bound",
                       "begin, calibration or field is negative or not finite, expected 0 or more");
  if (!sensors.gyroscope || !sensors.accelerometer || !present(*sensors.gyroscope) ||
      !present(*sensors.accelerometer))
    return std::nullopt;
  SensorBound bound;
  bound.used = used_by(sensors, options);
  bound.time = bound_times(options.duration);
  const double spacing = bound.time[1] - bound.time[0];
  std::vector<std::size_t> starts;
  const double flown = std::max(options.duration - options.begin, 0.0);
  for (int j = 0; j < kStarts; ++j) {
    const double time = options.begin + flown * (j + 0.5) / kStarts;
    const auto k = static_cast<std::size_t>(
        std::clamp(std::lround(time / spacing - 0.5), 0L, long{kOutputs - 1}));
    if (starts.empty() || k > starts.back()) starts.push_back(k);
  }
  const auto error = [&](const ErrorModel& model) {
    return best_filter_error(model, options.begin, bound.time, starts);
  };
  const ErrorModel north = horizontal_model(sensors, options, 0);
  const ErrorModel east = horizontal_model(sensors, options, 1);
  bound.north = error(north);
  const auto same = [](const ErrorModel& a, const ErrorModel& b) {
    if (a.A.rows() != b.A.rows() || a.Q != b.Q || a.P0 != b.P0 || a.decay != b.decay) return false;
    for (std::size_t i = 0; i < a.sensors.size(); ++i)
      if (a.sensors[i].R != b.sensors[i].R || a.sensors[i].H != b.sensors[i].H) return false;
    return true;
  };
  bound.east = same(north, east) ? bound.north : error(east);
  bound.height = error(vertical_model(sensors, options));
  bound.heading = error(heading_model(sensors, options));
  return bound;
}

}  // namespace quadtune
