// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/flown_plant.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "quadtune/control/cascade_law.hpp"
#include "quadtune/discretize/delay.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/frequency_response.hpp"
#include "quadtune/internal/in_parallel.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/synthesis/lqr.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Removes random and nonlinear effects; keeps clocks, delays and responses.
void quieten(std::optional<SensorFaults>& sensor) {
  if (!sensor) return;
  sensor->bias.setZero();
  sensor->noise.setZero();
  sensor->scale.setOnes();
  sensor->limit = std::numeric_limits<double>::infinity();
  sensor->quantum = 0;
  sensor->dropout = 0;
}

void quieten(SensorFaults& sensor) {
  std::optional<SensorFaults> one = sensor;
  quieten(one);
  sensor = *one;
}

Vehicle quiet(const std::string& name) {
  Vehicle vehicle = load_vehicle(name);
  Sensors& sensors = vehicle.sensors;
  quieten(sensors.accelerometer);
  quieten(sensors.gyroscope);
  quieten(sensors.magnetometer);
  quieten(sensors.vision);
  if (sensors.barometer) quieten(sensors.barometer->faults);
  if (sensors.sonar) quieten(sensors.sonar->faults);
  if (sensors.flow) quieten(sensors.flow->faults);
  if (sensors.gps) {
    quieten(sensors.gps->position);
    sensors.gps->velocity_noise.setZero();
  }
  return vehicle;
}

/// Moderate gains that suit all vehicles, proportional to mass and inertia.
CascadeGains mild_gains(const Vehicle& vehicle, double dt) {
  const double g = vehicle.gravity, m = vehicle.mass;
  const Eigen::Vector3d J = vehicle.inertia.diagonal();
  const auto loop = [](CascadeAxis axis, double Kp, double Ki, double Kd) {
    PidLoop one = cascade_loop(axis);
    one.Kp = Kp;
    one.Ki = Ki;
    one.Kd = Kd;
    return one;
  };
  CascadeGains gains;
  gains.dt = dt;
  gains.loops = {loop(CascadeAxis::x, -0.6 / g, -0.05 / g, 1.2 / g),
                 loop(CascadeAxis::y, 0.6 / g, 0.05 / g, -1.2 / g),
                 loop(CascadeAxis::pitch, 16 * J.y(), 4 * J.y(), -6 * J.y()),
                 loop(CascadeAxis::roll, 16 * J.x(), 4 * J.x(), -6 * J.x()),
                 loop(CascadeAxis::yaw, 4 * J.z(), 0, -4 * J.z()),
                 loop(CascadeAxis::altitude, 4 * m, 1 * m, -4 * m)};
  return gains;
}

constexpr double kStepAt = 20;   // [s]; the clocks are where they were at 0
constexpr double kLength = 6;    // [s]
constexpr double kSmall = 1e-5;  // what is asked for, so small that squares do not count
constexpr double kHeight = 1.1;  // [m]

FlightSetup flight(const Vehicle& vehicle, EstimatorKind estimator, double dt) {
  FlightSetup setup;
  setup.vehicle = vehicle;
  setup.estimator = estimator;
  if (estimator == EstimatorKind::uquad) setup.uquad_filter = uquad_filter_in_si<double>();
  CascadeController law;
  law.gains = mild_gains(vehicle, dt);
  law.back_calculation = 0;
  setup.controller = law;
  setup.mission = parse_mission(
      fmt::format("name = \"step\"\nduration_s = {}\n[start]\nat = \"air\"\nheight_m = {}\n"
                  "[[references]]\nat_s = 0\nheight_m = {}\n"
                  "[[references]]\nat_s = {}\nnorth_m = {}\neast_m = {}\nheight_m = {}\n"
                  "yaw_rad = {}\n",
                  kStepAt + kLength, kHeight, kHeight, kStepAt, kSmall, -2 * kSmall,
                  kHeight + kSmall, kSmall),
      "step");
  calibrate_flow(setup);
  setup.step = 0.001;
  setup.log = true;
  return setup;
}

/// The estimates of the linear model after the step, (12 × periods).
MatrixXd predicted(const FlightSetup& setup, double dt, const FlownPlant& plant) {
  const auto& c = std::get<CascadeController>(setup.controller);
  const DiscreteLti law = cascade_law(c.gains, c.method);
  const auto steps = static_cast<Index>(std::llround(kLength / dt));
  VectorXd z = VectorXd::Zero(plant.plant.C.cols());
  VectorXd l = VectorXd::Zero(law.A.rows());
  VectorXd in(16);
  in.head<4>() << kSmall, -2 * kSmall, -kSmall, kSmall;
  MatrixXd all(12, steps);
  const auto first = static_cast<std::size_t>(std::llround(kStepAt / dt));
  for (Index k = 0; k < steps; ++k) {
    const std::size_t phase = (first + static_cast<std::size_t>(k)) % plant.plant.period();
    all.col(k) = plant.plant.C * z;
    in.tail<12>() = all.col(k);
    const VectorXd u = law.C * l + law.D * in;
    l = (law.A * l + law.B * in).eval();
    z = (plant.plant.A[phase] * z + plant.plant.B[phase] * u).eval();
  }
  return all;
}

void expect_that_it_flies_as_predicted(const FlightSetup& setup, double dt) {
  FlownPlantOptions options;
  options.dt = dt;
  options.height = kHeight;
  const FlownPlant plant = flown_plant(setup, options);
  const MatrixXd expected = predicted(setup, dt, plant);
  const FlightResult result = fly(setup);
  ASSERT_EQ(result.end, FlightEnd::completed) << result.culprit;
  const auto first = static_cast<std::size_t>(std::llround(kStepAt / dt));
  for (Index i = 0; i < 12; ++i) {
    const std::string& name = ned_convention().states[static_cast<std::size_t>(i)].name;
    const LogColumn* column = result.log.find("estimate." + name);
    ASSERT_NE(column, nullptr) << name;
    const double before = i == 2 ? -kHeight : 0;
    const double size = expected.row(i).cwiseAbs().maxCoeff();
    double worst = 0;
    for (Index k = 0; k < expected.cols(); ++k)
      worst = std::max(worst, std::abs(column->values[first + static_cast<std::size_t>(k)] -
                                       before - expected(i, k)));
    EXPECT_LT(worst, 5e-4 * size) << name << " of " << setup.vehicle.name;
    EXPECT_GT(size, 1e-2 * kSmall) << name;
  }
}

TEST(FlownPlant, MatchesAFlightWithTrueStates) {
  for (const char* name : {"mambo", "crazyflie", "uquad"})
    expect_that_it_flies_as_predicted(flight(quiet(name), EstimatorKind::truth, 0.005), 0.005);
}

/// A vehicle with delayed commands and with rotors that are affected by the air speed.
Vehicle late_and_windy(const std::string& name, double delay) {
  Vehicle vehicle = quiet(name);
  vehicle.motor.delay = delay;
  const double hover =
      std::sqrt(vehicle.mass * vehicle.gravity / (4 * vehicle.rotors[0].thrust_a2));
  for (Rotor& rotor : vehicle.rotors) {
    rotor.drag = 0.3 * vehicle.mass / (4 * hover);    // 0.3 /s
    rotor.inflow = 0.2 * vehicle.mass / (4 * hover);  // 0.2 /s
    rotor.flapping = 0.05 * vehicle.inertia(0, 0) / (4 * hover);
    rotor.position.z() = -0.02;
  }
  return vehicle;
}

TEST(FlownPlant, MatchesAFlightWithDelayedCommandsAndAirSpeedAtTheRotors) {
  expect_that_it_flies_as_predicted(
      flight(late_and_windy("mambo", 0.0037), EstimatorKind::truth, 0.005), 0.005);
  expect_that_it_flies_as_predicted(
      flight(late_and_windy("crazyflie", 0.0125), EstimatorKind::mambo, 0.005), 0.005);
  expect_that_it_flies_as_predicted(
      flight(late_and_windy("mambo", 0.006), EstimatorKind::mambo, 0.005), 0.005);
}

/// The delays of the vehicle and of the options add up; jitter contributes its mean.
TEST(FlownPlant, AddsTheVehiclesDelayToTheOptions) {
  const auto plant = [](double own, double jitter, double more) {
    FlightSetup setup = flight(quiet("mambo"), EstimatorKind::truth, 0.005);
    setup.vehicle.motor.delay = own;
    setup.vehicle.motor.delay_jitter = jitter;
    FlownPlantOptions options;
    options.command_delay = more;
    return flown_plant(setup, options);
  };
  const FlownPlant all = plant(0, 0, 0.0085);
  for (const FlownPlant& same :
       {plant(0.0085, 0, 0), plant(0.006, 0, 0.0025), plant(0.006, 0.005, 0)})
    EXPECT_LT((same.plant.A[0] - all.plant.A[0]).norm() + (same.plant.B[0] - all.plant.B[0]).norm(),
              1e-9);
  EXPECT_EQ(plant(0.006, 0.005, 0).notes,
            std::vector<std::string>{"the jitter of the commands of up to 0.005 s is modeled by "
                                     "its mean, 0.0025 s"});
}

TEST(FlownPlant, UsesTheSlowerOfTwoLagsAndNotesIt) {
  const auto plant = [](double up, double down) {
    FlightSetup setup = flight(quiet("crazyflie"), EstimatorKind::truth, 0.005);
    for (Rotor& rotor : setup.vehicle.rotors) {
      rotor.lag = up;
      rotor.lag_down = down;
    }
    return flown_plant(setup, {});
  };
  const double both = std::nan("");
  EXPECT_EQ(plant(0.02, 0.05).plant.A[0], plant(0.05, both).plant.A[0]);
  EXPECT_EQ(plant(0.05, 0.02).plant.A[0], plant(0.05, both).plant.A[0]);
  EXPECT_TRUE(plant(0.05, 0.05).notes.empty());
  EXPECT_EQ(plant(0.02, 0.05).notes,
            std::vector<std::string>{"the rotors spin up and down with different lags; the model "
                                     "uses the slower one for both directions"});
}

// Satellite fixes at 1 Hz are omitted if optical flow suffices, but not if they are the only source
// of the height, or if the ground is out of range of the flow sensor.
TEST(FlownPlant, KeepsSlowFixesThatAreNeeded) {
  Vehicle vehicle = quiet("mambo");
  vehicle.sensors.gps = GpsSensor();
  vehicle.sensors.gps->position.rate = 1;
  vehicle.sensors.gps->position.noise.setConstant(1);
  vehicle.sensors.gps->velocity_noise.setConstant(0.1);
  const auto period = [](const Vehicle& of, double height) {
    FlownPlantOptions options;
    options.height = height;
    return flown_plant(flight(of, EstimatorKind::general, 0.005), options).plant.period();
  };
  const std::size_t by_flow = period(vehicle, 1.1);
  EXPECT_LT(by_flow, 200U);
  Vehicle low = vehicle;
  low.sensors.flow->max_height = 2;
  EXPECT_EQ(period(low, 1.1), by_flow);
  EXPECT_EQ(period(low, 3) % 200, 0U);
  Vehicle bare = vehicle;
  bare.sensors.sonar.reset();
  bare.sensors.barometer.reset();
  EXPECT_EQ(period(bare, 1.1) % 200, 0U);
}

/// The response of the estimates to a unit of each command in the first period, by period.
MatrixXd pulse_response(const PeriodicLti& plant, Index periods) {
  MatrixXd z = plant.B[0];
  MatrixXd all(plant.C.rows(), plant.B[0].cols() * periods);
  for (Index k = 0; k < periods; ++k) {
    all.middleCols(k * z.cols(), z.cols()) = plant.C * z;
    z = (plant.A[static_cast<std::size_t>(k + 1) % plant.period()] * z).eval();
  }
  return all;
}

// The filter divides readings by the scale factors of their sensors, so these do not matter.
TEST(FlownPlant, DoesNotDependOnTheScaleFactorsOfTheSensors) {
  for (const char* name : {"mambo", "uquad"}) {
    Vehicle vehicle = load_vehicle(name);
    FlownPlantOptions options;
    const auto plant = [&] {
      return flown_plant(flight(vehicle, EstimatorKind::general, options.dt), options).plant;
    };
    // The noise is above the minimum that the filter assumes.
    const auto set = [](SensorFaults& sensor, double noise, double scale) {
      sensor.bias.setZero();
      sensor.noise.setConstant(noise * scale);
      sensor.limit = std::numeric_limits<double>::infinity();
      sensor.quantum = 0;
      sensor.scale.setConstant(scale);
    };
    const auto scaled = [&](double factor) {
      Sensors& sensors = vehicle.sensors;
      set(sensors.accelerometer.value(), 0.1, 1 + 0.2 * factor);
      set(sensors.gyroscope.value(), 0.01, 1 - 0.3 * factor);
      if (sensors.magnetometer) set(*sensors.magnetometer, 1, 1 + 0.4 * factor);
      if (sensors.barometer) set(sensors.barometer->faults, 3, 1 - 0.1 * factor);
      if (sensors.sonar) set(sensors.sonar->faults, 0.02, 1 + 0.5 * factor);
      if (sensors.flow) set(sensors.flow->faults, 0.1, 1 - 0.4 * factor);
      if (sensors.flow) sensors.flow->noise_per_height = 0;
    };
    scaled(0);
    const MatrixXd expected = pulse_response(plant(), 400);
    scaled(1);
    const MatrixXd response = pulse_response(plant(), 400);
    for (Index i = 0; i < 12; ++i)
      EXPECT_LT((response - expected).row(i).norm(), 1e-6 * expected.row(i).norm())
          << name << ned_convention().states[static_cast<std::size_t>(i)].name;
  }
}

// Clocks of 30 and 60 Hz, whose sample times contain rounding errors.
TEST(FlownPlant, IsBitwiseIndependentOfTheNumberOfThreads) {
  const Vehicle vehicle = load_vehicle("crazyflie");
  FlightSetup setup = flight(vehicle, EstimatorKind::general, 0.005);
  FlownPlantOptions options;
  options.dt = 0.005;
  options.command_delay = 0.0017;
  options.noise = true;
  std::vector<FlownPlant> plants(4);
  for (const std::size_t threads : {1, 4}) {
    // Inside a parallel section a plant is assembled by the calling thread only.
    const auto one = [&](std::size_t i) { plants[i] = flown_plant(setup, options); };
    internal::in_parallel(threads == 1 ? 1 : 3, threads, [&] { return one; }, {});
    if (threads == 1) plants[3] = plants[0];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(plants[i].plant.A, plants[3].plant.A);
    EXPECT_EQ(plants[i].plant.B, plants[3].plant.B);
    EXPECT_EQ(plants[i].noise, plants[3].noise);
  }
}

TEST(FlownPlant, NotesTheOmittedGroundEffect) {
  FlightSetup setup = flight(quiet("mambo"), EstimatorKind::truth, 0.005);
  for (Rotor& rotor : setup.vehicle.rotors) rotor.ground_effect = true;
  FlownPlantOptions options;
  EXPECT_TRUE(flown_plant(setup, options).notes.empty());
  options.height = 0.033;  // a radius: 1/(1 - 1/16) = 1.067
  EXPECT_EQ(flown_plant(setup, options).notes,
            std::vector<std::string>{"the model omits the ground effect; at a height of 0.033 m "
                                     "it adds 6.7 % of thrust"});
}

TEST(FlownPlant, MatchesAFlightWithTheMambosEstimator) {
  expect_that_it_flies_as_predicted(flight(quiet("mambo"), EstimatorKind::mambo, 0.005), 0.005);
  expect_that_it_flies_as_predicted(flight(quiet("crazyflie"), EstimatorKind::mambo, 0.004), 0.004);
}

TEST(FlownPlant, MatchesAFlightWithTheUquadsFilter) {
  expect_that_it_flies_as_predicted(flight(quiet("uquad"), EstimatorKind::uquad, 0.01), 0.01);
}

TEST(FlownPlant, MatchesAFlightWithTheGeneralFilter) {
  expect_that_it_flies_as_predicted(flight(quiet("mambo"), EstimatorKind::general, 0.005), 0.005);
  expect_that_it_flies_as_predicted(flight(quiet("crazyflie"), EstimatorKind::general, 0.005),
                                    0.005);
}

/// Fits the slowest decaying or growing oscillation in a record, after all other modes have
/// decayed: x[k + 2m] = 2 Re(z^m) x[k + m] - |z^m|² x[k].
std::complex<double> fitted_pole(const std::vector<double>& x, std::size_t first, std::size_t m) {
  const auto rows = static_cast<Index>(x.size() - first - 2 * m);
  MatrixXd M(rows, 2);
  VectorXd b(rows);
  for (Index i = 0; i < rows; ++i) {
    const std::size_t k = first + static_cast<std::size_t>(i);
    // Scale each row to the same weight, independent of the growth of the oscillation.
    const double scale = 1 / (std::abs(x[k]) + std::abs(x[k + m]) + std::abs(x[k + 2 * m]));
    M.row(i) << scale * x[k + m], scale * x[k];
    b(i) = scale * x[k + 2 * m];
  }
  const Eigen::Vector2d c = M.colPivHouseholderQr().solve(b);
  const std::complex<double> z =
      0.5 * (c(0) + std::sqrt(std::complex<double>(c(0) * c(0) + 4 * c(1))));
  return std::pow(z, 1.0 / static_cast<double>(m));
}

/// The poles of the flown loop of a setup.
Eigen::VectorXcd flown_poles(const FlightSetup& setup, double dt) {
  FlownPlantOptions options;
  options.dt = dt;
  options.height = kHeight;
  options.inputs = input_kind(setup);
  const FlownPlant plant = flown_plant(setup, options);
  return periodic_poles(closed(cut_at_inputs(plant.plant, flown_law(setup))));
}

/// Growth rate and frequency agree with a fit to the flight within 1 %.
void expect_the_fitted_pole(const FlightSetup& setup, double dt, const std::string& state,
                            double from, double until, std::size_t m) {
  FlightSetup longer = setup;
  longer.duration = until;
  const FlightResult result = fly(longer);
  ASSERT_EQ(result.end, FlightEnd::completed);
  const LogColumn* column = result.log.find("x." + state);
  ASSERT_NE(column, nullptr);
  std::vector<double> x = column->values;
  // Differences, so that the final position does not matter.
  for (std::size_t k = 0; k + m < x.size(); ++k) x[k] = x[k + m] - x[k];
  x.resize(x.size() - m);
  const std::complex<double> fit =
      std::log(fitted_pole(x, static_cast<std::size_t>(from / dt), m)) / dt;
  const std::complex<double> pole = std::log(flown_poles(setup, dt)(0)) / dt;
  EXPECT_NEAR(fit.real(), pole.real(), 0.01 * std::abs(pole.real())) << pole.real();
  EXPECT_NEAR(std::abs(fit.imag()), std::abs(pole.imag()), 0.01 * std::abs(pole.imag()));
}

TEST(FlownPlant, PredictsTheGrowthRateOfAFlight) {
  // The cascade of the Mambo thesis with an attitude filter of 1 s: slowly unstable.
  FlightSetup setup = flight(quiet("mambo"), EstimatorKind::mambo, 0.005);
  std::get<CascadeController>(setup.controller).gains = setup.vehicle.published_cascade->gains;
  setup.mambo_estimator.attitude_time_constant = 1;
  expect_the_fitted_pole(setup, 0.005, "v", 35, 50, 60);
}

/// Weights and result of the independent check of the flown loop: an LQR that was designed without
/// the motor lag of 72 ms.
TEST(FlownPlant, ShowsThatAnLqrWithoutTheLagIsUnstable) {
  FlightSetup setup = flight(quiet("crazyflie"), EstimatorKind::truth, 0.005);
  for (Rotor& rotor : setup.vehicle.rotors) rotor.drag = rotor.inflow = 0;  // they damp it
  const LinearizeOptions words{"ned", InputKind::wrench, {}};
  const Linearization model = linearize(setup.vehicle, FlightCondition{}, words);
  VectorXd q(12), r(4);
  q << 16, 16, 16, 25, 25, 8.163, 4, 4, 4, 0.25, 0.25, 0.25;
  r << 564, 953360, 953360, 766349;
  const SampledLqr sampled =
      sample(model.plant, {MatrixXd(q.asDiagonal()), MatrixXd(r.asDiagonal()), {}}, 0.005);
  const RiccatiResult riccati = lqr(sampled.plant, sampled.weights);
  ASSERT_TRUE(riccati.solved());
  Gains gains;
  gains.K = riccati.K;
  gains.K_int = MatrixXd(4, 0);
  gains.states = ned_convention().states;
  gains.inputs = ned_convention().wrench;
  gains.x0 = VectorXd::Zero(12);
  gains.u0 = model.u0;
  gains.vehicle = "crazyflie";
  gains.convention = "ned";
  gains.input_kind = InputKind::wrench;
  gains.dt = 0.005;
  setup.controller = StateFeedbackController{gains, 0.005, {}};
  const Eigen::VectorXcd poles = flown_poles(setup, 0.005);
  EXPECT_NEAR(std::abs(poles(0)), 1.0012, 5e-5);
  for (Rotor& rotor : setup.vehicle.rotors) rotor.lag = 0;
  EXPECT_LT(std::abs(flown_poles(setup, 0.005)(0)), 0.997);
}

/// A delayed gyroscope and an undelayed image form a loop whose gain increases with height, unless
/// their sample times are aligned.
TEST(FlownPlant, ShowsTheEffectOfAligningFlowAndGyroscope) {
  FlightSetup setup = flight(quiet("mambo"), EstimatorKind::mambo, 0.005);
  auto& gains = std::get<CascadeController>(setup.controller).gains;
  for (PidLoop& loop : gains.loops) {
    if (loop.name == "roll" || loop.name == "pitch") {
      loop.Kp *= 12;
      loop.Kd *= 5;
    }
    if (loop.name == "x" || loop.name == "y") {
      loop.Kp *= 3;
      loop.Kd *= 2;
    }
  }
  const auto largest = [&](double height) {
    FlownPlantOptions options;
    options.height = height;
    const FlownPlant plant = flown_plant(setup, options);
    return std::abs(periodic_poles(closed(cut_at_inputs(plant.plant, flown_law(setup))))(0));
  };
  EXPECT_GT(setup.mambo_estimator.aligned_periods, 0);
  EXPECT_NEAR(setup.mambo_estimator.gyro_lag, 0.005 + 2 * 0.707 / 190, 1e-12);
  for (const double height : {0.6, 1.1, 4.0}) EXPECT_LT(largest(height), 1) << height;
  setup.mambo_estimator.aligned_periods = 0;
  EXPECT_GT(largest(4), 1.02);
}

TEST(FlownPlant, DelaysCommandsAsTheDelayedHoldDoes) {
  FlightSetup setup = flight(quiet("uquad"), EstimatorKind::truth, 0.01);
  const ContinuousLti body =
      linearize(setup.vehicle, FlightCondition{}, {"ned", InputKind::wrench, {}}).plant;
  for (const double delay : {0.0, 0.004, 0.01, 0.027, 0.04}) {
    FlownPlantOptions options;
    options.dt = 0.01;
    options.command_delay = delay;
    const MeanResponse flown(flown_plant(setup, options).plant);
    ContinuousLti all = body;
    all.C = MatrixXd::Identity(12, 12);
    all.D = MatrixXd::Zero(12, 4);
    const FrequencyResponse held(
        discretize_zoh(all, 0.01, ChannelDelays{VectorXd::Constant(4, delay), {}}));
    for (const double w : {0.7, 5.0, 60.0, 250.0}) {
      const Eigen::MatrixXcd expected = held.at(w);
      EXPECT_LT((flown.at(w) - expected).norm(), 1e-9 * expected.norm()) << delay << " " << w;
    }
  }
}

TEST(FlownPlant, IncludesTheReactionTorqueOfTheRotors) {
  // Just after a step of the commands only J_r ω' accelerates the yaw: 1/(z lag) times as fast as
  // the drag torque will, z = 2 d2 ω/J_r = 4.0 rad/s of the Mambo.
  const double dt = 1e-6;
  FlightSetup setup = flight(quiet("mambo"), EstimatorKind::truth, dt);
  FlownPlantOptions options;
  options.dt = dt;
  const auto yaw_gain = [&] {
    const FlownPlant plant = flown_plant(setup, options);
    return (plant.plant.C * plant.plant.B[0])(11, 3);
  };
  const double without = yaw_gain();
  for (const double lag : {0.005, 0.02}) {
    for (Rotor& rotor : setup.vehicle.rotors) rotor.lag = lag;
    const Rotor& rotor = setup.vehicle.rotors[0];
    const double speed =
        std::sqrt(setup.vehicle.mass * setup.vehicle.gravity / (4 * rotor.thrust_a2));
    const double zero = 2 * rotor.torque_d2 * speed / rotor.inertia;
    EXPECT_NEAR(zero, 4.0, 0.05);
    EXPECT_NEAR(yaw_gain() / without, 1 / (zero * lag), 2e-3 / (zero * lag));
  }
}

TEST(FlownPlant, NamesUnobservedStates) {
  const auto drifts = [](const char* vehicle, EstimatorKind estimator) {
    return names(
        flown_plant(flight(quiet(vehicle), estimator, 0.01), {InputKind::wrench, 0.01}).drifts);
  };
  EXPECT_EQ(drifts("mambo", EstimatorKind::mambo), "px py yaw");
  EXPECT_EQ(drifts("uquad", EstimatorKind::uquad), "");
  EXPECT_EQ(drifts("mambo", EstimatorKind::truth), "");
}

TEST(FlownPlant, RejectsInvalidInput) {
  const auto refused = [](const FlightSetup& setup, const FlownPlantOptions& options,
                          const std::string& why) {
    try {
      (void)flown_plant(setup, options);
      ADD_FAILURE() << "expected a refusal: " << why;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  FlightSetup setup = flight(quiet("mambo"), EstimatorKind::mambo, 0.005);
  refused(setup, {InputKind::wrench, nan}, "the control period is nan s");
  refused(setup, {InputKind::wrench, 0}, "the control period is 0 s");
  refused(setup, {InputKind::wrench, 0.005, nan}, "the height is nan m");
  refused(setup, {InputKind::wrench, 0.005, 0}, "the height is 0 m");
  refused(setup, {InputKind::wrench, 0.005, 1, nan}, "the command delay is nan s");
  refused(setup, {InputKind::wrench, 0.005, 1, -0.1}, "the command delay is -0.1 s");
  refused(setup, {InputKind::wrench, 0.005, 1, 0.21}, "expected 0 to 40 control periods");
  FlightSetup late = setup;
  late.vehicle.sensors.gyroscope->delay = 0.31;
  refused(late, {}, "the gyroscope has a delay of 0.31 s, expected at most 40 control periods");
  FlightSetup heavy = setup;
  heavy.vehicle.mass = 10;
  refused(heavy, {}, "'mambo' cannot hover");
}

/// A clock that has no common period with the law is rounded, and a note reports it.
TEST(FlownPlant, RoundsClocksThatDoNotRepeat) {
  FlightSetup setup = flight(quiet("mambo"), EstimatorKind::mambo, 0.005);
  setup.vehicle.sensors.flow->faults.rate = 59.9371;
  const FlownPlant plant = flown_plant(setup, {});
  EXPECT_LE(plant.plant.period(), 1000U);
  ASSERT_EQ(plant.notes.size(), 1U);
  EXPECT_NE(plant.notes[0].find("the flow samples every"), std::string::npos) << plant.notes[0];
}

}  // namespace
}  // namespace quadtune
