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
#include "quadtune/workbench/design/cascade_report.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/design/lqi_report.hpp"
#include "quadtune/workbench/design/margins_report.hpp"
#include "quadtune/workbench/design/matrix_report.hpp"
#include "quadtune/workbench/flight/fly.hpp"
#include "quadtune/workbench/flown/flown_check.hpp"

namespace quadtune {

/// Flights of each mission of a design, all of which must pass.
inline constexpr std::uint32_t kDesignSeeds = 5;

/// The disturbed flights of a design: a gust of this speed [m/s] and length [s], and a load of this
/// share of the mass that is picked up, both in the middle of the mission. Their limits on
/// position, height and heading are those of the mission times kDisturbedSlack; settling, overshoot
/// and the rms are not judged.
inline constexpr double kGustSpeed = 3;
inline constexpr double kGustLength = 2;
inline constexpr double kLoadShare = 0.1;
inline constexpr double kDisturbedSlack = 3;

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
  std::optional<StateFeedback> feedback;  ///< of Design::lqr
  std::optional<LqiReport> lqi;           ///< of Design::lqi
  std::optional<MatrixReport> matrix;     ///< in its place, of a Design::lqi that is a matrix
  std::optional<Gains> gains;
  std::optional<DiscreteLti> sampled;    ///< the plant as the flight computer sees it; if dt > 0
  Eigen::VectorXcd poles;                ///< of the loop as it flies, integrals included
  std::optional<MarginsReport> margins;  ///< of the loop as it flies, at the plant's inputs
  std::optional<CascadeReport> cascade;
  std::vector<DesignedFilter> filters;
  std::optional<PublishedDifference> published;
  /// The loops of its laws with rotor lag, sensors and estimator. Of a state feedback for the ideal
  /// plant with margins.
  std::vector<FlownLaw> flown;
  /// Of the missions that the design asks for, worst_of() its seeds each.
  std::vector<FlownFlight> flights;
  /// The same missions with a gust and with a load, see fly_disturbed().
  std::vector<FlownFlight> disturbed = {};
};

/// What is asked of a design that is in no file. As it stands: the usual cascade, which has to
/// fly the built-in mission "hover" with the vehicle's own sensors.
struct DesignRequirements {
  std::string name;                      ///< of the design; empty: the vehicle's
  FlightCondition condition;             ///< steady flight that the state feedback holds
  std::optional<LqrDesign> lqr;          ///< e.g. usual_lqr()
  std::optional<LqiDesign> lqi;          ///< for the plant that flies; not beside lqr
  std::optional<CascadeDesign> cascade;  ///< none, and no state feedback: usual_cascade()
  std::vector<KalmanDesign> kalman;
  /// That the gains must fly. Without a `controller`, by the cascade where there is one.
  std::vector<MissionRequest> missions = {MissionRequest{.mission = "hover"}};
  std::uint64_t seed = 1;              ///< of everything random in the first flight of each mission
  std::uint32_t seeds = kDesignSeeds;  ///< flights of each mission, ≥ 1
  bool keep_logs = false;              ///< FlightResult::log of each flight
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

/// Likewise with the filters and the flown loops.
/// @throws NoSolution  with the culprit of the trim, the LQR problem or a filter.
[[nodiscard]] DesignOutcome run_design(Design design);

/// The same for a design file, or for the usual_design() of a vehicle.
/// @param file  a design file, a vehicle file or the name of a built-in vehicle
/// @throws InvalidInput, FileError, NoSolution
[[nodiscard]] DesignOutcome run_design(const std::filesystem::path& file);

/// Covariances of the design from a tuning whose verdict is another than pass, a sentence each:
/// gains from them are not to be believed as they are.
[[nodiscard]] std::vector<std::string> doubtful_covariances(const Design& design);

/// The estimator of the program that the design is exported to, or that its covariances are meant
/// for, as FlightOptions::estimator; empty: what the vehicle's sensors can feed.
[[nodiscard]] std::string program_estimator(const Design& design);

/// Flies every mission that the design asks for with the gains of the outcome.
/// @param seed       of the first flight of each mission
/// @param keep_logs  for reports
/// @param stop       as design()
/// @param seeds      flights of each mission, with seeds in a row, ≥ 1
/// @return           worst_of() the flights of each mission
/// @throws InvalidInput  "file:line: …" for a mission that cannot be flown; of a design in no file
///                       OptionError for a word
/// @throws FileError     for a mission file that cannot be read
[[nodiscard]] std::vector<FlownFlight> fly_missions(const DesignOutcome& outcome,
                                                    std::uint64_t seed, bool keep_logs,
                                                    const std::function<bool()>& stop = {},
                                                    std::uint32_t seeds = kDesignSeeds);

/// Flies every mission of the outcome with a gust, then with a load that it picks up, of which
/// neither law nor estimator is told. No motor test and nothing that is carried.
/// @throws  as fly_missions()
[[nodiscard]] std::vector<FlownFlight> fly_disturbed(const DesignOutcome& outcome,
                                                     std::uint64_t seed,
                                                     const std::function<bool()>& stop = {});

/// Whether the flown loop of every law is stable.
[[nodiscard]] bool laws_hold(const DesignOutcome& outcome);

/// Whether every mission passed, disturbed ones included.
[[nodiscard]] bool missions_passed(const DesignOutcome& outcome);

}  // namespace quadtune
