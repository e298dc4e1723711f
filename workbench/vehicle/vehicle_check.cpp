// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/vehicle/vehicle_check.hpp"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <filesystem>
#include <optional>

#include "quadtune/design.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/mixer.hpp"
#include "quadtune/workbench/files/file_kind.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"
#include "quadtune/workbench/flown/flown_family.hpp"

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
  if (std::string why = why_no_estimator(check.vehicle); !why.empty())
    check.obstacles.push_back(std::move(why));
  if (const std::string why = why_no_reserve(check.vehicle); !why.empty())
    check.obstacles.push_back(
        fmt::format("`design`, `pid` and `lqr` require a hover with {:.0f} % of its mass: {}",
                    100 * kHeaviest, why));
  return check;
}

std::vector<std::string> vehicle_warnings(const std::string& word) {
  std::vector<std::string> warnings;
  // The bytes of a pipe can be read only once, by the command itself.
  std::error_code ignored;
  const std::filesystem::path path = word;
  if (path.extension() != ".toml" || !std::filesystem::is_regular_file(path, ignored))
    return warnings;
  try {
    const std::optional<FileKind> kind = file_kind(word);
    if (kind != FileKind::vehicle && kind != FileKind::design) return warnings;
    const Vehicle vehicle =
        kind == FileKind::vehicle ? load_vehicle(word) : load_design(word).vehicle;
    if (vehicle.file.empty()) return warnings;
    for (const Implausibility& figure : find_implausible_values(vehicle))
      warnings.push_back(fmt::format("{}: {}", vehicle.file.string(), to_string(figure)));
  } catch (const InvalidInput&) {
    // The command reports an invalid file.
  } catch (const FileError&) {
    // So it does for one that cannot be read.
  }
  return warnings;
}

}  // namespace quadtune
