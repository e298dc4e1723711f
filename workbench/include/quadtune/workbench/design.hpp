// SPDX-License-Identifier: Apache-2.0
/// The whole way from a vehicle and what is asked of it to gains with their evidence, flown.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/design.hpp"
#include "quadtune/filter.hpp"
#include "quadtune/flight_condition.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/synthesis/kalman.hpp"
#include "quadtune/synthesis/state_feedback.hpp"
#include "quadtune/workbench/cascade_report.hpp"
#include "quadtune/workbench/chosen_law.hpp"
#include "quadtune/workbench/fly.hpp"
#include "quadtune/workbench/margins_report.hpp"

namespace quadtune {

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

/// Everything that a design leads to.
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

/// What is asked of a design that is in no file. As it stands: an LQR with standard weights that
/// flies the built-in mission "hover" with the vehicle's own sensors.
struct DesignRequirements {
  std::string name;                      ///< of the design; empty: the vehicle's
  FlightCondition condition;             ///< steady flight that the state feedback holds
  std::optional<LqrDesign> lqr;          ///< none, and no cascade: usual_lqr()
  std::optional<CascadeDesign> cascade;  ///< e.g. usual_cascade()
  std::vector<KalmanDesign> kalman;
  /// That the gains must fly. Without a `controller`, by the cascade where there is one.
  std::vector<MissionRequest> missions = {MissionRequest{.mission = "hover"}};
  std::uint64_t seed = 1;  ///< of everything random in the flights
  bool keep_logs = false;  ///< FlightResult::log of each flight
};

/// All twelve states of ned_convention() to the wrench, weights by Bryson's rule from what the
/// vehicle can give (standard_weights()), the continuous cost of held inputs.
/// @param dt  sample period of the law [s], > 0
/// @throws NoSolution  if the vehicle cannot hover
[[nodiscard]] LqrDesign usual_lqr(const Vehicle& vehicle, double dt = kUsualPeriod);

/// The cascade that `quadtune fly V` designs where nothing else is said, with its limits.
[[nodiscard]] CascadeDesign usual_cascade(const Vehicle& vehicle);

/// Gains, margins, poles, and the missions flown with them: what `quadtune design` does, for a
/// vehicle in memory and without any file.
///
///     const DesignOutcome hover = design(load_vehicle("crazyflie"));
///     if (!missions_passed(hover)) std::cerr << reasons(hover.flights[0])[0] << '\n';
///
/// @param stop  asked now and then while missions are flown; true ends them with Interrupted
/// @throws OptionError   for a word of a mission that is not known, naming the option
/// @throws InvalidInput  for a problem or a mission that makes no sense
/// @throws NoSolution    with the culprit of the trim, the LQR problem, a loop or a filter
/// @throws FileError     for a mission file that cannot be read
[[nodiscard]] DesignOutcome design(const Vehicle& vehicle,
                                   const DesignRequirements& requirements = {},
                                   const std::function<bool()>& stop = {});

/// Trims, linearizes, solves the control laws alone: no filters, no flights.
/// @throws NoSolution  with the culprit of the trim, the LQR problem or a loop.
[[nodiscard]] DesignOutcome solve_laws(Design design);

/// Likewise with the filters.
/// @throws NoSolution  with the culprit of the trim, the LQR problem or a filter.
[[nodiscard]] DesignOutcome run_design(Design design);

/// The same for a design file.
/// @throws InvalidInput, FileError, NoSolution
[[nodiscard]] DesignOutcome run_design(const std::filesystem::path& file);

/// Covariances of the design from a tuning whose verdict is another than pass, a sentence each:
/// gains from them are not to be believed as they are.
[[nodiscard]] std::vector<std::string> doubtful_covariances(const Design& design);

/// Flies every mission that the design asks for with the gains of the outcome.
/// @param keep_logs  for reports
/// @param stop       as design()
/// @throws InvalidInput  "file:line: …" for a mission that cannot be flown; of a design in no file
///                       OptionError for a word
/// @throws FileError     for a mission file that cannot be read
[[nodiscard]] std::vector<FlownFlight> fly_missions(const DesignOutcome& outcome,
                                                    std::uint64_t seed, bool keep_logs,
                                                    const std::function<bool()>& stop = {});

/// Whether every mission passed.
[[nodiscard]] bool missions_passed(const DesignOutcome& outcome);

}  // namespace quadtune
