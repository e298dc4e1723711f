// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/chosen_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "quadtune/control/scheduled_feedback.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/firmware.hpp"
#include "quadtune/exports/flight_code.hpp"
#include "quadtune/exports/schedule_table.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/design/given_gains.hpp"
#include "quadtune/workbench/design/near_hover.hpp"
#include "quadtune/workbench/design/standard_lqr.hpp"
#include "quadtune/workbench/firmware/firmware_law.hpp"
#include "quadtune/workbench/flown/flown_gains.hpp"
#include "quadtune/workbench/flown/flown_lqi.hpp"

namespace quadtune {
namespace {

ChosenLaw published_cascade(const Vehicle& vehicle) {
  if (!vehicle.published_cascade)
    throw OptionError("gains", fmt::format("gains published: {} has no published cascade, expected "
                                           "designed or a file",
                                           vehicle.name));
  return {CascadeController{vehicle.published_cascade->gains},
          "cascaded PID, published: " + vehicle.published_cascade->source};
}

/// The cascade of the loop-by-loop rules.
ChosenLaw cascade_by_loops(const Vehicle& vehicle, const std::string& words) {
  ChosenLaw law;
  const CascadeReport report =
      design_cascade(vehicle, usual_specification(vehicle), place_of(vehicle));
  law.margins = report.margins;
  law.position_bandwidth = position_bandwidth(report);
  CascadeController controller{report.cascade.gains};
  controller.back_calculation = designed_back_calculation(report.cascade.gains.dt);
  controller.velocity_feed_forward = true;
  controller.conditional_integration = true;
  law.controller = controller;
  law.words = words;
  return law;
}

/// Margins at the components of the wrench, for the first member of the family, a hover at 1.1 m.
MarginsReport margins_of(const FlownGains& gains, double dt) {
  MarginsReport report;
  report.dt = dt;
  for (Eigen::Index input = 0; input < 4; ++input)
    for (const FlownAxisGains& axis : gains.axes)
      if (wrench_of(axis.axis) == input) {
        report.names.push_back(ned_convention().wrench[static_cast<std::size_t>(input)].name);
        report.loops.push_back(axis.margins.front());
      }
  return report;
}

ChosenLaw designed_cascade(const FlightOptions& flight, const Vehicle& vehicle) {
  const std::string named = flight.vehicle.empty() ? vehicle.name : flight.vehicle;
  const std::string words = fmt::format("cascaded PID, designed as by `quadtune pid {}`", named);
  (void)cascade_vehicle(vehicle, place_of(vehicle));  // throws if it cannot hover
  if (!usually_on_flown_plant(vehicle)) return cascade_by_loops(vehicle, words);
  FlownGainsOptions options;
  options.dt = usual_specification(vehicle).dt;
  try {
    const FlownGains gains = flown_gains(vehicle, options);
    ChosenLaw law;
    CascadeController controller{as_cascade(gains, options.dt)};
    controller.back_calculation = designed_back_calculation(options.dt);
    controller.attitude_limit = kDesignedAttitudeLimit;
    controller.velocity_feed_forward = true;
    controller.conditional_integration = true;
    law.controller = controller;
    law.margins = margins_of(gains, options.dt);
    law.words = words;
    return law;
  } catch (const NoSolution&) {
    return cascade_by_loops(
        vehicle, "cascaded PID, designed loop by loop because no gains stabilize the flown plant");
  }
}

ChosenLaw designed_feedback(const Vehicle& vehicle, const std::string& who) {
  try {
    FlownLqi design = flown_lqi(vehicle);
    keep_near_hover(vehicle, design.lqi.gains);
    return {feedback_controller(design.lqi.gains, kUsualPeriod),
            "state feedback, LQI with weights by Bryson's rule and the lag of the rotors",
            {}};
  } catch (const NoSolution&) {
    Gains gains = standard_gains(vehicle, who);
    keep_near_hover(vehicle, gains);
    return {feedback_controller(gains, kUsualPeriod),
            "state feedback, LQR with weights by Bryson's rule; the LQI has no solution",
            {}};
  }
}

/// The law that a word selects: designed or published gains.
ChosenLaw law_of_word(const FlightOptions& options, const Vehicle& vehicle, bool cascade,
                      const std::string& who) {
  if (options.controller == kFirmware)
    throw OptionError(
        "controller",
        "controller firmware requires gains; expected a file of `quadtune import -o` or an "
        "export of parameters");
  const bool designed = options.gains == "designed";
  if (cascade) return designed ? designed_cascade(options, vehicle) : published_cascade(vehicle);
  if (designed) return designed_feedback(vehicle, who);
  throw OptionError("gains",
                    "gains published is for cascaded-pid, expected designed or a file of "
                    "gains");
}

/// Whether the cascade of a file flies: the requested law, or the only one. If there are both, it
/// is the cascade for a design, as in its missions, and the state feedback for an export.
bool flies_cascade(const GivenLaws& given, const FlightOptions& options) {
  const StoredLaws& laws = given.laws;
  if (options.controller.empty()) return laws.cascade && (!laws.gains || given.design.has_value());
  const bool cascade = options.controller == kCascadedPid;
  if (cascade ? !laws.cascade : !laws.gains)
    throw InvalidInput(options.gains, cascade ? "has a state feedback, but no PID cascade"
                                              : "has a PID cascade, but no state feedback");
  return cascade;
}

/// Whether the loops of an autopilot fly: if the file has its parameters, unless another law is
/// requested.
bool flies_firmware(const StoredLaws& laws, const FlightOptions& options) {
  if (options.controller == kFirmware && !laws.parameters)
    throw InvalidInput(
        options.gains,
        "has no parameters of an autopilot; expected a file of `quadtune import -o` or "
        "of an export of parameters");
  return laws.parameters && (options.controller.empty() || options.controller == kFirmware);
}

ChosenLaw law_of_parameters(const StoredLaws& laws, const Vehicle& vehicle,
                            const std::string& path) {
  const Firmware& firmware = laws.parameters->firmware;
  ChosenLaw law;
  law.controller = firmware_controller(vehicle, *laws.parameters,
                                       laws.cascade ? laws.cascade->gains : CascadeGains());
  law.words = fmt::format("loops of {} {} with the parameters of {}", to_string(firmware.kind),
                          firmware.version, path);
  law.estimator = laws.estimator;
  law.on_board = true;
  return law;
}

ChosenLaw law_of_schedule(const FlightOptions& options, const Vehicle& vehicle) {
  if (options.controller == kCascadedPid)
    throw InvalidInput(options.gains, "is a gain schedule of a state feedback, not a PID cascade");
  GainSchedule schedule = read_schedule(options.gains);
  require_vehicle({schedule.vehicle, {}, {}}, vehicle, options.gains);
  const Eigen::Index points = schedule.size();
  try {
    return {
        scheduled_controller(vehicle, std::move(schedule), kUsualPeriod),
        fmt::format("gain schedule of {}, {}", options.gains, internal::counted(points, "point")),
        {}};
  } catch (const InvalidInput& error) {
    throw InvalidInput(options.gains, error.what());
  }
}

ChosenLaw law_of_file(const FlightOptions& options, const Vehicle& vehicle) {
  if (is_schedule(options.gains)) return law_of_schedule(options, vehicle);
  if (holds_schedule(options.gains)) {
    FlightOptions of_table = options;
    of_table.gains = (std::filesystem::path(options.gains) / kScheduleJsonName).string();
    return law_of_schedule(of_table, vehicle);
  }
  const GivenLaws given = read_given_laws(options.gains);
  require_vehicle(given.laws, vehicle, options.gains);
  if (flies_firmware(given.laws, options))
    return law_of_parameters(given.laws, vehicle, options.gains);
  if (!flies_cascade(given, options)) {
    const bool matrix = given.design && given.design->matrix;
    return {feedback_controller(*given.laws.gains, kUsualPeriod),
            "state feedback of " + options.gains,
            given.design ? given.design->margins : std::nullopt, 0,
            matrix ? given.design->matrix->estimator : given.laws.estimator};
  }
  const CascadeDesign& cascade = *given.laws.cascade;
  ChosenLaw law{cascade_controller(cascade, cascade.gains), "cascaded PID of " + options.gains};
  law.estimator = given.laws.estimator;
  if (cascade.specification) {
    law.margins = given.design->cascade->margins;
    law.position_bandwidth = position_bandwidth(*given.design->cascade);
  }
  return law;
}

}  // namespace

std::string controller_kind(const std::string& word, bool firmware) {
  if (word.empty() || word == kCascadedPid || word == kStateFeedback ||
      (firmware && word == kFirmware))
    return word;
  if (word == "pid") return kCascadedPid;
  if (word == "lqr") return kStateFeedback;
  throw OptionError("controller",
                    fmt::format("controller is '{}', expected {} (or pid){} {} (or lqr){}{}",
                                internal::printable(word), kCascadedPid, firmware ? "," : " or",
                                kStateFeedback, firmware ? fmt::format(" or {}", kFirmware) : "",
                                internal::did_you_mean(word, {kCascadedPid, kStateFeedback})));
}

ChosenLaw choose_law(FlightOptions options, const Vehicle& vehicle, const std::string& who) {
  options.controller = controller_kind(options.controller);
  if (options.gains.empty()) options.gains = "designed";
  if (options.gains == "designed" || options.gains == "published")
    return law_of_word(options, vehicle, options.controller != kStateFeedback, who);
  return law_of_file(options, vehicle);
}

bool usually_on_flown_plant(const Vehicle& vehicle) {
  constexpr double kSlowFixes = 5;  // [Hz]
  const Sensors& sensors = vehicle.sensors;
  return sensors.flow || !sensors.gps || sensors.gps->position.rate >= kSlowFixes;
}

CascadeSpecification usual_specification(const Vehicle& vehicle) {
  CascadeSpecification specification;
  specification.dt = vehicle.published_cascade ? vehicle.published_cascade->gains.dt : kUsualPeriod;
  return specification;
}

double position_bandwidth(const CascadeReport& report) {
  double slower = 0;
  for (const CascadeAxisDesign& loop : report.cascade.loops) {
    if (loop.axis != CascadeAxis::x && loop.axis != CascadeAxis::y) continue;
    const double bandwidth = loop.design.evidence.bandwidth;
    slower = slower > 0 ? std::min(slower, bandwidth) : bandwidth;
  }
  return slower;
}

StateFeedbackController scheduled_controller(const Vehicle& vehicle, GainSchedule schedule,
                                             double dt) {
  Gains gains = hover_gains(schedule);
  keep_near_hover(vehicle, gains);
  StateFeedbackController controller = feedback_controller(gains, dt);
  controller.schedule = std::make_shared<const GainSchedule>(std::move(schedule));
  return controller;
}

}  // namespace quadtune
