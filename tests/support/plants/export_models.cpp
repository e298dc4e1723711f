// SPDX-License-Identifier: Apache-2.0
#include "plants/export_models.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "plants/hover_model.hpp"

namespace quadtune::testing {
namespace {

using Eigen::MatrixXd;

// In hover p' = v, v' = ±g angle + …, angle' = rate: A is nilpotent, so the series ends.
DiscreteLti sampled(const MatrixXd& A, const MatrixXd& B, double dt) {
  const MatrixXd I = MatrixXd::Identity(A.rows(), A.cols());
  DiscreteLti plant;
  plant.A = I + A * dt + A * A * dt * dt / 2 + A * A * A * std::pow(dt, 3) / 6;
  plant.B =
      (I * dt + A * dt * dt / 2 + A * A * std::pow(dt, 3) / 6 + A * A * A * std::pow(dt, 4) / 24) *
      B;
  plant.dt = dt;
  return plant;
}

}  // namespace

DiscreteLti sampled_uquad() {
  const ContinuousLti hover = uquad_hover();
  DiscreteLti plant = sampled(hover.A, hover.B, 0.01);
  plant.states = hover.states;
  plant.inputs = hover.inputs;
  return plant;
}

DiscreteLti sampled_mambo() {
  enum { phi, theta, psi, p, q, r, x, y, z, u, v, w };
  const double g = 9.81;
  MatrixXd A = MatrixXd::Zero(12, 12);
  A(x, u) = A(y, v) = A(z, w) = A(phi, p) = A(theta, q) = A(psi, r) = 1;
  A(u, theta) = -g;
  A(v, phi) = g;
  MatrixXd B = MatrixXd::Zero(12, 4);
  B(w, 0) = -1 / 0.063;
  B(p, 1) = 1 / 5.82857e-5;
  B(q, 2) = 1 / 7.16914e-5;
  B(r, 3) = 1 / 1.0e-4;
  DiscreteLti plant = sampled(A, B, 0.005);
  const Convention& c = convention("mambo", "test");
  plant.states = c.states;
  plant.inputs = c.wrench;
  return plant;
}

DiscreteLti without_horizontal_position(const DiscreteLti& plant) {
  const std::vector<int> kept = {2, 3, 4, 5, 8, 9, 10, 11};
  DiscreteLti result = plant;
  result.A = plant.A(kept, kept);
  result.B = plant.B(kept, Eigen::all);
  result.states.clear();
  for (const int i : kept) result.states.push_back(plant.states[static_cast<std::size_t>(i)]);
  return result;
}

Gains hover_gains(const DiscreteLti& plant, const std::string& convention, InputKind kind, double R,
                  const std::vector<std::string>& integrated) {
  const Eigen::Index nx = plant.A.rows();
  const auto ni = static_cast<Eigen::Index>(integrated.size());
  const Eigen::Index nu = plant.B.cols();
  Gains gains;
  gains.states = plant.states;
  gains.inputs = plant.inputs;
  MatrixXd A = MatrixXd::Identity(nx + ni, nx + ni);
  A.topLeftCorner(nx, nx) = plant.A;
  MatrixXd B = MatrixXd::Zero(nx + ni, nu);
  B.topRows(nx) = plant.B;
  MatrixXd Q = MatrixXd::Identity(nx + ni, nx + ni);
  for (Eigen::Index j = 0; j < nx; ++j) {
    const Signal& state = plant.states[static_cast<std::size_t>(j)];
    if (state.unit == "rad") Q(j, j) = 1e3;
    for (Eigen::Index i = 0; i < ni; ++i)
      if (state.name == integrated[static_cast<std::size_t>(i)]) A(nx + i, j) = plant.dt;
  }
  for (const std::string& name : integrated)
    for (const Signal& state : plant.states)
      if (state.name == name) gains.integrals.push_back({name, state.unit + " s"});

  MatrixXd P = Q;
  MatrixXd K;
  for (int i = 0; i < 5000; ++i) {
    // K = (R + BᵀPB)⁻¹ BᵀPA, P ← Q + AᵀP (A - BK)
    K = (R * MatrixXd::Identity(nu, nu) + B.transpose() * P * B)
            .ldlt()
            .solve(B.transpose() * P * A);
    P = Q + A.transpose() * P * (A - B * K);
    P = (P + P.transpose()).eval() / 2;
  }
  gains.K = K.leftCols(nx);
  gains.K_int = K.rightCols(ni);
  gains.x0 = Eigen::VectorXd::Zero(nx);
  gains.u0 = Eigen::VectorXd::Zero(nu);
  gains.vehicle = convention;
  gains.convention = convention;
  gains.input_kind = kind;
  gains.dt = plant.dt;
  return gains;
}

namespace {

ExportContent make_uquad_content() {
  ExportContent content;
  content.vehicle.name = "uquad";
  content.plant = sampled_uquad();
  content.gains =
      hover_gains(*content.plant, "uquad", InputKind::rotor_speed, 0.01, {"x", "y", "z", "theta"});
  content.gains->x0(2) = 1;
  content.gains->u0.setConstant(316.103650939028);
  content.Q = MatrixXd::Identity(16, 16);
  content.R = 0.01 * MatrixXd::Identity(4, 4);
  content.evidence.method = "discrete";
  content.evidence.status = "solved";
  content.evidence.residual = 1e-15;
  content.evidence.rcond = 1e-6;
  content.evidence.poles.resize(2);
  content.evidence.poles << std::complex<double>(0.9, 0.1), std::complex<double>(0.9, -0.1);
  content.inputs = {{"uquad-hover.toml", "abc"}};
  return content;
}

ExportContent make_mambo_content() {
  ExportContent content;
  content.vehicle = load_vehicle("mambo");
  content.vehicle.airframe_height = 0.04;
  content.vehicle.airframe_diameter = 0.01;
  content.plant = sampled_mambo();
  content.gains = hover_gains(*content.plant, "mambo", InputKind::wrench, 1, {"pz", "psi"});
  content.gains->u0(0) = 0.063 * 9.81;

  KalmanFilter altitude;
  altitude.name = "altitude";
  altitude.model.A = MatrixXd{{1, 0.005}, {0, 1}};
  altitude.model.B = MatrixXd{{0}, {0.005}};
  altitude.model.C = MatrixXd{{1, 0}};
  altitude.model.dt = 0.005;
  altitude.model.states = {{"z", "m"}, {"vz", "m/s"}};
  altitude.model.inputs = {{"az", "m/s^2"}};
  altitude.model.outputs = {{"height", "m"}};
  altitude.G = MatrixXd{{0}, {1}};
  altitude.Q = MatrixXd::Constant(1, 1, 5e-4);
  altitude.R = MatrixXd::Constant(1, 1, 0.1);
  altitude.N = MatrixXd::Zero(1, 1);
  altitude.M = MatrixXd{{0.0262414206418703}, {0.0697767360714920}};
  altitude.L = altitude.model.A * altitude.M;
  altitude.P = MatrixXd::Identity(2, 2);
  altitude.Z = MatrixXd::Identity(2, 2);
  KalmanFilter velocity = altitude;
  velocity.name = "velocity";
  content.filters = {altitude, velocity};

  content.cascade.emplace();
  content.cascade->gains.dt = 0.005;
  content.cascade->gains.loops = {{"x", "pitch", "rad/m", -0.24, 0, 0.1},
                                  {"y", "roll", "rad/m", 0.24, 0, -0.1},
                                  {"pitch", "tau_y", "N m/rad", 0.013, 0.01, -0.002},
                                  {"roll", "tau_x", "N m/rad", 0.01, 0.01, -0.003},
                                  {"yaw", "tau_z", "N m/rad", 0.004, 0, -0.0012},
                                  {"altitude", "T", "N/m", 0.8, 0.1, -0.5}};
  return content;
}

}  // namespace

ExportContent uquad_content() {
  static const ExportContent content = make_uquad_content();
  return content;
}

ExportContent mambo_content() {
  static const ExportContent content = make_mambo_content();
  return content;
}

}  // namespace quadtune::testing
