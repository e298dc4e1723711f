// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/inertial_filter.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/estimation/record_of_log.hpp"
#include "quadtune/tuning/noise_tuning.hpp"
#include "sanitized.hpp"
#include "shared_data.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;

void fix(FilterModel& model, const char* name, double variance) {
  NoiseParameter& p =
      model.parameters[static_cast<std::size_t>(parameter_index(model, name, "test"))];
  p.fixed = true;
  p.start = variance;
}

/// The built-in model, with position only.
FilterModel aided_by_position() {
  FilterModel model = load_filter_model("inertial");
  fix(model, "R.velocity", 1);
  fix(model, "R.height", 1);
  return model;
}

/// A flight along a knot with continuous rotation, whose initial heading is not north.
struct Flight {
  Vector3d position(double t) const {
    return {3 * std::sin(0.9 * t), 2 * std::sin(1.3 * t + 1), 1 + 0.7 * std::cos(1.1 * t)};
  }
  Vector3d acceleration(double t) const {
    return {-2.43 * std::sin(0.9 * t), -3.38 * std::sin(1.3 * t + 1), -0.847 * std::cos(1.1 * t)};
  }
  Matrix3d attitude(double t) const {
    return (Eigen::AngleAxisd(2.2 + 0.4 * std::sin(0.5 * t), Vector3d::UnitZ()) *
            Eigen::AngleAxisd(0.3 * std::sin(1.7 * t), Vector3d::UnitY()) *
            Eigen::AngleAxisd(0.25 * std::cos(1.3 * t), Vector3d::UnitX()))
        .toRotationMatrix();
  }
  Vector3d rate(double t) const {
    const double h = 1e-4;
    const Eigen::AngleAxisd turn(Matrix3d(attitude(t - h).transpose() * attitude(t + h)));
    return turn.axis() * turn.angle() / (2 * h);
  }
};

/// The log of an inertial sensor with these noises at 100 Hz, and positions at 10 Hz.
FilterRecord flown(const FilterModel& model, double seconds, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const auto noise = [&](double variance) {
    const double s = std::sqrt(variance);
    const double x = normal(random), y = normal(random), z = normal(random);
    return Vector3d(s * x, s * y, s * z);
  };
  const auto variance = [&](const char* name) {
    return model.parameters[static_cast<std::size_t>(parameter_index(model, name, "test"))].start;
  };
  const double dt = 0.01;
  const auto N = static_cast<Index>(seconds / dt);
  FilterRecord record{"synthetic", {}, MatrixXd::Constant(7, N, std::nan("")), MatrixXd(6, N)};
  const Flight flight;
  Vector3d gyro_offset(0.02, -0.05, 0.01), force_offset(0.1, -0.05, 0.2);
  for (Index k = 0; k < N; ++k) {
    const double t = static_cast<double>(k) * dt;
    record.time.push_back(t);
    record.u.col(k).head<3>() = flight.rate(t) + gyro_offset + noise(variance("Q.gyro") / dt);
    record.u.col(k).tail<3>() =
        flight.attitude(t).transpose() * (flight.acceleration(t) - *model.gravity) + force_offset +
        noise(variance("Q.force") / dt);
    gyro_offset += noise(variance("Q.gyro_offset") * dt);
    force_offset += noise(variance("Q.force_offset") * dt);
    if (k % 10 == 0) record.y.col(k).head<3>() = flight.position(t) + noise(variance("R.position"));
  }
  return record;
}

FilterModel known_noise() {
  FilterModel model = aided_by_position();
  const auto set = [&](const char* name, double value) {
    model.parameters[static_cast<std::size_t>(parameter_index(model, name, "test"))].start = value;
  };
  set("Q.gyro", 4e-6);
  set("Q.force", 4e-4);
  set("Q.gyro_offset", 1e-6);
  set("Q.force_offset", 1e-4);
  set("R.position", 4e-4);
  return model;
}

TEST(InertialFilter, HasInnovationsOfItsOwnSize) {
  const FilterModel model = known_noise();
  const auto filter = nonlinear_filter(model, {flown(model, 90, 3)});
  const LinearizedLogs logs = filter->linearize(start_of(model));
  ASSERT_EQ(logs.culprit, "");
  const InnovationLikelihood likelihood(model, logs.records);
  const FilterRun run = likelihood.run(0, start_of(model));
  ASSERT_EQ(run.status, LikelihoodStatus::computed);
  // The initial heading is estimated in the first seconds.
  const auto late = [](const MatrixXd& M) { return M.topRows(3).rightCols(M.cols() - 100); };
  const double size = (late(run.innovation).array().square() / late(run.variance).array()).mean();
  EXPECT_NEAR(size, 1, 4 * std::sqrt(2.0 / static_cast<double>(late(run.variance).size())));
}

TEST(InertialFilter, FollowsTheVehicle) {
  const FilterModel model = known_noise();
  const FilterRecord record = flown(model, 60, 4);
  const auto filter = nonlinear_filter(model, {record});
  const LinearizedLogs logs = filter->linearize(start_of(model));
  const FilterRun run = InnovationLikelihood(model, logs.records).run(0, start_of(model));
  const Index last = run.x.cols() - 1;
  EXPECT_THAT(run.x.col(last).segment<3>(kInertialPosition),
              MatrixNear(Flight().position(logs.records[0].time.back()), 0.05));
  EXPECT_THAT(run.x.col(last).segment<3>(kGyroOffset),
              MatrixNear(Vector3d(0.02, -0.05, 0.01), 0.03));
}

// The same flight with world and body rotated about x by half a turn, as north-east-down and
// forward-right-down relative to z up.
TEST(InertialFilter, WithZDownIsTheSameFilter) {
  const FilterModel up = known_noise();
  FilterModel down = load_filter_model("inertial-ned");
  EXPECT_EQ(*down.gravity, -*up.gravity);
  down.parameters = up.parameters;
  FilterRecord record = flown(up, 30, 4);
  // The height of the last sensor is positive upwards in both.
  for (Index k = 0; k < record.samples(); k += 50) record.y(6, k) = record.y(2, k);
  FilterRecord turned = record;
  for (const Index row : {1, 2, 4, 5}) turned.y.row(row) *= -1;
  for (const Index row : {1, 2, 4, 5}) turned.u.row(row) *= -1;
  const auto value = [](const FilterModel& model, const FilterRecord& of) {
    const LinearizedLogs logs = nonlinear_filter(model, {of})->linearize(start_of(model));
    EXPECT_EQ(logs.culprit, "");
    return InnovationLikelihood(model, logs.records).run(0, start_of(model));
  };
  const FilterRun a = value(up, record), b = value(down, turned);
  ASSERT_EQ(b.innovation.cols(), a.innovation.cols());
  int compared = 0;
  for (Index k = 0; k < a.innovation.cols(); ++k)
    for (const Index row : {0, 1, 2, 6}) {
      if (std::isnan(a.innovation(row, k))) continue;
      const double sign = row == 1 || row == 2 ? -1 : 1;
      ++compared;
      ASSERT_NEAR(b.innovation(row, k), sign * a.innovation(row, k), 1e-7) << row << ' ' << k;
      ASSERT_NEAR(b.variance(row, k), a.variance(row, k), 1e-7) << row << ' ' << k;
    }
  EXPECT_GT(compared, 900);
  const Index last = b.x.cols() - 1;
  EXPECT_NEAR(b.x(kInertialPosition + 2, last), -a.x(kInertialPosition + 2, last), 1e-6);
  EXPECT_NEAR(b.x(kForceOffset, last), a.x(kForceOffset, last), 1e-6);
  EXPECT_NEAR(b.x(kForceOffset + 2, last), -a.x(kForceOffset + 2, last), 1e-6);
}

TEST(InertialFilter, FindsTheNoiseOfItsSensors) {
  const FilterModel truth = known_noise();
  FilterModel model = truth;
  for (NoiseParameter& p : model.parameters)
    if (!p.fixed) p.start *= 10;
  NoiseTuningOptions options;
  options.fit.starts = 1;
  options.fit.confidence = 0.999;
  const NoiseTuning tuning = tune_noise(*nonlinear_filter(model, {flown(truth, 120, 5)}), options);
  EXPECT_EQ(tuning.verdict, CheckVerdict::pass)
      << (tuning.reasons.empty() ? "" : tuning.reasons.front());
  for (std::size_t i = 0; i < truth.parameters.size(); ++i) {
    if (truth.parameters[i].fixed) continue;
    const FittedParameter& p = tuning.fit.parameters[i];
    EXPECT_LT(p.low, truth.parameters[i].start) << p.name;
    EXPECT_GT(p.high, truth.parameters[i].start) << p.name;
  }
  EXPECT_GT(tuning.rounds, 1);
}

ChannelUse use(const std::string& signal, LogChannels& channels, std::size_t i,
               std::int64_t epoch_s, double factor = 1) {
  LogSeries& series = channels.series[i];
  for (double& t : series.time) t += static_cast<double>(channels.epoch_s - epoch_s);
  for (double& value : series.values) value *= factor;
  return {signal, series};
}

/// The records up to this many seconds after the first instant.
std::vector<FilterRecord> until(std::vector<FilterRecord> records, double seconds) {
  FilterRecord& record = records[0];
  const auto end =
      std::upper_bound(record.time.begin(), record.time.end(), record.time.front() + seconds);
  const auto count = static_cast<Index>(end - record.time.begin());
  record.time.resize(static_cast<std::size_t>(count));
  record.y = record.y.leftCols(count).eval();
  record.u = record.u.leftCols(count).eval();
  return {record};
}

// A vehicle that flies indoors, with positions from a motion capture that was smoothed with the
// same inertial sensor: the noise of gyroscope and accelerometer agrees with the datasheet of the
// ADIS16448, and the report states that the innovations of the positions are not white.
TEST(InertialFilter, EstimatesNoiseDensitiesFromAFlight) {
  QUADTUNE_REQUIRE_DATA(data);
  if (testing::kSanitized)
    GTEST_SKIP() << "minutes under sanitizers; synthetic flights take the same path";
  LogChannels imu =
      read_log_channels((data / "euroc" / "V1_01_easy_imu0.csv").string(),
                        {"w_RS_S_x", "w_RS_S_y", "w_RS_S_z", "a_RS_S_x", "a_RS_S_y", "a_RS_S_z"});
  LogChannels truth =
      read_log_channels((data / "euroc" / "V1_01_easy_gt_20Hz.csv").string(), {"px", "py", "pz"});
  std::vector<ChannelUse> uses;
  FilterModel model = aided_by_position();
  fix(model, "Q.gyro_offset", 1.9393e-5 * 1.9393e-5);  // too small to be determined in a minute
  for (std::size_t i = 0; i < 6; ++i)
    uses.push_back(use(model.inputs[i].name, imu, i, imu.epoch_s));
  for (std::size_t i = 0; i < 3; ++i)
    uses.push_back(use(model.sensors[0].outputs[i].name, truth, i, imu.epoch_s));
  const auto filter = nonlinear_filter(model, until(records_of_log(model, uses, "V1_01"), 30));
  NoiseTuningOptions options;
  options.fit.starts = 1;
  const NoiseTuning tuning = tune_noise(*filter, options);
  EXPECT_TRUE(tuning.fit.converged()) << tuning.fit.culprit;
  const auto found = [&](const char* name) {
    return tuning.fit.parameters[static_cast<std::size_t>(parameter_index(model, name, "test"))];
  };
  // The datasheet says 1.7e-4 rad/s/√Hz and 2e-3 m/s²/√Hz; propellers shake the accelerometer.
  EXPECT_GT(std::sqrt(found("Q.gyro").high), 1.7e-4);
  EXPECT_LT(std::sqrt(found("Q.gyro").high), 2e-3);
  EXPECT_GT(std::sqrt(found("Q.force").low), 2e-3);
  EXPECT_LT(std::sqrt(found("Q.force").high), 2e-2);
  EXPECT_EQ(tuning.verdict, CheckVerdict::fail);
  EXPECT_THAT(tuning.reasons, ::testing::Contains(HasSubstr("position: x: innovations")));
}

// A simulated PX4 flight: barometer and GPS velocity.
TEST(InertialFilter, TunesBarometerAndGpsFromAReplay) {
  QUADTUNE_REQUIRE_DATA(data);
  if (testing::kSanitized)
    GTEST_SKIP() << "minutes under sanitizers; synthetic flights take the same path";
  FilterModel model = load_filter_model("inertial");
  model.gravity = Vector3d(0, 0, 9.81);  // north, east, down
  model.sensors[2].C(0, kInertialPosition + 2) = -1;
  fix(model, "R.position", 1);
  fix(model, "Q.gyro", 1e-7);
  fix(model, "Q.force", 1e-4);
  fix(model, "Q.gyro_offset", 1e-9);
  fix(model, "Q.force_offset", 1e-5);
  LogChannels log =
      read_log_channels((data / "px4" / "replay_data__iris_gps.csv").string(),
                        {"imu.gyro_x", "imu.gyro_y", "imu.gyro_z", "imu.accel_x", "imu.accel_y",
                         "imu.accel_z", "gps.v_north", "gps.v_east", "gps.v_down", "baro.height"});
  std::vector<ChannelUse> uses;
  for (std::size_t i = 0; i < 6; ++i)
    uses.push_back(use(model.inputs[i].name, log, i, log.epoch_s));
  for (std::size_t i = 0; i < 3; ++i)
    uses.push_back(use(model.sensors[1].outputs[i].name, log, 6 + i, log.epoch_s));
  uses.push_back(use("height", log, 9, log.epoch_s));
  const auto filter = nonlinear_filter(model, records_of_log(model, uses, "iris"));
  NoiseTuningOptions options;
  options.fit.starts = 1;
  const NoiseTuning tuning = tune_noise(*filter, options);
  EXPECT_TRUE(tuning.fit.converged()) << tuning.fit.culprit;
  const auto found = [&](const char* name) {
    return tuning.fit.parameters[static_cast<std::size_t>(parameter_index(model, name, "test"))];
  };
  // The altitude of a stationary vehicle has a standard deviation of 0.09 m, the velocity of at
  // most 0.06 m/s.
  EXPECT_NEAR(std::sqrt(found("R.height").value), 0.09, 0.02);
  EXPECT_LT(std::sqrt(found("R.velocity").value), 0.2);
  const auto& before = tuning.before.outputs.back();
  const auto& after = tuning.after.outputs.back();
  EXPECT_EQ(after.output, "height: height");
  EXPECT_LT(before.size, 0.1);  // 0.5 m would be far too large
  EXPECT_NEAR(after.size, 1, 0.1);
}

// The steps of a clock in other units would be divided into more steps than fit into memory.
TEST(InertialFilter, RejectsStepsThatItCannotIntegrate) {
  const FilterModel model = known_noise();
  FilterRecord record = flown(model, 2, 1);
  for (double& time : record.time) time *= 1e9;
  EXPECT_THAT(
      [&] { (void)nonlinear_filter(model, {record}); },
      ThrowsMessage<InvalidInput>(HasSubstr(
          "synthetic: the inputs at 0 s are followed by the next after 1e+07 s, expected at "
          "most 20 s because the motion between them is integrated in steps of 0.02 s")));
}

TEST(InertialFilter, IsNotALinearModel) {
  const FilterModel model = known_noise();
  EXPECT_THAT([&] { InnovationLikelihood(model, {flown(model, 2, 1)}); },
              ThrowsMessage<InvalidInput>(HasSubstr("'inertial' is not linear, expected a record "
                                                    "that a filter linearized")));
  EXPECT_THAT([&] { (void)nonlinear_filter(load_filter_model("altitude"), {}); },
              ThrowsMessage<InvalidInput>(HasSubstr("'altitude' is linear, expected dynamics")));
  FilterModel seen = model;
  seen.sensors[0].C(1, 2) = 1;
  EXPECT_THAT(
      [&] { (void)nonlinear_filter(seen, {}); },
      ThrowsMessage<InvalidInput>(HasSubstr("C of sensor 'position' depends on the rotation")));
  FilterRecord record = flown(model, 2, 1);
  record.y.setConstant(std::nan(""));
  EXPECT_THAT([&] { (void)nonlinear_filter(model, {record}); },
              ThrowsMessage<InvalidInput>(HasSubstr("0 instants with measurements")));
}

TEST(InertialFilter, IsWrittenAndReadBack) {
  const FilterModel model = load_filter_model("inertial");
  const FilterModel back = parse_filter_model(text_of_filter_model(model), "text");
  EXPECT_EQ(*back.gravity, *model.gravity);
  EXPECT_EQ(back.parameters, model.parameters);
  EXPECT_EQ(back.sensors.size(), 3);
  EXPECT_EQ(back.P0, model.P0);
  EXPECT_THAT([] { (void)parse_filter_model("name = \"x\"\ndynamics = \"inertia\"\n", "f.toml"); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("f.toml:2: dynamics is 'inertia', expected "
                            "'linear' or 'inertial' or 'rigid-body'; did you mean")));
  EXPECT_THAT(
      [] {
        (void)parse_filter_model(
            "name = \"x\"\ndynamics = \"inertial\"\ngravity_m_per_s2 = [0, 0, -9.81]\n"
            "states = [\"a\"]\n",
            "f.toml");
      },
      ThrowsMessage<InvalidInput>(HasSubstr(
          "f.toml:4: states is given, expected no such key because the dynamics are 'inertial'")));
}

}  // namespace
}  // namespace quadtune
