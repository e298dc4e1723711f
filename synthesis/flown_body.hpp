// SPDX-License-Identifier: Apache-2.0
/// The continuous part of a flown plant: rigid body and rotors about a hover, and what the sensors
/// read of them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/simulation/flight.hpp"
#include "quadtune/synthesis/flown_plant.hpp"

namespace quadtune::internal {

/// ẋ = A x + B c, readings = C x + D c, c the speeds that the rotors are told [rad/s].
struct FlownBody {
  Eigen::MatrixXd A, B;
  Eigen::MatrixXd C, D;        ///< kFrameSize rows
  Eigen::VectorXd readings;    ///< kFrameSize values in the hover; NaN where nothing is read
  StateVector<double> x;       ///< the hover
  Eigen::VectorXd speeds;      ///< of the rotors there [rad/s]
  Eigen::MatrixXd commands;    ///< (rotors × inputs): speeds told per input of the law
  std::vector<Signal> states;  ///< the 12, then the speeds of rotors with lag
  std::vector<Signal> inputs;  ///< of the law
};

/// @throws InvalidInput  if either vehicle cannot hover
[[nodiscard]] FlownBody flown_body(const FlightSetup& setup, InputKind inputs, double height);

}  // namespace quadtune::internal
