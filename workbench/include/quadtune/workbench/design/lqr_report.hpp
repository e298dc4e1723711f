// SPDX-License-Identifier: Apache-2.0
/// LQR state feedback, for given matrices or for a vehicle at a trim, with its evidence.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/design.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/synthesis/lqr.hpp"
#include "quadtune/synthesis/state_feedback.hpp"
#include "quadtune/workbench/design/linearize_or_refuse.hpp"
#include "quadtune/workbench/design/margins_report.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune {

/// An LQR problem for given matrices.
struct LqrProblem {
  Eigen::MatrixXd A;      ///< (nx × nx)
  Eigen::MatrixXd B;      ///< (nx × nu)
  LqrWeights weights;     ///< per step if `discrete`, otherwise continuous
  bool discrete = false;  ///< A and B are discrete
  /// Hold time of the input for the continuous problem [s], > 0; excludes `discrete`.
  std::optional<double> sampled = {};
};

/// The solution of an LqrProblem with its evidence.
struct LqrReport {
  RiccatiResult riccati;              ///< if it is not solved, the margins are empty
  double dt = 0;                      ///< [s]; 0 for a continuous loop, 1 for a discrete problem
  MarginsReport margins;              ///< at the inputs u1, u2, …
  std::vector<std::string> messages;  ///< "warning: …" and "note: …" for the user
};

/// @param problem   plant as matrices, and weights
/// @param evidence  none: as much as takes about a second, with a note about what was omitted
/// @throws InvalidInput  as lqr()
[[nodiscard]] LqrReport lqr_report(const LqrProblem& problem,
                                   std::optional<MarginsEvidence> evidence = {});

/// The same for a vehicle at a trim, with ideal rotors and known states.
struct VehicleLqrReport {
  LinearVehicle plant;     ///< vehicle, trim and model
  LqrDesign design;        ///< the problem
  StateFeedback feedback;  ///< if it is not solved, the following members are empty
  Gains gains;             ///< of the law
  Eigen::VectorXcd poles;  ///< of the loop as implemented, flying_poles()
  MarginsReport margins;   ///< of the same loop
  /// With motor lag, sensors and estimator. No value unless has_flown_loop() or if the gains use
  /// some states only; also none, with a note, if the loop cannot be analysed, e.g. because of its
  /// sample period.
  std::optional<FlownLoop> flown;
  std::vector<std::string> messages;  ///< "warning: …" and "note: …" for the user
};

/// @param plant     vehicle, trim and model
/// @param design    in the convention of the plant's model
/// @param evidence  how much is computed of the margins
/// @throws InvalidInput  as state_feedback()
[[nodiscard]] VehicleLqrReport lqr_report(LinearVehicle plant, LqrDesign design,
                                          MarginsEvidence evidence = MarginsEvidence::full);

}  // namespace quadtune
