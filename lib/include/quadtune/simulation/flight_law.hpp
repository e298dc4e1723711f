// SPDX-License-Identifier: Apache-2.0
/// A control law of the user's own, which fly() flies like those that come with quadtune.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>

#include "quadtune/convention.hpp"
#include "quadtune/estimation/on_board.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// Implement this, and have OwnController make it. One object controls one flight.
class FlightLaw {
 public:
  FlightLaw() = default;
  FlightLaw(const FlightLaw&) = delete;
  FlightLaw& operator=(const FlightLaw&) = delete;
  virtual ~FlightLaw() = default;

  /// One sample, while the vehicle takes off or flies.
  /// @return  inputs of OwnController::input_kind: [T τx τy τz] [N, N m] with T ≥ 0 along body -z,
  ///          or one entry a rotor. Another size, or an entry that is not finite, ends the flight:
  ///          its FlightResult::culprit names the entry.
  [[nodiscard]] virtual Eigen::VectorXd command(const Estimate<double>& estimate,
                                                const Reference<double>& reference) = 0;

  /// What the motors carry out in this control period, for integrals that must not wind up and laws
  /// that remember their commands. Called in every period, after command() if that was called.
  /// @param asked  what command() returned; `made` while the law does not have the motors
  /// @param made   what the motors produce of it, in the same kind of input
  virtual void carried_out(const Eigen::VectorXd& asked, const Eigen::VectorXd& made) {
    (void)asked;
    (void)made;
  }
};

/// A Controller of a FlightSetup.
struct OwnController {
  std::string name;  ///< in logs and messages
  double dt = 0;     ///< control period [s], 0.0001 to 1
  InputKind input_kind = InputKind::wrench;
  /// Makes the law of one flight, in the thread that flies it.
  /// @param vehicle  as the law believes it to be
  std::function<std::unique_ptr<FlightLaw>(const Vehicle& vehicle)> make;
};

}  // namespace quadtune
