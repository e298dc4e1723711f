// SPDX-License-Identifier: Apache-2.0
/// The whole way from a design file to gains: what `quadtune design` computes before it prints.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cascade_report.hpp"
#include "flight_story.hpp"
#include "margins_report.hpp"
#include "quadtune/design.hpp"
#include "quadtune/exports/content.hpp"
#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/filter.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/synthesis/kalman.hpp"
#include "quadtune/synthesis/state_feedback.hpp"

namespace quadtune::cli {

struct Context;

/// How far a gain is from the published one.
struct PublishedDifference {
  double max_relative = 0;  ///< largest |difference| over its row's largest published entry
  double max_entry = 0;     ///< largest |difference| over its own published entry
  std::string worst;        ///< which entry that is, e.g. "K_int(w1, theta)"
  double published = 0;     ///< that entry, published
  double converged = 0;     ///< that entry, here
};

/// A filter with its solver's evidence.
struct DesignedFilter {
  KalmanFilter filter;
  KalmanResult evidence;
};

/// Everything that a design file leads to.
struct DesignOutcome {
  Design design;
  Linearization model;
  std::optional<StateFeedback> feedback;
  std::optional<Gains> gains;
  std::optional<DiscreteLti> sampled;    ///< the plant as the flight computer sees it; if dt > 0
  Eigen::VectorXcd poles;                ///< of the loop as it flies, integrals included
  std::optional<MarginsReport> margins;  ///< of the loop as it flies, at the plant's inputs
  std::optional<CascadeReport> cascade;
  std::vector<DesignedFilter> filters;
  std::optional<PublishedDifference> published;
  std::vector<FlownFlight> flights;  ///< of the missions that the design asks for
};

/// Trims, linearizes, solves the control laws alone: no filters.
/// @throws NoSolution  with the culprit of the trim, the LQR problem or a loop.
[[nodiscard]] DesignOutcome solve_laws(const std::string& path);

/// Likewise with the filters.
/// @throws NoSolution  with the culprit of the trim, the LQR problem or a filter.
[[nodiscard]] DesignOutcome run_design(const std::string& path);

/// Refuses covariances from a tuning whose verdict is another than pass, or with `force` notes it.
/// @throws AnswerIsNo
void require_tuned(const DesignOutcome& outcome, bool force, Context& context);

/// The gains of a solved design with all that is needed to apply them.
[[nodiscard]] Gains make_gains(const Vehicle& vehicle, const Linearization& model,
                               const LqrDesign& lqr, const StateFeedback& feedback);

/// Poles of the loop as it flies: sampled if the law is, else continuous.
[[nodiscard]] Eigen::VectorXcd flying_poles(const Linearization& model, const Gains& gains,
                                            const RiccatiResult& riccati);

/// Margins of the same loop, cut at the plant's inputs.
[[nodiscard]] MarginsReport flying_margins(const Linearization& model, const Gains& gains,
                                           const RiccatiResult& riccati,
                                           MarginsEvidence evidence = MarginsEvidence::full);

/// The continuous model of gains that came from elsewhere: the vehicle in the flight that gains.x0
/// names.
/// @throws NoSolution  if the vehicle has no such trim.
[[nodiscard]] Linearization linearization_of(const Vehicle& vehicle, const Gains& gains);

/// The same in the gains' sample time.
[[nodiscard]] VerifyModel model_of(const Vehicle& vehicle, const Gains& gains);

/// Libraries that the gains come through, beside those that the exporters name: for the manifest.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> library_versions();

/// A vehicle's file by its name, as a manifest has it; also of a built-in one.
[[nodiscard]] std::string vehicle_file_name(const Vehicle& vehicle);

/// What the exporters need.
[[nodiscard]] ExportContent export_content(const DesignOutcome& outcome);

}  // namespace quadtune::cli
