// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/vehicle/vehicle_check.hpp"

#include <fmt/format.h>

#include <Eigen/SVD>

#include "quadtune/errors.hpp"
#include "quadtune/model/mixer.hpp"

namespace quadtune {

void require_authority(const Vehicle& vehicle, const TrimResult& hover, const std::string& name) {
  Eigen::MatrixXd J = wrench_jacobian(vehicle, hover.u);
  const char* axes[] = {"thrust", "roll", "pitch", "yaw"};
  for (Eigen::Index i = 0; i < 4; ++i)
    if (J.row(i).norm() == 0)
      throw NoSolution(fmt::format("{}: cannot be controlled: no rotor changes {}", name, axes[i]),
                       name);
  J.rowwise().normalize();
  const Eigen::VectorXd singular = Eigen::JacobiSVD<Eigen::MatrixXd>(J).singularValues();
  if (singular.size() < 4 || singular(3) < 1e-9)
    throw NoSolution(name +
                         ": cannot be controlled: the rotors cannot change thrust and the three "
                         "torques independently of one another",
                     name);
}

VehicleCheck check_vehicle(const std::string& name) {
  VehicleCheck check;
  check.vehicle = load_vehicle(name);
  check.hover = trim(check.vehicle, FlightCondition{});
  check.warnings = find_implausible_values(check.vehicle);
  if (!check.hover.solved())
    throw NoSolution(
        fmt::format("{}: cannot hover: {}{}", name, check.hover.culprit,
                    check.warnings.empty() ? "" : "; " + to_string(check.warnings.front())),
        name);
  require_authority(check.vehicle, check.hover, name);
  return check;
}

}  // namespace quadtune
