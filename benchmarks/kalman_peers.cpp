// SPDX-License-Identifier: Apache-2.0
#include "kalman_peers.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "quadtune/discretize/van_loan.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "temporary_directory.hpp"

namespace quadtune::bench {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

struct OneStep {
  MatrixXd F, B, Q;
};

OneStep step_of(const FilterModel& model, const MatrixXd& Q, double dt) {
  const MatrixXd noise = model.G * Q * model.G.transpose();
  if (model.dt > 0) return {model.A, model.B, noise};
  ContinuousLti plant;
  plant.A = model.A;
  plant.B = model.B;
  const DiscreteLti held = discretize_zoh(plant, dt);
  return {held.A, held.B, sampled_noise(model.A, noise, dt).Q};
}

void write(std::ofstream& file, const char* name, const MatrixXd& M) {
  file << fmt::format("{} {} {}", name, M.rows(), M.cols());
  for (Index i = 0; i < M.rows(); ++i)
    for (Index j = 0; j < M.cols(); ++j) file << fmt::format(" {:.17g}", M(i, j));
  file << '\n';
}

void write_problem(const std::filesystem::path& path, const KalmanProblem& problem,
                   const Eigen::VectorXd& start) {
  const FilterModel& model = problem.model;
  const FilterRecord& record = problem.record;
  const Eigen::VectorXd theta = start_of(model);
  const double dt = record.time[1] - record.time[0];
  const OneStep step = step_of(model, covariance(model.Q, theta), dt);
  const Index ny = model.outputs();
  MatrixXd C(ny, model.A.rows()), R = MatrixXd::Zero(ny, ny);
  Index first = 0;
  for (const FilterSensor& sensor : model.sensors) {
    C.middleRows(first, sensor.C.rows()) = sensor.C;
    R.block(first, first, sensor.C.rows(), sensor.C.rows()) = covariance(sensor.R, theta);
    first += sensor.C.rows();
  }
  MatrixXd y = record.y;
  Eigen::VectorXd x = model.x0;
  for (Index k = 0; k < y.cols(); ++k) {
    y.col(k) -= C * x;
    x = (step.F * x + step.B * record.u.col(k)).eval();
  }
  std::ofstream file(path);
  write(file, "F", step.F);
  write(file, "Q", step.Q);
  write(file, "C", C);
  write(file, "R", R);
  write(file, "P0", model.P0);
  write(file, "y", y.transpose());
  if (start.size() == 0) return;
  write(file, "start", start);
  write(file, "Q_of_1", step_of(model, model.Q.scaled.front().shape, dt).Q);
  write(file, "R_of_1", model.sensors.front().R.scaled.front().shape);
}

std::optional<std::string> output_of(const std::string& command) {
  FILE* pipe = popen((command + " 2>/dev/null").c_str(), "r");
  if (!pipe) return std::nullopt;
  std::string text;
  std::array<char, 4096> buffer;
  while (std::fgets(buffer.data(), buffer.size(), pipe)) text += buffer.data();
  if (pclose(pipe) != 0) return std::nullopt;
  return text;
}

}  // namespace

std::optional<PeerLikelihood> ask_peer(KalmanPeer peer, PeerTask task, const KalmanProblem& problem,
                                       const Eigen::VectorXd& start) {
  const bool python = peer == KalmanPeer::statsmodels;
  // Unique for this call, since tests of both peers run in parallel.
  const testing::TemporaryDirectory directory;
  const std::filesystem::path input = directory.path() / "problem.txt";
  write_problem(input, problem, start);
  const char* words = task == PeerTask::fit                    ? "fit"
                      : task == PeerTask::every_step && python ? "every"
                                                               : "likelihood";
  // One thread each: OpenBLAS would start more.
  const auto text = output_of(fmt::format(
      "OPENBLAS_NUM_THREADS=1 {} {}/{} {} {}", python ? "/usr/bin/python3" : "Rscript --vanilla",
      QUADTUNE_PEERS, python ? "kalman_statsmodels.py" : "kalman_r.R", input.string(), words));
  if (!text) return std::nullopt;
  PeerLikelihood result;
  result.name = python ? "statsmodels" : "R";
  std::istringstream numbers(*text);
  numbers >> result.seconds >> result.value;
  if (task == PeerTask::fit) {
    result.variances.resize(2);
    numbers >> result.evaluations >> result.variances(0) >> result.variances(1);
  }
  if (!numbers) return std::nullopt;
  return result;
}

}  // namespace quadtune::bench
