// SPDX-License-Identifier: Apache-2.0
#include "firmware/px4_mixer.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "quadtune/errors.hpp"

namespace quadtune::exports {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Drag torque over thrust at hover is that of the squares, of which a thrust curve mostly
/// consists.
double torque_ratio(const Rotor& rotor) {
  return rotor.thrust_a2 > 0 ? rotor.torque_d2 / rotor.thrust_a2
                             : rotor.torque_d1 / rotor.thrust_a1;
}

/// Rows roll, pitch, yaw, thrust of a unit command of each rotor.
MatrixXd geometry(const Vehicle& vehicle, const ParameterValues& value) {
  const std::vector<std::size_t> order = px4_order(vehicle);
  MatrixXd effect(4, std::ssize(order));
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Rotor& rotor = vehicle.rotors[order[i]];
    const std::string name = fmt::format("CA_ROTOR{}_", i);
    const auto or_own = [&](const char* key, double own) {
      const double given = value(name + key);
      return std::isnan(given) ? own : given;
    };
    const double x = or_own("PX", rotor.position.x()), y = or_own("PY", rotor.position.y());
    const double m = or_own("KM", -spin_sign(rotor.spin) * torque_ratio(rotor));
    if ((m > 0) != (rotor.spin == Spin::counter_clockwise) || (x > 0) != (rotor.position.x() > 0) ||
        (y > 0) != (rotor.position.y() > 0))
      throw InvalidInput(
          "px4", fmt::format("{0}PX, PY, KM are {1:.6g}, {2:.6g}, {3:.6g} and the vehicle's "
                             "rotor is at ({4:.6g}, {5:.6g}) m and turns {6}, expected the "
                             "same quarter and sense (KM > 0 is ccw), because rotors in "
                             "another order turn the vehicle over",
                             name, x, y, m, rotor.position.x(), rotor.position.y(),
                             to_string(rotor.spin)));
    effect.col(static_cast<Index>(i)) << -y, x, m, -1;
  }
  return effect;
}

}  // namespace

std::vector<std::size_t> px4_order(const Vehicle& vehicle) {
  std::vector<std::size_t> order(vehicle.rotors.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (order.size() != 4) return order;
  // 1 front right, 2 back left, 3 front left, 4 back right.
  const auto place = [&](std::size_t i) {
    const Eigen::Vector3d& at = vehicle.rotors[i].position;
    const bool front = at.x() > 0, right = at.y() > 0;
    return front ? (right ? 0 : 2) : (right ? 3 : 1);
  };
  std::vector<std::size_t> sorted = order;
  std::sort(sorted.begin(), sorted.end(),
            [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
  for (std::size_t i = 0; i < 4; ++i)
    if (place(sorted[i]) != static_cast<int>(i)) return order;
  return sorted;
}

MatrixXd px4_mix(const Vehicle& vehicle, const ParameterValues& value) {
  const double count = value("CA_ROTOR_COUNT");
  if (!std::isnan(count) && count != static_cast<double>(vehicle.rotors.size()))
    throw InvalidInput("px4", fmt::format("CA_ROTOR_COUNT is {:g} and the vehicle has {} rotors, "
                                          "expected the same number",
                                          count, vehicle.rotors.size()));
  constexpr std::size_t kMostRotors = 12;
  if (vehicle.rotors.size() > kMostRotors)
    throw InvalidInput("px4", fmt::format("the vehicle has {} rotors, expected at most {}, for "
                                          "which there are parameters",
                                          vehicle.rotors.size(), kMostRotors));
  const MatrixXd effect = geometry(vehicle, value);
  MatrixXd mix = effect.completeOrthogonalDecomposition().pseudoInverse();
  if (!((effect * mix).isIdentity(1e-9)))
    throw InvalidInput("px4",
                       "the rotors cannot turn about each axis by themselves, expected a "
                       "geometry with which roll, pitch, yaw and thrust are independent");
  const auto used = [&](Index column) {
    return static_cast<double>((mix.col(column).array().abs() > 1e-9).count());
  };
  const auto tilt_scale = [&](Index column) {
    return std::sqrt(mix.col(column).squaredNorm() / (used(column) / 2));
  };
  const double tilt = std::max(tilt_scale(0), tilt_scale(1));
  mix.leftCols(2) /= tilt;
  mix.col(2) /= mix.col(2).maxCoeff();
  constexpr double kNone = 1e-3;  // smaller entries are no entries
  mix = (mix.array().abs() < kNone).select(0, mix);
  const std::vector<std::size_t> order = px4_order(vehicle);
  MatrixXd result(mix.rows(), 3);
  for (std::size_t i = 0; i < order.size(); ++i)
    result.row(static_cast<Index>(order[i])) = mix.row(static_cast<Index>(i)).leftCols(3);
  return result;
}

}  // namespace quadtune::exports
