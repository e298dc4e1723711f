// SPDX-License-Identifier: Apache-2.0
/// Interface for user-defined control laws, which fly() treats like the built-in ones.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>

#include "quadtune/convention.hpp"
#include "quadtune/estimation/on_board.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// Base class of user-defined control laws; OwnController creates the objects. One object serves
/// one flight.
class FlightLaw {
 public:
  FlightLaw() = default;
  FlightLaw(const FlightLaw&) = delete;
  FlightLaw& operator=(const FlightLaw&) = delete;
  virtual ~FlightLaw() = default;

  /// Computes the command of one sample. Called while the vehicle takes off or flies.
  /// @return  inputs of OwnController::input_kind: [T τx τy τz] [N, N m] with T ≥ 0 along body -z,
  ///          or one entry per rotor. A wrong size or an entry that is not finite ends the flight;
  ///          FlightResult::culprit names the entry.
  [[nodiscard]] virtual Eigen::VectorXd command(const Estimate<double>& estimate,
                                                const Reference<double>& reference) = 0;

  /// Reports what the motors realize in this control period, for anti-windup and for laws that
  /// remember their commands. Called in every period, after command() if that was called.
  /// @param asked  return value of command(); equal to `made` while the law does not control the
  ///               motors
  /// @param made   what the motors produce, in the same kind of input
  virtual void on_realized(const Eigen::VectorXd& asked, const Eigen::VectorXd& made) {
    (void)asked;
    (void)made;
  }
};

/// A user-defined controller of a FlightSetup.
struct OwnController {
  std::string name;                          ///< shown in logs and messages
  double dt = 0;                             ///< control period [s], 0.0001 to 1
  InputKind input_kind = InputKind::wrench;  ///< quantities that the law commands
  /// Creates the law of one flight, in the thread that simulates it.
  /// @param vehicle  model for the law
  std::function<std::unique_ptr<FlightLaw>(const Vehicle& vehicle)> make;
};

}  // namespace quadtune
