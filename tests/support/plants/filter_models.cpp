// SPDX-License-Identifier: Apache-2.0
#include "plants/filter_models.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

namespace quadtune::testing {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

CovarianceModel one_variance(int parameter) {
  return {MatrixXd::Zero(1, 1), {{MatrixXd::Identity(1, 1), parameter}}, {}};
}

MatrixXd normal_matrix(std::mt19937_64& random, Eigen::Index rows, Eigen::Index cols) {
  std::normal_distribution<double> normal;
  MatrixXd M(rows, cols);
  for (Eigen::Index i = 0; i < M.size(); ++i) M.data()[i] = normal(random);
  return M;
}

/// A root of a covariance that may be singular.
MatrixXd root_of(const MatrixXd& M) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(M);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
}

/// One step by the plain series of a block exponential, or by powers: slow and independent of the
/// library.
struct Step {
  MatrixXd F, B, Q;
};
Step step_of(const FilterModel& model, const MatrixXd& noise, double dt) {
  const Eigen::Index nx = model.A.rows(), nu = model.B.cols();
  if (model.dt > 0) {
    Step step{MatrixXd::Identity(nx, nx), MatrixXd::Zero(nx, nu), MatrixXd::Zero(nx, nx)};
    for (int k = 0; k < std::lround(dt / model.dt); ++k) {
      step.Q = (model.A * step.Q * model.A.transpose() + noise).eval();
      step.B = (model.A * step.B + model.B).eval();
      step.F = (model.A * step.F).eval();
    }
    return step;
  }
  MatrixXd block = MatrixXd::Zero(nx + nu, nx + nu);
  block.topLeftCorner(nx, nx) = model.A;
  block.topRightCorner(nx, nu) = model.B;
  const MatrixXd held = (block * dt).exp();
  MatrixXd van_loan = MatrixXd::Zero(2 * nx, 2 * nx);
  van_loan.topLeftCorner(nx, nx) = -model.A;
  van_loan.topRightCorner(nx, nx) = noise;
  van_loan.bottomRightCorner(nx, nx) = model.A.transpose();
  const MatrixXd phi = (van_loan * dt).exp();
  const MatrixXd F = held.topLeftCorner(nx, nx);
  return {F, held.topRightCorner(nx, nu), F * phi.topRightCorner(nx, nx)};
}

}  // namespace

FilterModel local_level() {
  FilterModel m;
  m.name = "local-level";
  m.dt = 1;
  m.states = {{"level", ""}};
  m.noises = {{"level", ""}};
  m.A = m.G = MatrixXd::Identity(1, 1);
  m.B.resize(1, 0);
  m.parameters = {{"Q.level", "", true, 1000}, {"R.y", "", true, 1000}};
  m.Q = one_variance(0);
  FilterSensor& sensor = m.sensors.emplace_back();
  sensor.name = "y";
  sensor.outputs = {{"y", ""}};
  sensor.C = MatrixXd::Identity(1, 1);
  sensor.R = one_variance(1);
  m.x0 = VectorXd::Zero(1);
  m.P0 = MatrixXd::Zero(1, 1);
  m.diffuse = {true};
  return m;
}

FilterModel discrete_altitude() {
  FilterModel m;
  m.name = "altitude";
  m.dt = 0.005;
  m.states = {{"z", "m"}, {"vz", "m/s"}};
  m.inputs = {{"az", "m/s2"}};
  m.noises = {{"vz", "m/s"}};
  m.A = MatrixXd{{1, 0.005}, {0, 1}};
  m.B = MatrixXd{{0}, {0.005}};
  m.G = MatrixXd{{0}, {1}};
  m.parameters = {{"Q.vz", "m2/s2", true, 0.0005}, {"R.sonar", "m2", true, 0.1}};
  m.Q = one_variance(0);
  FilterSensor& sensor = m.sensors.emplace_back();
  sensor.name = "sonar";
  sensor.outputs = {{"z", "m"}};
  sensor.C = MatrixXd{{1, 0}};
  sensor.R = one_variance(1);
  m.x0 = VectorXd::Zero(2);
  m.P0 = MatrixXd::Zero(2, 2);
  m.diffuse = {true, true};
  return m;
}

FilterModel random_model(std::mt19937_64& random, int nx, int nu, bool continuous, bool full) {
  std::uniform_real_distribution<double> uniform;
  FilterModel m;
  m.name = "random";
  m.dt = continuous ? 0 : 0.1;
  const int nw = 1 + nx / 2;
  for (int i = 0; i < nx; ++i) m.states.push_back({"x" + std::to_string(i + 1), ""});
  for (int i = 0; i < nu; ++i) m.inputs.push_back({"u" + std::to_string(i + 1), ""});
  for (int i = 0; i < nw; ++i) m.noises.push_back({"w" + std::to_string(i + 1), ""});
  m.A = normal_matrix(random, nx, nx);
  const double radius = m.A.eigenvalues().cwiseAbs().maxCoeff();
  m.A *= (continuous ? 0.5 : 0.9) / radius;
  if (continuous) m.A -= 0.6 * MatrixXd::Identity(nx, nx);
  m.B = normal_matrix(random, nx, nu);
  m.G = normal_matrix(random, nx, nw);
  const auto variance = [&](const std::string& name) {
    m.parameters.push_back({name, "", true, 0.2 + uniform(random)});
    return static_cast<int>(m.parameters.size()) - 1;
  };
  m.Q.fixed = 0.1 * MatrixXd::Identity(nw, nw);
  for (int i = 0; i < nw; ++i) {
    MatrixXd shape = MatrixXd::Zero(nw, nw);
    shape(i, i) = 1;
    m.Q.scaled.push_back({shape, variance("Q." + std::to_string(i + 1))});
  }
  FilterSensor one, two;
  one.name = "one";
  one.outputs = {{"a", ""}};
  one.C = normal_matrix(random, 1, nx);
  one.R = one_variance(variance("R.one"));
  two.name = "two";
  two.outputs = {{"b", ""}, {"c", ""}};
  two.C = normal_matrix(random, 2, nx);
  if (nu > 0) two.D = normal_matrix(random, 2, nu);
  two.R.fixed = 0.05 * MatrixXd::Identity(2, 2);
  if (full) {
    two.R.full.push_back({{0, 1}, static_cast<int>(m.parameters.size())});
    variance("R.b");
    m.parameters.push_back({"R.bc", "", false, 0.7});
    variance("R.c");
  } else {
    for (int i = 0; i < 2; ++i) {
      MatrixXd shape = MatrixXd::Zero(2, 2);
      shape(i, i) = 1;
      two.R.scaled.push_back({shape, variance(i == 0 ? "R.b" : "R.c")});
    }
  }
  m.sensors = {one, two};
  m.x0 = normal_matrix(random, nx, 1);
  const MatrixXd root = normal_matrix(random, nx, nx);
  m.P0 = root * root.transpose();
  m.diffuse.assign(static_cast<std::size_t>(nx), false);
  return m;
}

FilterRecord simulated(const FilterModel& model, const VectorXd& theta, int N, double dt,
                       std::mt19937_64& random, double missing, double jitter) {
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  const Eigen::Index nx = model.A.rows(), nu = model.B.cols();
  FilterRecord record;
  record.name = "simulated";
  record.y.setConstant(model.outputs(), N, std::nan(""));
  record.u.resize(nu, N);
  const MatrixXd noise = model.G * covariance(model.Q, theta) * model.G.transpose();
  VectorXd x = model.x0 + root_of(model.P0) * normal_matrix(random, nx, 1);
  for (Eigen::Index i = 0; i < nx; ++i)
    if (model.diffuse[static_cast<std::size_t>(i)]) x(i) += normal(random);
  double t = 0;
  Step step = step_of(model, noise, dt);
  MatrixXd root = root_of(step.Q);
  for (int k = 0; k < N; ++k) {
    record.time.push_back(t);
    record.u.col(k) = normal_matrix(random, nu, 1);
    Eigen::Index first = 0;
    for (const FilterSensor& sensor : model.sensors) {
      const Eigen::Index ny = sensor.C.rows();
      VectorXd y = sensor.C * x;
      if (sensor.D.size() > 0) y += sensor.D * record.u.col(k);
      y += root_of(covariance(sensor.R, theta)) * normal_matrix(random, ny, 1);
      if (uniform(random) >= missing) record.y.col(k).segment(first, ny) = y;
      first += ny;
    }
    double now = dt;
    if (jitter > 0) {
      now *= 1 + jitter * (2 * uniform(random) - 1);
      now = std::round(now * 1e7) * 1e-7;
      step = step_of(model, noise, now);
      root = root_of(step.Q);
    }
    x = (step.F * x + step.B * record.u.col(k) + root * normal_matrix(random, nx, 1)).eval();
    t += now;
  }
  return record;
}

FilterRecord linearized(const FilterModel& model, FilterRecord record) {
  for (Eigen::Index k = 0; k < record.samples(); ++k) {
    LinearizedInstant at;
    at.C.resize(model.outputs(), model.A.rows());
    Eigen::Index first = 0;
    for (const FilterSensor& sensor : model.sensors) {
      at.C.middleRows(first, sensor.C.rows()) = sensor.C;
      first += sensor.C.rows();
    }
    at.F = model.A;
    at.offset = model.B * record.u.col(k);
    for (const ScaledCovariance& term : model.Q.scaled)
      at.noise.push_back(model.G * term.shape * model.G.transpose());
    record.linearized.push_back(at);
  }
  return record;
}

}  // namespace quadtune::testing
