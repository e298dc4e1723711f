// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/lqr_report.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/workbench/design/lqi_report.hpp"
#include "quadtune/workbench/flown/flown_check.hpp"
#include "quadtune/workbench/flown/flying_loop.hpp"

namespace quadtune {
namespace {

using Messages = std::vector<std::string>;

void warn_of(const RiccatiResult& riccati, Messages& messages) {
  if (!riccati.warning.empty()) messages.push_back("warning: " + riccati.warning);
}

void note(const std::vector<std::string>& notes, Messages& messages) {
  for (const std::string& text : notes) messages.push_back("note: " + text);
}

/// Whether R, which is symmetric and >= 0, has an eigenvalue that is 0 up to rounding.
bool is_singular(const Eigen::MatrixXd& R) {
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(R, Eigen::EigenvaluesOnly).eigenvalues();
  return eigenvalues.minCoeff() <= 1e-15 * eigenvalues.maxCoeff();
}

/// The evidence that takes about a second, with a note about what was omitted.
MarginsEvidence affordable(Eigen::Index states, Eigen::Index channels, Messages& messages) {
  const MarginsEvidence evidence = affordable_evidence(states, channels);
  if (evidence != MarginsEvidence::full)
    messages.push_back(fmt::format(
        "note: {} omitted, because with {} states and {} inputs it would take more than about "
        "a second; --evidence full computes all",
        evidence == MarginsEvidence::none ? "the margins are"
                                          : "the disk margin of all loops at once is",
        states, channels));
  return evidence;
}

/// The flown loop of gains that were designed for the ideal plant.
std::optional<FlownLoop> flown_loop_of(const VehicleLqrReport& report, Messages& messages) {
  if (report.gains.states.size() != 12 || !has_flown_loop(report.plant.model.trim)) return {};
  try {
    return flown_loop(hover_under(report.plant.vehicle, report.gains));
  } catch (const InvalidInput& error) {
    messages.push_back(fmt::format("note: the flown loop is not analysed: {}", error.message()));
    return {};
  }
}

}  // namespace

LqrReport lqr_report(const LqrProblem& problem, std::optional<MarginsEvidence> evidence) {
  const ContinuousLti plant{problem.A, problem.B, {}, {}, {}, {}, {}};
  DiscreteLti discrete{problem.A, problem.B, {}, {}, 1, {}, {}, {}};
  LqrReport report;
  if (problem.discrete) {
    report.riccati = lqr(discrete, problem.weights);
  } else if (problem.sampled) {
    SampledLqr held = sample(plant, problem.weights, *problem.sampled);
    report.riccati = lqr(held.plant, held.weights);
    discrete = std::move(held.plant);
  } else {
    report.riccati = lqr(plant, problem.weights);
  }
  if (!report.riccati.solved()) return report;
  warn_of(report.riccati, report.messages);
  const bool is_discrete = problem.discrete || problem.sampled;
  report.dt = is_discrete ? discrete.dt : 0;
  if (problem.discrete && is_singular(problem.weights.R) && report.riccati.warning.empty())
    note({"R is singular; there is a solution because R + B'SB is not"}, report.messages);
  const Eigen::MatrixXd& K = report.riccati.K;
  if (!evidence) evidence = affordable(plant.A.rows(), plant.B.cols(), report.messages);
  report.margins =
      margins_report(is_discrete ? loop_at_inputs(discrete, K) : loop_at_inputs(plant, K),
                     numbered("u", plant.B.cols()), *evidence);
  note(margin_notes(report.margins), report.messages);
  return report;
}

VehicleLqrReport lqr_report(LinearVehicle plant, LqrDesign design, MarginsEvidence evidence) {
  VehicleLqrReport report;
  report.plant = std::move(plant);
  report.design = std::move(design);
  const Linearization& model = report.plant.model;
  report.feedback = state_feedback(model.plant, report.design);
  const RiccatiResult& riccati = report.feedback.riccati;
  if (!riccati.solved()) {
    note(model.notes, report.messages);  // a state that was omitted may be the cause
    return report;
  }
  report.gains = make_gains(report.plant.vehicle, model, report.design, report.feedback);
  warn_of(riccati, report.messages);
  note(model.notes, report.messages);
  report.poles = flying_poles(model, report.gains, riccati);
  report.margins = flying_margins(model, report.gains, riccati, evidence);
  note(margin_notes(report.margins), report.messages);
  report.flown = flown_loop_of(report, report.messages);
  if (report.flown && report.flown->grows())
    report.messages.push_back(
        "warning: with the rotors' lag, the sensors and the estimator the loop is unstable; "
        "without --plant ideal the design includes them");
  return report;
}

}  // namespace quadtune
