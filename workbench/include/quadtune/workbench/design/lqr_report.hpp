// SPDX-License-Identifier: Apache-2.0
/// State feedback by LQR, of matrices and of a vehicle about a trim, with its evidence.
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

/// An LQR problem of matrices.
struct LqrProblem {
  Eigen::MatrixXd A;      ///< (nx × nx)
  Eigen::MatrixXd B;      ///< (nx × nu)
  LqrWeights weights;     ///< per step where `discrete`, else continuous
  bool discrete = false;  ///< A and B are discrete
  /// The continuous problem, with the input held for so long [s], > 0; not beside `discrete`.
  std::optional<double> sampled = {};
};

/// What is known of its solution.
struct LqrReport {
  RiccatiResult riccati;              ///< where it is not solved, the margins are empty
  double dt = 0;                      ///< [s]; 0 of a continuous loop, 1 of a discrete problem
  MarginsReport margins;              ///< at the inputs u1, u2, …
  std::vector<std::string> messages;  ///< "warning: …" and "note: …" for the user
};

/// @param evidence  none: what takes about a second, with a note of what that leaves out
/// @throws InvalidInput  as lqr()
[[nodiscard]] LqrReport lqr_report(const LqrProblem& problem,
                                   std::optional<MarginsEvidence> evidence = {});

/// The same of a vehicle about a trim, whose rotors follow at once and whose states are known.
struct VehicleLqrReport {
  LinearVehicle plant;
  LqrDesign design;
  StateFeedback feedback;  ///< where it is not solved, all that follows is empty
  Gains gains;
  Eigen::VectorXcd poles;  ///< of the loop as it flies, flying_poles()
  MarginsReport margins;   ///< of the same loop
  /// With the rotors' lag, the sensors and the estimator. None unless has_flown_loop(), and of
  /// gains of some states only; none with a note for a loop that cannot be analysed, e.g. because
  /// of its sample period.
  std::optional<FlownLoop> flown;
  std::vector<std::string> messages;  ///< "warning: …" and "note: …" for the user
};

/// @param design  in the words of the plant's model
/// @throws InvalidInput  as state_feedback()
[[nodiscard]] VehicleLqrReport lqr_report(LinearVehicle plant, LqrDesign design,
                                          MarginsEvidence evidence = MarginsEvidence::full);

}  // namespace quadtune
