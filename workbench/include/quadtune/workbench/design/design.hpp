// SPDX-License-Identifier: Apache-2.0
/// The complete design: from a vehicle and requirements to gains with their evidence and flights.
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

/// Number of flights of each mission of a design; all of them must pass.
inline constexpr std::uint32_t kDesignSeeds = 5;

/// The two disturbed flights of a design: one with a gust of this speed [m/s] and duration [s], one
/// in which the vehicle picks up a load, each in the middle of the mission. Their limits
/// on position, height and heading are those of the mission times kDisturbedSlack; settling,
/// overshoot and rms values have no limits.
inline constexpr double kGustSpeed = 3;
inline constexpr double kGustLength = 2;      ///< duration of the gust [s]
inline constexpr double kLoadShare = 0.1;     ///< mass of the load as a share of the vehicle's
inline constexpr double kDisturbedSlack = 3;  ///< factor on the limits of a disturbed flight

/// Difference between the computed and the published gains.
struct PublishedDifference {
  double max_relative = 0;  ///< largest |difference| relative to the largest published entry of its
                            ///< row
  double max_entry = 0;     ///< largest |difference| relative to its own published entry
  std::string worst;        ///< name of that entry, e.g. "K_int(w1, theta)"
  double published = 0;     ///< published value of that entry
  double converged = 0;     ///< computed value of that entry
};

/// A filter with the evidence of its solver.
struct DesignedFilter {
  KalmanFilter filter;    ///< steady-state gains
  KalmanResult evidence;  ///< of the solver
};

/// All results of a design.
struct DesignOutcome {
  Design design;                          ///< the problem
  Linearization model;                    ///< linear model at the trim
  std::optional<StateFeedback> feedback;  ///< of Design::lqr
  std::optional<LqiReport> lqi;           ///< of Design::lqi
  std::optional<MatrixReport> matrix;     ///< instead of `lqi` if Design::lqi is a matrix
  std::optional<Gains> gains;             ///< the state feedback that flies; empty if there is none
  std::optional<DiscreteLti> sampled;    ///< the plant as the flight computer sees it; only if dt >
                                         ///< 0
  Eigen::VectorXcd poles;                ///< of the plant of the law's design, integrals included
  std::optional<MarginsReport> margins;  ///< of the flown loop for `lqi` and `matrix`, otherwise of
                                         ///< the ideal plant; cut at the plant's inputs
  std::optional<CascadeReport> cascade;  ///< of the PID cascade; empty if there is none
  bool cascade_for_flown_plant = false;  ///< whether the cascade was designed for the flown plant
  std::vector<DesignedFilter> filters;   ///< one for each of Design::kalman
  /// From the published gains; empty if none are published.
  std::optional<PublishedDifference> published;
  /// The loops of the laws with motor lag, sensors and estimator. For a state feedback designed on
  /// the ideal plant, with margins.
  std::vector<FlownLaw> flown;
  /// For each mission of the design the result of worst_of() for the flights with its seeds.
  std::vector<FlownFlight> flights;
  /// The same missions with a gust and with a load; see fly_disturbed().
  std::vector<FlownFlight> disturbed = {};
};

/// Requirements of a design without a file. The defaults give the usual cascade, which must fly the
/// built-in mission "hover" with the vehicle's own sensors.
struct DesignRequirements {
  std::string name;                      ///< of the design; empty: the vehicle's
  FlightCondition condition;             ///< trim of the state feedback
  std::optional<LqrDesign> lqr;          ///< e.g. usual_lqr()
  std::optional<LqiDesign> lqi;          ///< for the flown plant; excludes `lqr`
  std::optional<CascadeDesign> cascade;  ///< if absent and there is no state feedback:
                                         ///< usual_cascade()
  std::vector<KalmanDesign> kalman;      ///< Kalman filters
  /// Missions that the gains must fly; without a `controller`, with the cascade if there is one.
  std::vector<MissionRequest> missions = {MissionRequest{.mission = "hover"}};
  std::uint64_t seed = 1;              ///< for the first flight of each mission
  std::uint32_t seeds = kDesignSeeds;  ///< flights of each mission, ≥ 1
  bool keep_logs = false;              ///< FlightResult::log of each flight
};

/// An LQR from all twelve states of ned_convention() to the wrench, with weights by Bryson's rule
/// from the capabilities of the vehicle (standard_weights()) and the continuous cost of held
/// inputs.
/// @param vehicle  valid
/// @param dt       sample period of the law [s], > 0
/// @throws NoSolution  if the vehicle cannot hover
[[nodiscard]] LqrDesign usual_lqr(const Vehicle& vehicle, double dt = kUsualPeriod);

/// The cascade that `quadtune fly V` designs by default, with its limits.
[[nodiscard]] CascadeDesign usual_cascade(const Vehicle& vehicle);

/// Computes gains, margins and poles, and flies the missions with them, as `quadtune design` does,
/// but for a vehicle in memory and without files.
///
///     const DesignOutcome hover = design(load_vehicle("crazyflie"));
///     for (const auto* flights : {&hover.flights, &hover.disturbed})
///       for (const FlownFlight& flight : *flights)
///         for (const std::string& why : reasons(flight)) std::cerr << why << '\n';
///
/// @param vehicle  valid
/// @param requirements  the laws, and the missions that they must fly
/// @param stop  called regularly while missions are flown; if it returns true, Interrupted is
///              thrown
/// @throws OptionError   if a word of a mission is unknown; names the option
/// @throws InvalidInput  if the requirements or a mission are invalid
/// @throws NoSolution    with the culprit of the trim, the LQR problem, a loop or a filter
/// @throws FileError     if a mission file cannot be read
[[nodiscard]] DesignOutcome design(const Vehicle& vehicle,
                                   const DesignRequirements& requirements = {},
                                   const std::function<bool()>& stop = {});

/// Trims, linearizes and solves for the control laws only: no filters, no flights.
/// @throws NoSolution  with the culprit of the trim, the LQR problem or a loop
[[nodiscard]] DesignOutcome solve_laws(Design design);

/// The same with the filters and the flown loops.
/// @throws NoSolution  with the culprit of the trim, the LQR problem or a filter
[[nodiscard]] DesignOutcome run_design(Design design);

/// The same for a design file, or for the usual_design() of a vehicle.
/// @param file  a design file, a vehicle file or the name of a built-in vehicle
/// @param to    as usual_design(); only for a vehicle
/// @throws InvalidInput, FileError, NoSolution
/// @throws OptionError  "to" if a format is unknown or `file` is a design file
[[nodiscard]] DesignOutcome run_design(const std::filesystem::path& file,
                                       const std::vector<std::string>& to = {});

/// Covariances of the design that come from a tuning whose verdict is not pass, one sentence each:
/// gains that depend on them should not be trusted without further checks.
[[nodiscard]] std::vector<std::string> unconfirmed_covariances(const Design& design);

/// The estimator of the program to which the design is exported, or for which its covariances are
/// meant, as in FlightOptions::estimator; empty: the one that the vehicle's sensors support.
[[nodiscard]] std::string program_estimator(const Design& design);

/// Flies every mission of the design with the gains of the outcome.
/// @param outcome    solved; its design lists the missions
/// @param seed       of the first flight of each mission
/// @param keep_logs  whether logs are kept, for reports
/// @param stop       as design()
/// @param seeds      number of flights of each mission, with consecutive seeds, ≥ 1
/// @return           worst_of() the flights of each mission
/// @throws InvalidInput  "file:line: …" if a mission cannot be flown; for a design without a file,
///                       an unknown word throws OptionError instead
/// @throws FileError     if a mission file cannot be read
[[nodiscard]] std::vector<FlownFlight> fly_missions(const DesignOutcome& outcome,
                                                    std::uint64_t seed, bool keep_logs,
                                                    const std::function<bool()>& stop = {},
                                                    std::uint32_t seeds = kDesignSeeds);

/// Flies every mission of the outcome with a gust, then with a load that the vehicle picks up.
/// Neither law nor estimator knows about them. Motor tests and carried vehicles are skipped.
/// @throws  as fly_missions()
[[nodiscard]] std::vector<FlownFlight> fly_disturbed(const DesignOutcome& outcome,
                                                     std::uint64_t seed,
                                                     const std::function<bool()>& stop = {});

/// Whether the flown loop of every law was analysed and has no growing mode.
[[nodiscard]] bool laws_hold(const DesignOutcome& outcome);

/// Whether every mission passed, including the disturbed flights.
[[nodiscard]] bool missions_passed(const DesignOutcome& outcome);

}  // namespace quadtune
