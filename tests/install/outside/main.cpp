// SPDX-License-Identifier: Apache-2.0
// Calls a function of every installed library and checks the result: matrices that the library
// allocates and this program frees, and structs of fixed-size matrices, whose layout must be the
// same in both.
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <quadtune/convention.hpp>
#include <quadtune/discretize/zoh.hpp>
#include <quadtune/exports/file_set.hpp>
#include <quadtune/linearize/trim.hpp>
#include <quadtune/logs/flight_log.hpp>
#include <quadtune/model/vehicle.hpp>
#include <quadtune/synthesis/riccati.hpp>
#include <quadtune/tuning/bryson.hpp>
#include <quadtune/version.hpp>
#include <quadtune/workbench/flight/fly.hpp>
#include <string>

namespace {

void expect(bool holds, const std::string& what) {
  if (holds) return;
  std::cout << "wrong: " << what << '\n';
  std::exit(1);
}

void check_lib() {
  const quadtune::Convention& uquad = quadtune::convention("uquad", "outside");
  expect(quadtune::names(uquad.states) == "x y z psi phi theta vqx vqy vqz wqx wqy wqz",
         "names of the uquad states");
  expect((uquad.from_ned * uquad.from_ned.transpose()).isIdentity(0), "uquad is a permutation");
  expect(uquad.wrench_from_ned.cwiseAbs().sum() == 4, "wrench of uquad");
  const Eigen::MatrixXd inputs =
      quadtune::input_from_ned(uquad, quadtune::InputKind::rotor_speed, 6);
  expect(inputs.isIdentity(0) && inputs.rows() == 6, "six rotor speeds");
}

// MAT files need a library that the installed ones load from their folder.
void check_mat_files() {
  quadtune::LogTable log;
  log.columns = {{"t", "s", {0, 0.5}}, {"x", "m", {1, -2}}};
  const quadtune::LogTable back = quadtune::table_of_mat(quadtune::bytes_of_mat(log), "outside");
  expect(back.columns.size() == 2 && back.columns[1].values == log.columns[1].values, "a MAT file");
}

// The built-in vehicle hovers level, on rotors that turn at one speed.
void check_linearize() {
  const quadtune::TrimResult hover = quadtune::trim(quadtune::load_vehicle("uquad"), {});
  expect(hover.solved(), "trim of the uquad");
  expect(std::abs(hover.u(0) - 316.103650939028) < 1e-6, "hover speed of the uquad");
}

// A double integrator held for 2 s: x moves by u 2²/2, its speed by 2 u.
void check_discretize() {
  quadtune::ContinuousLti plant;
  plant.A = Eigen::Matrix2d{{0, 1}, {0, 0}};
  plant.B = Eigen::Vector2d{0, 1};
  const quadtune::DiscreteLti sampled = quadtune::discretize_zoh(plant, 2);
  expect(sampled.A.isApprox(Eigen::Matrix2d{{1, 2}, {0, 1}}, 1e-14), "A of the sampled model");
  expect(sampled.B.isApprox(Eigen::Vector2d{2, 2}, 1e-14), "B of the sampled model");
}

// [Carex95] example 1: X = [2 1; 1 2].
void check_synthesis() {
  const Eigen::MatrixXd A = Eigen::Matrix2d{{0, 1}, {0, 0}};
  const Eigen::MatrixXd B = Eigen::Vector2d{0, 1};
  const Eigen::MatrixXd Q = Eigen::Matrix2d{{1, 0}, {0, 2}};
  const quadtune::RiccatiResult r = quadtune::care(A, B, Q, Eigen::MatrixXd::Identity(1, 1));
  expect(r.solved() && r.X.isApprox(Eigen::Matrix2d{{2, 1}, {1, 2}}, 1e-12), "CAREX example 1");
}

void check_tuning() {
  const quadtune::LqrWeights weights =
      quadtune::bryson_weights(Eigen::Vector2d{0.5, 2}, Eigen::VectorXd::Constant(1, 10));
  expect(weights.Q.isApprox(Eigen::Matrix2d{{4, 0}, {0, 0.25}}, 1e-15), "Bryson's weights");
}

void check_exports() {
  expect(quadtune::sha256("abc") ==  // FIPS 180-4
             "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad",
         "SHA-256");
}

// Half a second of flight by a single call, with a struct of options whose layout must be the same
// in both.
void check_workbench() {
  quadtune::FlightOptions options;
  options.duration = 0.5;
  const quadtune::FlownFlight flown = quadtune::fly(quadtune::load_vehicle("mambo"), options);
  expect(flown.result.end == quadtune::FlightEnd::completed, "half a second of flight");
  expect(flown.plan.margins && flown.plan.margins->loops.size() == 4, "margins of the cascade");
}

}  // namespace

int main() {
  check_lib();
  check_mat_files();
  check_linearize();
  check_discretize();
  check_synthesis();
  check_tuning();
  check_exports();
  check_workbench();
  std::cout << "quadtune " << quadtune::kVersion << " ok\n";
}
