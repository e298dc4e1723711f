// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/rigid_body_filter.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/estimation/uquad_filter.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/tuning/noise_tuning.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kBodyStep = 0.01;

/// The built-in model with noise that a short hover without control survives.
FilterModel quiet() {
  FilterModel model = load_filter_model("uquad");
  const auto set = [&](const char* name, double value) {
    model.parameters[static_cast<std::size_t>(parameter_index(model, name, "test"))].start = value;
  };
  set("Q.angles", 1e-5);
  set("Q.velocity", 4e-3);
  set("Q.rates", 2e-3);
  set("Q.bias", 1e-4);
  set("R.tilt", 4e-4);
  set("R.yaw", 1e-3);
  set("R.force", 0.01);
  set("R.rates", 1e-4);
  set("R.height", 0.04);
  set("R.gps_position", 0.25);
  set("R.gps_velocity", 0.01);
  return model;
}

/// Simulated by the model of the filter, measured by its sensors.
FilterRecord hover(const FilterModel& model, double seconds, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const VectorXd theta = start_of(model);
  const VectorXd q = covariance(model.Q, theta).diagonal();
  const RigidBody body(load_vehicle("uquad"));
  const double per_rotor = body.mass * body.gravity / static_cast<double>(body.rotors.size());
  double low = 0, high = 5000;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (rotor_thrust(body.rotors[0], middle, 1.0) < per_rotor ? low : high) = middle;
  }
  const auto N = static_cast<Index>(seconds / kBodyStep);
  FilterRecord record{"synthetic",
                      {},
                      MatrixXd::Constant(model.outputs(), N, std::nan("")),
                      MatrixXd::Constant(4, N, low)};
  VectorXd x = VectorXd::Zero(kUquadStates);
  x(kAttitude + 2) = 3.1;  // so that the yaw wraps
  for (Index k = 0; k < N; ++k) {
    record.time.push_back(static_cast<double>(k) * kBodyStep);
    for (Index i = 0; i < 4; ++i)
      record.u(i, k) += 3 * std::sin(0.03 * static_cast<double>(k + 40 * i));
    const VectorXd speeds = record.u.col(std::max<Index>(k - 1, 0));
    const auto loads = rotor_loads(body, speeds);
    const StateVector<double> state = x.head<12>();
    const auto A = state_jacobian(body, state, loads);
    const Eigen::Vector3d v = state.segment<3>(kVelocity);
    VectorXd y(model.outputs());
    y << x(kAttitude), x(kAttitude + 1), wrap_angle(x(kAttitude + 2)),
        (loads.force + drag_force(body, v)) / body.mass + x.tail<3>(), x.segment<3>(kRates),
        -x(kPosition + 2), x.segment<3>(kPosition), A.position_velocity * v;
    Index row = 0;
    for (const FilterSensor& sensor : model.sensors) {
      const bool gps = sensor.name == "position" || sensor.name == "velocity";
      const MatrixXd R = covariance(sensor.R, theta);
      for (Index i = 0; i < R.rows(); ++i, ++row) {
        const double e = std::sqrt(R(i, i)) * normal(random);
        if (!gps || k % 20 == 0) record.y(row, k) = y(row) + e;
      }
    }
    x.head<12>() +=
        kBodyStep * state_derivative(body, state, rotor_loads(body, VectorXd(record.u.col(k))));
    for (Index i = 0; i < x.size(); ++i) x(i) += std::sqrt(kBodyStep * q(i)) * normal(random);
  }
  return record;
}

std::vector<FilterRecord> hovers(const FilterModel& model, int count) {
  std::vector<FilterRecord> records;
  records.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
    records.push_back(hover(model, 6, std::uint64_t{100} + static_cast<std::uint64_t>(i)));
  return records;
}

TEST(RigidBodyFilter, HasInnovationsOfItsOwnSize) {
  const FilterModel model = quiet();
  const auto filter = nonlinear_filter(model, hovers(model, 4));
  const LinearizedLogs logs = filter->linearize(start_of(model));
  ASSERT_EQ(logs.culprit, "");
  const InnovationLikelihood likelihood(model, logs.records);
  for (Index i = 0; i < model.outputs(); ++i) {
    SCOPED_TRACE(i);
    double sum = 0, count = 0;
    for (std::size_t r = 0; r < logs.records.size(); ++r) {
      const FilterRun run = likelihood.run(r, start_of(model));
      for (Index k = 0; k < run.innovation.cols(); ++k)
        if (!std::isnan(run.innovation(i, k))) {
          sum += std::pow(run.innovation(i, k), 2) / run.variance(i, k);
          count += 1;
        }
    }
    EXPECT_NEAR(sum / count, 1, 4 * std::sqrt(2 / count));
  }
}

TEST(RigidBodyFilter, FindsTheNoiseOfSeveralFlights) {
  const FilterModel truth = quiet();
  FilterModel model = truth;
  for (NoiseParameter& p : model.parameters) p.start *= 4;
  NoiseTuningOptions options;
  options.fit.starts = 1;
  options.fit.confidence = 0.999;
  const NoiseTuning tuning = tune_noise(*nonlinear_filter(model, hovers(truth, 3)), options);
  EXPECT_TRUE(tuning.fit.converged());
  for (std::size_t i = 0; i < truth.parameters.size(); ++i) {
    const FittedParameter& p = tuning.fit.parameters[i];
    EXPECT_LT(p.low, truth.parameters[i].start) << p.name;
    EXPECT_GT(p.high, truth.parameters[i].start) << p.name;
  }
}

// Regression test: one measurement between two gaps caused the whole log to be rejected.
TEST(RigidBodyFilter, ExcludesARecordWithOneMeasurement) {
  const FilterModel model = quiet();
  const std::vector<FilterRecord> whole = hovers(model, 2);
  std::vector<FilterRecord> torn = {whole[0], whole[1], whole[1]};
  torn[1].name = "between gaps";
  torn[1].y.rightCols(torn[1].y.cols() - 1).setConstant(std::nan(""));
  const auto filter = nonlinear_filter(model, torn);
  ASSERT_EQ(filter->left_out().size(), 1u);
  EXPECT_EQ(filter->left_out()[0].name, "between gaps");
  EXPECT_EQ(filter->left_out()[0].measurements, 1);
  EXPECT_EQ(filter->left_out()[0].from, whole[1].time.front());
  EXPECT_EQ(filter->left_out()[0].to, whole[1].time.back());
  const LinearizedLogs with = filter->linearize(start_of(model));
  const LinearizedLogs without = nonlinear_filter(model, whole)->linearize(start_of(model));
  ASSERT_EQ(with.records.size(), 2u);
  EXPECT_EQ(InnovationLikelihood(model, with.records).evaluate(start_of(model)).value,
            InnovationLikelihood(model, without.records).evaluate(start_of(model)).value);
  torn = {torn[1], torn[1]};
  EXPECT_THAT(
      [&] { (void)nonlinear_filter(model, torn); },
      ThrowsMessage<InvalidInput>(HasSubstr("between gaps: every section between two gaps has at "
                                            "most 1 instant with measurements, expected at "
                                            "least 2")));
}

TEST(RigidBodyFilter, StopsWhenAsked) {
  const FilterModel model = quiet();
  std::vector<FilterRecord> records = hovers(model, 3);
  const auto filter = nonlinear_filter(model, records);
  int asked = 0;
  EXPECT_THROW((void)filter->linearize(start_of(model), [&] { return ++asked == 2; }), Interrupted);
  NoiseTuningOptions options;
  options.fit.starts = 2;
  for (const int max : {0, 1, 20, 60}) {
    SCOPED_TRACE(max);
    asked = 0;
    options.fit.interrupted = [&] { return ++asked > max; };
    const NoiseTuning tuning = tune_noise(*filter, options);
    EXPECT_EQ(tuning.fit.status, NoiseFitStatus::interrupted);
    EXPECT_EQ(tuning.verdict, CheckVerdict::fail);
    EXPECT_THAT(tuning.reasons, ::testing::ElementsAre("the fit is interrupted"));
    EXPECT_EQ(tuning.fit.theta.size(), start_of(model).size());
    EXPECT_TRUE(tuning.fit.theta.allFinite());
    EXPECT_LT(asked, max + 20);
  }
}

TEST(RigidBodyFilter, JudgesTheBestOfTheTimeItIsGiven) {
  FilterModel model = quiet();
  const std::vector<FilterRecord> records = hovers(model, 1);
  NoiseTuningOptions options;
  options.seconds = 1e-9;
  const NoiseTuning tuning = tune_noise(*nonlinear_filter(model, records), options);
  EXPECT_EQ(tuning.fit.status, NoiseFitStatus::out_of_time);
  EXPECT_EQ(tuning.fit.theta, start_of(model));
  EXPECT_EQ(tuning.verdict, CheckVerdict::fail);
  EXPECT_EQ(tuning.reasons.front(), "the fit is out of time");
  ASSERT_FALSE(tuning.after.outputs.empty());
  EXPECT_GT(tuning.after.outputs.front().samples, 0);
}

TEST(RigidBodyFilter, IsTunedTheSameOnAnyNumberOfThreads) {
  FilterModel model = quiet();
  const std::vector<FilterRecord> records = hovers(model, 1);
  for (NoiseParameter& p : model.parameters) p.start *= 4;
  const auto filter = nonlinear_filter(model, records);
  NoiseTuningOptions options;
  options.fit.starts = 2;
  const NoiseTuning one = tune_noise(*filter, options);
  options.fit.threads = 3;
  const NoiseTuning three = tune_noise(*filter, options);
  EXPECT_EQ(one.fit.theta, three.fit.theta);
  EXPECT_EQ(one.fit.evaluations, three.fit.evaluations);
  EXPECT_EQ(one.fit.after.value, three.fit.after.value);
  EXPECT_EQ(one.rounds, three.rounds);
}

TEST(RigidBodyFilter, NamesErrors) {
  EXPECT_THAT([] { (void)rigid_body_sensor("rate", "f.toml:3"); },
              ThrowsMessage<InvalidInput>(HasSubstr("f.toml:3: no sensor 'rate', expected one of "
                                                    "tilt, yaw, force, rates, height, position, "
                                                    "velocity, vision; did you mean 'rates'?")));
  EXPECT_THAT(
      [] {
        (void)parse_filter_model(
            "name = \"x\"\ndynamics = \"rigid-body\"\nvehicle = \"uquad\"\nperiod_s = 1\n",
            "f.toml");
      },
      ThrowsMessage<InvalidInput>(HasSubstr("f.toml:4: period_s is given, expected no such key "
                                            "because the dynamics are 'rigid-body'")));
}

TEST(RigidBodyFilter, IsWrittenAndReadBack) {
  const FilterModel model = load_filter_model("uquad");
  const FilterModel back = parse_filter_model(text_of_filter_model(model), "text");
  EXPECT_EQ(back.vehicle, "uquad");
  EXPECT_EQ(back.parameters, model.parameters);
  EXPECT_EQ(back.outputs(), model.outputs());
}

}  // namespace
}  // namespace quadtune
