// SPDX-License-Identifier: Apache-2.0
#include "firmware/px4_mixer.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "quadtune/errors.hpp"

namespace quadtune::exports {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// A rotor of the firmware.
struct BoardRotor {
  double x = 0, y = 0, m = 0;
};

/// The rotor of the vehicle with the same spin and the direction nearest to a rotor of the board.
std::size_t nearest(const Vehicle& vehicle, const BoardRotor& rotor, const std::string& name) {
  constexpr double kAlike = 0.7;  // within 45 degrees
  double best = kAlike;
  std::size_t found = vehicle.rotors.size();
  for (std::size_t i = 0; i < vehicle.rotors.size(); ++i) {
    const Rotor& own = vehicle.rotors[i];
    const double sizes = std::hypot(rotor.x, rotor.y) * own.position.head<2>().norm();
    const double alike = (rotor.x * own.position.x() + rotor.y * own.position.y()) / sizes;
    if ((rotor.m > 0) != (own.spin == Spin::counter_clockwise) || !(alike > best)) continue;
    best = alike;
    found = i;
  }
  if (found == vehicle.rotors.size())
    throw InvalidInput("px4",
                       fmt::format("{}PX, PY, KM are {:.6g}, {:.6g}, {:.6g}, and no rotor of the "
                                   "vehicle is there and turns {}; a rotor "
                                   "in another place would turn the vehicle over",
                                   name, rotor.x, rotor.y, rotor.m, rotor.m > 0 ? "ccw" : "cw"));
  return found;
}

/// The rotors as configured on the board, and the corresponding rotors of the vehicle.
struct BoardRotors {
  std::vector<BoardRotor> rotors;
  std::vector<std::size_t> own;
};

BoardRotors board_rotors(const Vehicle& vehicle, const ParameterValues& value) {
  BoardRotors board;
  std::size_t given = 0;
  for (std::size_t i = 0; i < vehicle.rotors.size(); ++i) {
    const std::string name = fmt::format("CA_ROTOR{}_", i);
    const BoardRotor rotor{value(name + "PX"), value(name + "PY"), value(name + "KM")};
    for (const double number : {rotor.x, rotor.y, rotor.m}) given += !std::isnan(number);
    board.rotors.push_back(rotor);
  }
  if (given == 0) {
    board.own = px4_order(vehicle);
    for (std::size_t i = 0; i < board.own.size(); ++i) {
      const Rotor& rotor = vehicle.rotors[board.own[i]];
      board.rotors[i] = {rotor.position.x(), rotor.position.y(),
                         -spin_sign(rotor.spin) * px4_torque_ratio(rotor)};
    }
    return board;
  }
  if (given != 3 * vehicle.rotors.size())
    throw InvalidInput("px4",
                       fmt::format("the file gives {} of CA_ROTOR*_PX, PY and KM, expected all "
                                   "{} or none",
                                   given, 3 * vehicle.rotors.size()));
  for (std::size_t i = 0; i < board.rotors.size(); ++i) {
    const std::string name = fmt::format("CA_ROTOR{}_", i);
    board.own.push_back(nearest(vehicle, board.rotors[i], name));
    if (std::count(board.own.begin(), board.own.end(), board.own.back()) > 1)
      throw InvalidInput("px4",
                         name +
                             "PX, PY, KM match a rotor of the vehicle that is already assigned; "
                             "expected each rotor of the vehicle once");
  }
  return board;
}

/// Roll, pitch, yaw and thrust (rows) for a unit command of each rotor.
MatrixXd geometry(const std::vector<BoardRotor>& rotors) {
  MatrixXd effect(4, std::ssize(rotors));
  for (std::size_t i = 0; i < rotors.size(); ++i)
    effect.col(static_cast<Index>(i)) << -rotors[i].y, rotors[i].x, rotors[i].m, -1;
  return effect;
}

}  // namespace

double px4_torque_ratio(const Rotor& rotor) {
  return rotor.thrust_a2 > 0 ? rotor.torque_d2 / rotor.thrust_a2
                             : rotor.torque_d1 / rotor.thrust_a1;
}

bool px4_is_x(const Vehicle& vehicle) {
  std::array<int, 4> quarters{};
  for (const Rotor& rotor : vehicle.rotors) {
    const double x = rotor.position.x(), y = rotor.position.y();
    if (std::min(std::abs(x), std::abs(y)) < 0.1 * std::max(std::abs(x), std::abs(y))) return false;
    ++quarters[(x > 0 ? 0U : 2U) + (y > 0 ? 0U : 1U)];
  }
  return quarters == std::array{1, 1, 1, 1};
}

std::vector<std::size_t> px4_order(const Vehicle& vehicle) {
  std::vector<std::size_t> order(vehicle.rotors.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (!px4_is_x(vehicle)) return order;
  // 1 front right, 2 back left, 3 front left, 4 back right.
  const auto place = [&](std::size_t i) {
    const Eigen::Vector3d& at = vehicle.rotors[i].position;
    const bool front = at.x() > 0, right = at.y() > 0;
    return front ? (right ? 0 : 2) : (right ? 3 : 1);
  };
  std::vector<std::size_t> sorted = order;
  std::sort(sorted.begin(), sorted.end(),
            [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
  return sorted;
}

MatrixXd px4_mix(const Vehicle& vehicle, const ParameterValues& value) {
  const double count = value("CA_ROTOR_COUNT");
  if (!std::isnan(count) && count != static_cast<double>(vehicle.rotors.size()))
    throw InvalidInput("px4", fmt::format("CA_ROTOR_COUNT is {:g} but the vehicle has {} rotors; "
                                          "expected the same number",
                                          count, vehicle.rotors.size()));
  constexpr std::size_t kMaxRotors = 12;
  if (vehicle.rotors.size() > kMaxRotors)
    throw InvalidInput("px4", fmt::format("the vehicle has {} rotors; expected at most {}, for "
                                          "which there are parameters",
                                          vehicle.rotors.size(), kMaxRotors));
  const BoardRotors board = board_rotors(vehicle, value);
  const MatrixXd effect = geometry(board.rotors);
  MatrixXd mix = effect.completeOrthogonalDecomposition().pseudoInverse();
  if (!((effect * mix).isIdentity(1e-9)))
    throw InvalidInput("px4",
                       "the rotors cannot produce independent torques about all axes; expected a "
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
  constexpr double kNone = 1e-3;  // smaller entries are treated as zero
  mix = (mix.array().abs() < kNone).select(0, mix);
  MatrixXd result(mix.rows(), 3);
  for (std::size_t i = 0; i < board.own.size(); ++i)
    result.row(static_cast<Index>(board.own[i])) = mix.row(static_cast<Index>(i)).leftCols(3);
  return result;
}

}  // namespace quadtune::exports
