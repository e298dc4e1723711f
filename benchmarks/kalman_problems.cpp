// SPDX-License-Identifier: Apache-2.0
#include "kalman_problems.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "plants/filter_models.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/model/rigid_body.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune::bench {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kPeriod = 0.005;  // [s]

KalmanProblem with_log(FilterModel model, int samples, std::mt19937_64& random) {
  FilterRecord record = testing::simulated(model, start_of(model), samples, kPeriod, random);
  return {std::move(model), std::move(record)};
}

void start_known(FilterModel& model) {
  const Index nx = model.A.rows();
  model.x0 = Eigen::VectorXd::Zero(nx);
  model.P0 = MatrixXd::Identity(nx, nx);
  model.diffuse.assign(static_cast<std::size_t>(nx), false);
}

ScaledCovariance one_entry(Index size, Index entry, int parameter) {
  MatrixXd shape = MatrixXd::Zero(size, size);
  shape(entry, entry) = 1;
  return {shape, parameter};
}

/// A discrete model with this many states and outputs that each measure one state. Its parameters
/// belong first to outputs, then to noises; each is shared by as many of them as necessary.
KalmanProblem drawn_problem(Index nx, const std::vector<Index>& seen, int samples, int parameters,
                            bool sparse) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  FilterModel model;
  model.name = "large";
  model.dt = kPeriod;
  for (Index i = 0; i < nx; ++i) {
    model.states.push_back({fmt::format("x{}", i + 1), ""});
    model.noises.push_back({fmt::format("w{}", i + 1), ""});
  }
  model.A = model.G = MatrixXd::Identity(nx, nx);
  model.B.resize(nx, 0);
  for (Index i = 0; i < nx; ++i)
    for (Index j = 0; j < nx; ++j) {
      const bool chained = i % 3 != 2 && j == i + 1;
      if (sparse ? chained : true) model.A(i, j) = sparse ? kPeriod : normal(random);
    }
  if (!sparse) model.A *= 0.95 / model.A.eigenvalues().cwiseAbs().maxCoeff();

  const int of_outputs = std::max(1, parameters / 3), of_noises = parameters - of_outputs;
  for (int i = 0; i < of_outputs; ++i)
    model.parameters.push_back({fmt::format("R.{}", i + 1), "", true, 0.1});
  for (int i = 0; i < of_noises; ++i)
    model.parameters.push_back({fmt::format("Q.{}", i + 1), "", true, 0.01});
  model.Q.fixed = MatrixXd::Zero(nx, nx);
  for (Index i = 0; i < nx; ++i)
    model.Q.scaled.push_back(one_entry(nx, i, of_outputs + static_cast<int>(i) % of_noises));
  for (std::size_t i = 0; i < seen.size(); ++i) {
    FilterSensor& sensor = model.sensors.emplace_back();
    sensor.name = fmt::format("y{}", i + 1);
    sensor.outputs = {{sensor.name, ""}};
    sensor.C = MatrixXd::Zero(1, nx);
    sensor.C(0, seen[i]) = 1;
    sensor.R = {MatrixXd::Zero(1, 1), {one_entry(1, 0, static_cast<int>(i) % of_outputs)}, {}};
  }
  start_known(model);
  return with_log(std::move(model), samples, random);
}

}  // namespace

KalmanProblem altitude_problem(int samples) {
  std::mt19937_64 random(1);
  FilterModel model = load_filter_model("altitude");
  start_known(model);
  return with_log(std::move(model), samples, random);
}

KalmanProblem large_problem(int samples, int parameters, bool sparse) {
  return drawn_problem(12, {0, 3, 6, 9, 1, 4}, samples, parameters, sparse);
}

KalmanProblem problem_of_extended_size(int samples) {
  std::vector<Index> seen(16);
  for (std::size_t i = 0; i < seen.size(); ++i) seen[i] = static_cast<Index>(i % 15);
  return drawn_problem(15, seen, samples, 11, false);
}

KalmanProblem uquad_hover(int samples) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const FilterModel model = load_filter_model("uquad");
  const RigidBody body(load_vehicle("uquad"));
  const double per_rotor = body.mass * body.gravity / static_cast<double>(body.rotors.size());
  double low = 0, high = 5000;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (rotor_thrust(body.rotors[0], middle, 1.0) < per_rotor ? low : high) = middle;
  }
  FilterRecord record{"hover",
                      {},
                      MatrixXd::Zero(model.outputs(), samples),
                      MatrixXd::Constant(model.B.cols(), samples, low)};
  for (int k = 0; k < samples; ++k) record.time.push_back(kPeriod * k);
  Index row = 0;
  for (const FilterSensor& sensor : model.sensors)
    for (Index i = 0; i < sensor.C.rows(); ++i, ++row) {
      if (sensor.outputs[static_cast<std::size_t>(i)].name == "fz")
        record.y.row(row).setConstant(-body.gravity);
      const double deviation = std::sqrt(covariance(sensor.R, start_of(model))(i, i));
      for (int k = 0; k < samples; ++k) record.y(row, k) += deviation * normal(random);
    }
  return {model, std::move(record)};
}

}  // namespace quadtune::bench
