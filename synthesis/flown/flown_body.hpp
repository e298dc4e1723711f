// SPDX-License-Identifier: Apache-2.0
/// The continuous part of a flown plant: rigid body and rotors about a hover, and the true values
/// that the sensors measure.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/simulation/flight.hpp"
#include "quadtune/synthesis/flown_plant.hpp"

namespace quadtune::internal {

/// ẋ = A x + B c, readings = C x + D c, with c the commanded rotor speeds [rad/s].
struct FlownBody {
  Eigen::MatrixXd A, B;
  Eigen::MatrixXd C, D;      ///< kFrameSize rows
  Eigen::VectorXd readings;  ///< kFrameSize values in the hover; NaN for a sensor that is not used
  StateVector<double> x;     ///< the hover
  Eigen::VectorXd speeds;    ///< rotor speeds in the hover [rad/s]
  Eigen::MatrixXd commands;  ///< (rotors × inputs): commanded speed per input of the law
  std::vector<Signal> states;  ///< the 12, then the speeds of rotors with lag
  std::vector<Signal> inputs;  ///< inputs of the law
};

/// Leaves out the couplings between the four groups of axes, see FlownPlantOptions::separate_axes.
/// For wrench inputs.
void separate_axes(FlownBody& body);

/// Linearizes body, rotors and readings about the hover at `height` [m].
/// @throws InvalidInput  if either vehicle cannot hover
[[nodiscard]] FlownBody flown_body(const FlightSetup& setup, InputKind inputs, double height);

/// Computes the change of the commanded rotor speeds per input of a law (rotors × inputs) [rad/s
/// per unit of the input].
/// @param speeds  rotor speeds in the hover [rad/s]
[[nodiscard]] Eigen::MatrixXd commanded_speeds(const Vehicle& believed,
                                               const Eigen::VectorXd& speeds, InputKind inputs);

}  // namespace quadtune::internal
