// SPDX-License-Identifier: Apache-2.0
/// The control law of a flight: designed, published, or from a file.
#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "quadtune/design.hpp"
#include "quadtune/exports/stored_estimator.hpp"
#include "quadtune/gain_schedule.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/designed_controller.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/workbench/design/cascade_report.hpp"
#include "quadtune/workbench/design/margins_report.hpp"
#include "quadtune/workbench/flight/flight_options.hpp"

namespace quadtune {

/// Names of the kinds of law, as returned by controller_kind().
inline constexpr char kCascadedPid[] = "cascaded-pid";
inline constexpr char kStateFeedback[] = "state-feedback";  ///< name of a state feedback
inline constexpr char kFirmware[] = "firmware";  ///< the loops of an autopilot with its parameters

/// Control period of laws that do not define one [s]: that of the Mambo's program.
inline constexpr double kUsualPeriod = 0.005;

/// Back-calculation gain of designed cascades [1/s]: near Ki/Kp of their loops. The model project's
/// 0.001 is too small to unwind an integral.
inline constexpr double kDesignedBackCalculation = 2;

/// The back-calculation gain of a designed cascade with a control period dt [s], at most 1/dt.
[[nodiscard]] inline double designed_back_calculation(double dt) {
  return std::min(kDesignedBackCalculation, 1 / dt);
}

/// Limit of the pitch and roll references of designed cascades [rad].
inline constexpr double kDesignedAttitudeLimit = 0.5;

/// A control law and what is known about it.
struct ChosenLaw {
  Controller controller;  ///< for FlightSetup::controller
  std::string words;      ///< description, e.g. "cascaded PID, designed as by `quadtune pid mambo`"
  std::optional<MarginsReport> margins = {};  ///< of its loops, if its design computed them
  double position_bandwidth = 0;              ///< of the slower loop of x and y [rad/s]; 0: unknown
  std::optional<StoredEstimator> estimator = {};  ///< that its file names
  bool on_board = false;  ///< whether the law is that of an autopilot: fly_on_board() sets up its
                          ///< flights
};

/// Returns "cascaded-pid", "state-feedback" or "firmware", also for "pid" and "lqr"; "" for "".
/// @param word      name of a law, or empty
/// @param firmware  whether the loops of an autopilot are a valid choice
/// @throws OptionError  for other words
[[nodiscard]] std::string controller_kind(const std::string& word, bool firmware = true);

/// The law that `gains`, `controller` and `integrator` of the options select.
/// @param options  of the flight
/// @param vehicle  that the law is for
/// @param who      name of the caller, e.g. "fly", for the message of NoSolution
/// @throws OptionError, InvalidInput, FileError, NoSolution
[[nodiscard]] ChosenLaw choose_law(FlightOptions options, const Vehicle& vehicle,
                                   const std::string& who);

/// Whether the cascade is designed on the flown plant by default. Position fixes below 5 Hz
/// dominate the cost of that design, so that its loops are slower than those of the loop-by-loop
/// rules.
[[nodiscard]] bool usually_on_flown_plant(const Vehicle& vehicle);

/// The default specification of a cascade: a design within the bounds of the published gains or
/// the usual bounds, at the published period or kUsualPeriod.
[[nodiscard]] CascadeSpecification usual_specification(const Vehicle& vehicle);

/// Bandwidth of the slower loop of x and y [rad/s]; 0 if there is none.
[[nodiscard]] double position_bandwidth(const CascadeReport& report);

/// A gain schedule as a flying law: ScheduledFeedback, with the bounds that keep_near_hover() gives
/// for its gains at hover.
/// @param vehicle   valid, the one that the schedule was computed for
/// @param schedule  with a gain at hover
/// @param dt        control period [s]; ignored if the schedule has one
/// @throws InvalidInput  as hover_gains() and keep_near_hover()
[[nodiscard]] StateFeedbackController scheduled_controller(const Vehicle& vehicle,
                                                           GainSchedule schedule, double dt);

}  // namespace quadtune
