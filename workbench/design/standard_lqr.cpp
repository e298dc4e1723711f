// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/standard_lqr.hpp"

#include "quadtune/convention.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/synthesis/lqr.hpp"
#include "quadtune/tuning/bryson.hpp"
#include "quadtune/workbench/design/cascade_report.hpp"

namespace quadtune {

LqrWeights standard_weights(const CascadeVehicle& vehicle) {
  Eigen::VectorXd deviation(12);
  deviation << 0.25, 0.25, 0.25, 0.2, 0.2, 0.35, 0.5, 0.5, 0.5, 2, 2, 2;
  const Eigen::Vector4d share(0.15, 0.12, 0.12, 0.12);
  return bryson_weights(deviation, vehicle.authority.cwiseProduct(share));
}

RiccatiResult standard_lqr(const CascadeVehicle& vehicle, const std::string& who) {
  RiccatiResult riccati = lqr(vehicle.hover, standard_weights(vehicle));
  if (!riccati.solved()) throw NoSolution(who + ": lqr: " + riccati.culprit, "V");
  return riccati;
}

Gains standard_gains(const Vehicle& vehicle, const std::string& who) {
  Gains gains;
  gains.K = standard_lqr(cascade_vehicle(vehicle, who), who).K;
  gains.K_int = Eigen::MatrixXd(4, 0);
  gains.states = ned_convention().states;
  gains.inputs = ned_convention().wrench;
  gains.x0 = Eigen::VectorXd::Zero(12);
  gains.u0 = Eigen::Vector4d(vehicle.mass * vehicle.gravity, 0, 0, 0);
  gains.vehicle = vehicle.name;
  gains.convention = "ned";
  gains.input_kind = InputKind::wrench;
  return gains;
}

}  // namespace quadtune
