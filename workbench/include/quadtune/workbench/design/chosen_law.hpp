// SPDX-License-Identifier: Apache-2.0
/// The control law that flies: designed, published, or of a file.
#pragma once

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

/// The kinds of law by name, as controller_kind() gives them.
inline constexpr char kCascadedPid[] = "cascaded-pid";
inline constexpr char kStateFeedback[] = "state-feedback";
inline constexpr char kFirmware[] = "firmware";  ///< the loops of an autopilot, of its parameters

/// Control period of laws that come with none [s]: that of the Mambo's program.
inline constexpr double kUsualPeriod = 0.005;

/// Back calculation of designed cascades [1/s]: near Ki/Kp of their loops. The model project's
/// 0.001 unwinds nothing.
inline constexpr double kDesignedBackCalculation = 2;

/// Limit of the pitch and roll references of designed cascades [rad].
inline constexpr double kDesignedAttitudeLimit = 0.5;

/// What steers, and what is known of it.
struct ChosenLaw {
  Controller controller;
  std::string words;  ///< e.g. "cascaded PID, designed as by `quadtune pid mambo`"
  std::optional<MarginsReport> margins = {};  ///< of its loops, where its design computed them
  double position_bandwidth = 0;  ///< of the slower loop of x and y [rad/s]; 0: not known
  std::optional<StoredEstimator> estimator = {};  ///< that its file names
  bool on_board = false;  ///< the law is an autopilot's: fly_on_board() makes its flights
};

/// "cascaded-pid", "state-feedback" or "firmware", also for "pid" and "lqr"; "" stays.
/// @throws OptionError  for other words
[[nodiscard]] std::string controller_kind(const std::string& word);

/// The law that `gains`, `controller` and `integrator` of the options ask for.
/// @param who  asked, e.g. "fly", for the message of NoSolution
/// @throws OptionError, InvalidInput, FileError, NoSolution
[[nodiscard]] ChosenLaw choose_law(FlightOptions options, const Vehicle& vehicle,
                                   const std::string& who);

/// Whether the cascade is designed on the flown plant unless asked otherwise. Position fixes below
/// 5 Hz dominate the cost of that design, so that it becomes slower than the loop-by-loop rules.
[[nodiscard]] bool usually_on_flown_plant(const Vehicle& vehicle);

/// What is asked of a cascade where nobody says: a design within the published gains or the usual
/// bounds, at the published period or kUsualPeriod.
[[nodiscard]] CascadeSpecification usual_specification(const Vehicle& vehicle);

/// Of the slower loop of x and y [rad/s]; 0 where there is none.
[[nodiscard]] double position_bandwidth(const CascadeReport& report);

/// A gain schedule as it is flown: ScheduledFeedback, with the bounds of keep_near_hover() for its
/// gains at hover.
/// @param dt  control period [s]; that of the schedule where it has one
/// @throws InvalidInput  as hover_gains() and keep_near_hover()
[[nodiscard]] StateFeedbackController scheduled_controller(const Vehicle& vehicle,
                                                           GainSchedule schedule, double dt);

}  // namespace quadtune
