// SPDX-License-Identifier: Apache-2.0
/// Accuracy bounds of sensors, compared with closed forms, the Riccati solver and published
/// numbers.
#include "quadtune/workbench/flight/sensor_bound.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/synthesis/kalman.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;

std::vector<double> middles(double rate, int count) {
  std::vector<double> times;
  times.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) times.push_back((k + 0.5) / rate);
  return times;
}

/// p' = v, v' = w with the spectral density q.
ErrorModel double_integrator(double q) {
  ErrorModel model;
  model.A = Eigen::Matrix2d{{0, 1}, {0, 0}};
  model.Q = Eigen::Matrix2d{{0, 0}, {0, q}};
  model.P0 = Eigen::Matrix2d::Zero();
  return model;
}

double last(const ErrorCovariance& error) { return error.variance(error.variance.size() - 1); }

// Without a sensor the variances are the integrals: q t, and q t³/3 after one more integrator.
TEST(BestFilter, IntegratesWhatNoSensorSees) {
  const double q = 0.3, t = 7;
  EXPECT_NEAR(last(best_filter_error(double_integrator(q), 0, {t}, {})), q * t * t * t / 3, 1e-9);
  // A bias with standard deviation b, through four integrators: b t²/2 of position through tilt,
  // times g.
  ErrorModel tilt;
  tilt.A.setZero(4, 4);
  tilt.A(0, 1) = 1;
  tilt.A(1, 2) = -9.81;
  tilt.A(2, 3) = -1;
  tilt.Q.setZero(4, 4);
  tilt.Q(2, 2) = 1e-4;
  tilt.P0.setZero(4, 4);
  tilt.P0(3, 3) = 0.01 * 0.01;
  const double of_noise = 1e-4 * 9.81 * 9.81 * std::pow(t, 5) / 20;
  const double of_bias = std::pow(9.81 * 0.01 * t * t * t / 6, 2);
  EXPECT_NEAR(last(best_filter_error(tilt, 0, {t}, {})), of_noise + of_bias, 1e-9);
}

// Dead reckoning: with a velocity measured with the density r, the position drifts by r t.
TEST(BestFilter, DeadReckoningWalksByTheSensorsNoise) {
  const double rate = 200, R = 0.04;
  ErrorModel model = double_integrator(0.01);
  model.sensors.push_back({rate, 0, Eigen::Vector2d(0, 1), R});
  const ErrorCovariance error = best_filter_error(model, 0, {20, 120}, {});
  EXPECT_NEAR((error.variance(1) - error.variance(0)) / 100, R / rate, 0.01 * R / rate);
}

// A random walk of q per sample, measured with R: M = (q + √(q² + 4 q R))/2 before a sample, M - q
// after it.
TEST(BestFilter, ReachesTheScalarRiccatiSolution) {
  const double rate = 50, R = 0.2, q = 0.01;
  ErrorModel model;
  model.A.setZero(2, 2);
  model.Q = Eigen::Matrix2d{{q * rate, 0}, {0, 0}};
  model.P0.setZero(2, 2);
  model.sensors.push_back({rate, 0, Eigen::Vector2d(1, 0), R});
  const double M = (q + std::sqrt(q * q + 4 * q * R)) / 2;
  const std::vector<double> times = middles(rate, 2000);
  EXPECT_NEAR(last(best_filter_error(model, 0, times, {})), M - q + q / 2, 1e-12);
  // A delay adds the random walk during this time.
  model.sensors[0].delay = 0.3;
  EXPECT_NEAR(last(best_filter_error(model, 0, times, {})), M - q + q / 2 + q * rate * 0.3, 1e-12);
}

TEST(BestFilter, AgreesWithTheRiccatiSolver) {
  for (const double h : {0.02, 0.5}) {
    const double q = 0.7, R = 0.05;
    ErrorModel model = double_integrator(q);
    model.sensors.push_back({1 / h, 0, Eigen::Vector2d(1, 0), R});
    DiscreteLti sampled;
    sampled.A = Eigen::Matrix2d{{1, h}, {0, 1}};
    sampled.C = Eigen::RowVector2d(1, 0);
    sampled.dt = h;
    KalmanNoise noise;
    noise.Q = q * Eigen::Matrix2d{{h * h * h / 3, h * h / 2}, {h * h / 2, h}};
    noise.R = Eigen::MatrixXd::Constant(1, 1, R);
    const KalmanResult steady = kalman(sampled, noise);
    ASSERT_TRUE(steady.solved()) << steady.culprit;
    const ErrorCovariance error = best_filter_error(model, 0, {1000 * h}, {});
    EXPECT_NEAR(last(error), steady.Z(0, 0), 1e-9 * steady.Z(0, 0)) << h;
  }
}

/// An error with the time constant 1/decay, stationary with the variance s.
ErrorModel forgetting(double s, double decay) {
  ErrorModel model;
  model.A.setZero(1, 1);
  model.Q.setConstant(1, 1, 2 * s * decay);
  model.P0.setZero(1, 1);
  model.decay.setConstant(1, decay);
  return model;
}

TEST(BestFilter, ErrorsThatDecayBecomeStationary) {
  const double s = 0.4, decay = 0.2;
  for (const double t : {0.5, 3.0, 40.0}) {
    const double expected = s * (1 - std::exp(-2 * decay * t));
    EXPECT_NEAR(last(best_filter_error(forgetting(s, decay), 0, {t}, {})), expected, 1e-12);
    EXPECT_NEAR(best_filter_covariance(forgetting(s, decay), t)(0, 0), expected, 1e-12);
  }
}

// A position that only one sensor measures is known as accurately as the persistent error of this
// sensor.
TEST(BestFilter, CannotTellAPositionFromAnErrorThatStaysAlike) {
  const double s = 0.4, R = 1e-6;
  ErrorModel model;
  model.A.setZero(2, 2);
  model.Q = Eigen::Matrix2d{{1e3, 0}, {0, 2 * s / 30}};
  model.P0 = Eigen::Matrix2d{{1e6, 0}, {0, s}};
  model.decay = Eigen::Vector2d(0, 1.0 / 30);
  model.sensors.push_back({100, 0, Eigen::Vector2d(1, 1), R});
  EXPECT_NEAR(best_filter_covariance(model, 20)(0, 0), s + R, 1e-3 * s);
}

// N samples of a constant with prior variance P: 1/(1/P + N/R).
TEST(BestFilter, AveragesAConstant) {
  ErrorModel model;
  model.A = model.Q = Eigen::MatrixXd::Zero(1, 1);
  model.P0.setConstant(1, 1, 4);
  model.sensors.push_back({50, 0, Eigen::VectorXd::Ones(1), 0.09});
  EXPECT_NEAR(best_filter_covariance(model, 2)(0, 0), 1 / (1 / 4.0 + 101 / 0.09), 1e-15);
  model.sensors[0].delay = 1;  // those of the last second have not arrived
  EXPECT_NEAR(best_filter_covariance(model, 2)(0, 0), 1 / (1 / 4.0 + 51 / 0.09), 1e-15);
}

TEST(BestFilter, RefusesWhatIsNoModel) {
  ErrorModel model = double_integrator(1);
  model.sensors.push_back({0, 0, Eigen::Vector2d(1, 0), 1});
  const auto message = [&] {
    try {
      (void)best_filter_error(model, 0, {1}, {});
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message(), "error model: the rate of a sensor is 0 Hz, expected more than 0");
  model.sensors[0].rate = 1;
  model.sensors[0].H = Eigen::Vector3d(1, 0, 0);
  EXPECT_THAT(message(), HasSubstr("H of a sensor has 3 entries"));
  model = double_integrator(1);
  model.decay = Eigen::Vector2d(0, 1);
  EXPECT_EQ(message(), "error model: state 2 decays and is coupled with another by A");
  model.decay = Eigen::Vector3d::Zero();
  EXPECT_THAT(message(), HasSubstr("decay has 3 entries, expected 2 or none"));
  model = {};
  EXPECT_THAT(message(), HasSubstr("it has 0 states, expected 1 to 12"));
}

/// The uquad's sensors as in an independent computation: without noise of the accelerometer.
Sensors satellite(double rate, double noise, double velocity_noise, double delay) {
  Sensors sensors = load_vehicle("uquad").sensors;
  sensors.accelerometer->noise.setZero();
  sensors.gps->position.rate = rate;
  sensors.gps->position.noise.setConstant(noise);
  sensors.gps->position.delay = delay;
  sensors.gps->velocity_noise.setConstant(velocity_noise);
  return sensors;
}

/// Without the allowances of the filter beyond the file.
SensorBoundOptions of_the_file_alone() {
  SensorBoundOptions options;
  options.allowed = {0, 0, 0, {0, 0, 0, 0, 0, 0, 0}};
  return options;
}

double horizontal_rms(const Sensors& sensors) {
  SensorBoundOptions options = of_the_file_alone();
  options.duration = 100;
  const std::optional<SensorBound> bound = sensor_bound(sensors, options);
  double squares = 0;
  int count = 0;
  for (std::size_t k = 0; k < bound->time.size(); ++k) {
    if (bound->time[k] < 10) continue;
    const auto i = static_cast<Eigen::Index>(k);
    squares += bound->north.variance(i) + bound->east.variance(i);
    ++count;
  }
  return std::sqrt(squares / count);
}

// The numbers come from an independent computation of the same covariance, with a clone state for
// the delay.
TEST(SensorBound, IsThatOfAnIndependentFilter) {
  EXPECT_NEAR(horizontal_rms(satellite(1, 0.5, 0.1, 0.2)), 0.321, 0.001);
  EXPECT_NEAR(horizontal_rms(satellite(1, 0.05, 0.1, 0.2)), 0.074, 0.001);
  EXPECT_NEAR(horizontal_rms(satellite(10, 0.5, 0.1, 0)), 0.099, 0.001);
  EXPECT_NEAR(horizontal_rms(satellite(10, 0.02, 0.03, 0)), 0.010, 0.0005);
}

// The noise h √(σ² + (c σ_g)²) of a velocity sample, with σ_g of the gyroscope.
TEST(SensorBound, FlowIsDeadReckoning) {
  Sensors sensors = load_vehicle("crazyflie").sensors;
  sensors.gps.reset();
  SensorBoundOptions options = of_the_file_alone();
  options.duration = 200;
  for (const double height : {0.5, 1.1, 3.0}) {
    options.height = height;
    const std::optional<SensorBound> bound = sensor_bound(sensors, options);
    const double tangent = std::tan(sensors.flow->half_field_x);
    const double noise = height * std::hypot(0.02, (1 + tangent * tangent / 3) * 0.003);
    const double walk = noise * noise / 60 * (bound->time[399] - bound->time[200]);
    EXPECT_NEAR(bound->north.variance(399) - bound->north.variance(200), walk, 0.02 * walk);
    EXPECT_GT(std::sqrt(last(bound->height)), 0.001);
    EXPECT_LT(std::sqrt(last(bound->height)), 0.01);  // sonar
  }
  // Too low for the flow, and nothing else measures the position: g, the tilt, and time.
  options.height = 0.2;
  options.duration = 20;
  const std::optional<SensorBound> blind = sensor_bound(sensors, options);
  const double tilt = 0.003 * 0.003 / 200, force = 0.05 * 0.05 / 200;
  EXPECT_NEAR(last(blind->north),
              tilt * 9.81 * 9.81 * std::pow(20, 5) / 20 + force * std::pow(20, 3) / 3, 1e-6);
  EXPECT_THAT(blind->used, ::testing::Not(::testing::Contains("optical flow")));
}

// Without a magnetometer the heading drifts by the gyroscope's noise and bias.
TEST(SensorBound, HeadingWithoutMagnetometerDrifts) {
  Sensors sensors = load_vehicle("mambo").sensors;
  SensorBoundOptions options = of_the_file_alone();
  options.duration = 100;
  options.begin = options.calibration = 0.5;
  const std::optional<SensorBound> bound = sensor_bound(sensors, options);
  const double noise = sensors.gyroscope->noise(2), flown = 99.5;
  const double of_noise = noise * noise / 200 * flown;
  const double of_bias = noise * noise / (200 * 0.5) * flown * flown;
  EXPECT_NEAR(last(bound->heading), of_noise + of_bias, 1e-12);
  // A bias with the random walk w adds w² t³/3, from the file or as an allowance of the filter.
  const double walk = 1e-4, of_walk = walk * walk * std::pow(flown, 3) / 3;
  options.allowed.gyro_walk = walk;
  EXPECT_NEAR(last(sensor_bound(sensors, options)->heading), of_noise + of_bias + of_walk, 1e-9);
  options.allowed.gyro_walk = 0.5 * walk;
  sensors.gyroscope->bias_walk.setConstant(walk);
  const double while_standing = walk * walk * 0.5 / 3 * flown * flown;
  EXPECT_NEAR(last(sensor_bound(sensors, options)->heading),
              of_noise + of_bias + of_walk + while_standing, 1e-9);
}

// A satellite position with an error of 1 m over minutes shows the motion, not the position: on the
// ground the error is observed, and it changes from there on.
TEST(SensorBound, ErrorsThatStayAlikeAreSeenOnTheGroundOnly) {
  Sensors sensors = load_vehicle("uquad").sensors;
  SensorBoundOptions options;
  options.duration = 600;
  options.begin = options.calibration = 60;
  const double alone = last(sensor_bound(sensors, options)->north);
  SensorFaults& gps = sensors.gps->position;
  gps.correlated_noise.setConstant(1);
  gps.correlation = 60;
  const SensorBound bound = *sensor_bound(sensors, options);
  // The satellite velocity, which drifts by 0.01 m²/s, averages it over a few minutes.
  EXPECT_GT(last(bound.north), 0.4);
  EXPECT_LT(last(bound.north), 1);
  EXPECT_GT(last(bound.north), 5 * alone);
  // Soon after the take-off it is still the error on the ground: s (1 - e^(-2 t/τ)) at most.
  const auto k = static_cast<Eigen::Index>(std::lround(70 / 600.0 * 400));
  EXPECT_LT(bound.north.variance(k), 1 - std::exp(-2 * 10.0 / 60) + 0.1);
  // A constant error of the satellite position is corrected on the ground for good.
  gps.correlated_noise.setZero();
  gps.turn_on_bias.setConstant(1);
  EXPECT_LT(last(sensor_bound(sensors, options)->north), alone + 0.05);
}

// The pressure at the ground is unknown beforehand: it is averaged while the vehicle is stationary.
TEST(SensorBound, TheBarometersZeroIsFoundOnTheGround) {
  Sensors sensors = load_vehicle("mambo").sensors;
  sensors.sonar.reset();
  ASSERT_TRUE(sensors.barometer);
  SensorBoundOptions options = of_the_file_alone();
  options.duration = 300;
  options.begin = options.calibration = 2;
  const double known = last(sensor_bound(sensors, options)->height);
  options.allowed.start.pressure_height = 2;
  const SensorFaults& faults = sensors.barometer->faults;
  const double slope = options.air_density * options.gravity;
  const double R = (std::pow(faults.noise(0), 2) + std::pow(faults.quantum, 2) / 12) /
                   (1 - faults.dropout) / (slope * slope);
  const double zero = 1 / (1 / 4.0 + (2 * faults.rate + 1) / R);
  EXPECT_NEAR(last(sensor_bound(sensors, options)->height), known + zero, 0.1 * zero);
}

TEST(SensorBound, NeedsInertialSensorsAndSaneOptions) {
  SensorBoundOptions options;
  options.duration = 10;
  Sensors sensors = load_vehicle("mambo").sensors;
  sensors.gyroscope.reset();
  EXPECT_FALSE(sensor_bound(sensors, options));
  options.height = -1;
  EXPECT_THROW((void)sensor_bound(sensors, options), InvalidInput);
  options = {};
  EXPECT_THROW((void)sensor_bound(sensors, options), InvalidInput);  // no duration
}

PlannedFlight planned_flight(const std::string& vehicle, const std::string& mission,
                             const std::string& estimator = "", const std::string& sensors = "") {
  FlightOptions options;
  options.vehicle = vehicle;
  options.mission = mission;
  options.estimator = estimator;
  options.sensors = sensors;
  return plan_flight(options, "test");
}

TEST(MissionBound, IsOfWhatTheMissionJudges) {
  const PlannedFlight uquad = planned_flight("uquad", "hover");
  ASSERT_TRUE(uquad.bound);
  EXPECT_NEAR(uquad.bound->horizontal_rms, 0.321, 0.005);
  EXPECT_NEAR(uquad.bound->options.height, 1.1, 0.01);  // the climb is a little lower
  EXPECT_EQ(uquad.bound->options.begin, 0.5);           // it is stationary at the start
  // Steps of the reference exclude their window; the mean height of a path is that of the path.
  const PlannedFlight step = planned_flight("crazyflie", "step-height");
  ASSERT_TRUE(step.bound);
  EXPECT_GT(step.bound->tracking.rms, 0);
  EXPECT_GT(step.bound->options.height, 1.1);
  EXPECT_LT(step.bound->options.height, 1.6);
  EXPECT_TRUE(planned_flight("crazyflie", "waypoints").bound);
  EXPECT_GT(planned_flight("crazyflie", "waypoints").bound->tracking.rms, 0);
}

// An error of 0.22 m along a step of one metre appears as an overshoot of this size.
TEST(MissionBound, HasTheStepsOfTheMission) {
  const MissionBound north = *planned_flight("uquad", "step-north").bound;
  EXPECT_GT(north.overshoot.rms, 0.1);
  EXPECT_LT(north.overshoot.rms, 0.3);
  EXPECT_GT(north.overshoot.most_rarely, 2 * north.overshoot.rms);
  EXPECT_EQ(north.yaw_overshoot.rms, 0);
  const MissionBound height = *planned_flight("uquad", "step-height").bound;
  EXPECT_GT(height.overshoot.rms, 0);
  EXPECT_LT(height.overshoot.rms, north.overshoot.rms);
  EXPECT_GT(planned_flight("uquad", "step-yaw").bound->yaw_overshoot.rms, 0);
  EXPECT_EQ(planned_flight("uquad", "hover").bound->overshoot.rms, 0);
}

TEST(MissionBound, IsNoneWhereNothingLimitsTheKnowledge) {
  EXPECT_FALSE(planned_flight("uquad", "hover", "truth").bound);
  EXPECT_FALSE(planned_flight("uquad", "hover", "", "ideal").bound);
  EXPECT_FALSE(planned_flight("uquad", "motor-test").bound);
}

}  // namespace
}  // namespace quadtune
