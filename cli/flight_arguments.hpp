// SPDX-License-Identifier: Apache-2.0
/// Options that say what is flown, and the setup that they mean: for `fly`, `compare`, `design`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cascade_report.hpp"
#include "margins_report.hpp"
#include "quadtune/design.hpp"
#include "quadtune/simulation/flight.hpp"

namespace CLI {
class App;
}

namespace quadtune::cli {

struct FlightArguments {
  std::string vehicle;
  std::string mission = "hover";
  std::string controller;  ///< "cascaded-pid", "state-feedback"; empty: what the gains are
  std::string gains;       ///< a file, an export, "designed" or "published"; empty: "designed"
  std::string integrator;  ///< "euler", "backward-euler", "tustin"; empty: the gains' own
  std::string estimator;   ///< "mambo", "mambo-original", "mambo-raw", "uquad", "truth"; empty: by
                           ///< the sensors
  std::string flow;        ///< "full", "simplified", "off"; empty: "full"
  std::optional<double> flow_rate;  ///< [Hz]; none: the vehicle's
  std::string sensors;              ///< "ideal", "real"; empty: "real"
  std::string wind = "calm";
  std::optional<double> duration;  ///< [s]; none: the mission's
  std::string solver = "bogacki-shampine-3";
  std::optional<double> step;  ///< [s]; none: that of FlightSetup
  bool dynamic_environment = false;
  std::uint64_t seed = 1;
};

/// Where nothing is said: published gains of a vehicle that has them, and ideal sensors, as the
/// model project flew its experiments.
[[nodiscard]] FlightArguments as_the_model_project(FlightArguments arguments);

/// Adds V and all of these but --seed, which every verb has.
void add_flight_options(CLI::App& app, FlightArguments& arguments);

/// What steers, and what is known of it.
struct ChosenLaw {
  Controller controller;
  std::string words;  ///< e.g. "cascaded PID, designed as by `quadtune pid mambo`"
  std::optional<MarginsReport> margins = {};  ///< of its loops, where its design computed them
  double position_bandwidth = 0;  ///< of the slower loop of x and y [rad/s]; 0: not known
};

/// A setup, and in words what was chosen for it.
struct PlannedFlight {
  FlightSetup setup;
  std::string law;                       ///< ChosenLaw::words
  std::optional<MarginsReport> margins;  ///< ChosenLaw::margins
  std::string estimator;                 ///< e.g. "mambo"
  std::string sensors;                   ///< "real" or "ideal"
  std::string wind;                      ///< as it was asked for
  std::vector<std::string> notes;        ///< what the user should know of a choice
};

/// "cascaded-pid" or "state-feedback", also for "pid" and "lqr"; "" stays.
/// @throws UsageError  for other words
[[nodiscard]] std::string controller_kind(const std::string& word, const std::string& verb);

/// Refuses words that no option knows, before anything is designed or flown.
/// @throws UsageError
void require_flight_words(const FlightArguments& arguments, const std::string& verb);

/// The law that --gains, --controller and --integrator ask for.
/// @param verb  for messages
/// @throws UsageError, InvalidInput, FileError, NoSolution
[[nodiscard]] ChosenLaw choose_law(FlightArguments arguments, const Vehicle& vehicle,
                                   const std::string& verb);

/// @param verb  for messages
/// @throws UsageError, InvalidInput, FileError, NoSolution
[[nodiscard]] PlannedFlight plan_flight(const FlightArguments& arguments, const std::string& verb);

/// The same for a vehicle, a mission and a law in memory; their options are not looked at.
[[nodiscard]] PlannedFlight plan_flight(const FlightArguments& arguments, const Vehicle& vehicle,
                                        const Mission& mission, const ChosenLaw& law,
                                        const std::string& verb);

/// Has every control period of the flight kept.
/// @throws UsageError  for a flight whose record would not fit into memory
void keep_log(PlannedFlight& plan, const std::string& verb);

/// Back calculation of designed cascades [1/s]: near Ki/Kp of their loops. The model project's
/// 0.001 unwinds nothing.
inline constexpr double kDesignedBackCalculation = 2;

/// A cascade of a design file as it is flown.
/// @param gains  designed where the file asks for them
[[nodiscard]] CascadeController cascade_controller(const CascadeDesign& design,
                                                   const CascadeGains& gains);

/// Of the slower loop of x and y [rad/s]; 0 where there is none.
[[nodiscard]] double position_bandwidth(const CascadeReport& report);

/// A state feedback as it is flown: with the guards of the uquad's program in its convention.
/// @param dt  control period [s]; that of the gains where they have one
[[nodiscard]] StateFeedbackController feedback_controller(const Gains& gains, double dt);

}  // namespace quadtune::cli
