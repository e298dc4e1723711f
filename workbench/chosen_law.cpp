// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/chosen_law.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "quadtune/errors.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/given_gains.hpp"
#include "quadtune/workbench/standard_lqr.hpp"

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

ChosenLaw designed_cascade(const FlightOptions& options, const Vehicle& vehicle) {
  ChosenLaw law;
  const CascadeReport report = design_cascade(vehicle, usual_specification(vehicle), vehicle.name);
  law.margins = report.margins;
  law.position_bandwidth = position_bandwidth(report);
  CascadeController controller{report.cascade.gains};
  controller.back_calculation = kDesignedBackCalculation;
  law.controller = controller;
  law.words = fmt::format("cascaded PID, designed as by `quadtune pid {}`",
                          options.vehicle.empty() ? vehicle.name : options.vehicle);
  return law;
}

/// What is known by a word alone: gains designed or published.
ChosenLaw law_of_word(const FlightOptions& options, const Vehicle& vehicle, bool cascade,
                      const std::string& who) {
  const bool designed = options.gains == "designed";
  if (cascade) return designed ? designed_cascade(options, vehicle) : published_cascade(vehicle);
  if (designed)
    return {feedback_controller(standard_gains(vehicle, who), kUsualPeriod),
            "state feedback, LQR with weights by Bryson's rule",
            {}};
  throw OptionError("gains",
                    "gains published is for cascaded-pid, expected designed or a file of "
                    "gains");
}

/// Whether the cascade of a file flies: what is asked for, or what there is. Of both the cascade of
/// a design, as in its missions, and the state feedback of an export.
bool flies_cascade(const GivenLaws& given, const FlightOptions& options) {
  const StoredLaws& laws = given.laws;
  if (options.controller.empty()) return laws.cascade && (!laws.gains || given.design.has_value());
  const bool cascade = options.controller == kCascadedPid;
  if (cascade ? !laws.cascade : !laws.gains)
    throw InvalidInput(options.gains,
                       cascade ? "holds a state feedback and no PID cascade, expected one"
                               : "holds a PID cascade and no state feedback, expected one");
  return cascade;
}

ChosenLaw law_of_file(const FlightOptions& options, const Vehicle& vehicle) {
  const GivenLaws given = read_given_laws(options.gains);
  require_vehicle(given.laws, vehicle, options.gains);
  if (!flies_cascade(given, options))
    return {feedback_controller(*given.laws.gains, kUsualPeriod),
            "state feedback of " + options.gains,
            given.design ? given.design->margins : std::nullopt};
  const CascadeDesign& cascade = *given.laws.cascade;
  ChosenLaw law{cascade_controller(cascade, cascade.gains), "cascaded PID of " + options.gains};
  if (cascade.specification) {
    law.margins = given.design->cascade->margins;
    law.position_bandwidth = position_bandwidth(*given.design->cascade);
  }
  return law;
}

}  // namespace

std::string controller_kind(const std::string& word) {
  if (word.empty() || word == kCascadedPid || word == kStateFeedback) return word;
  if (word == "pid") return kCascadedPid;
  if (word == "lqr") return kStateFeedback;
  throw OptionError("controller",
                    fmt::format("controller is '{}', expected {} (or pid) or {} (or lqr){}",
                                internal::printable(word), kCascadedPid, kStateFeedback,
                                internal::did_you_mean(word, {kCascadedPid, kStateFeedback})));
}

ChosenLaw choose_law(FlightOptions options, const Vehicle& vehicle, const std::string& who) {
  options.controller = controller_kind(options.controller);
  if (options.gains.empty()) options.gains = "designed";
  if (options.gains == "designed" || options.gains == "published")
    return law_of_word(options, vehicle, options.controller != kStateFeedback, who);
  return law_of_file(options, vehicle);
}

CascadeSpecification usual_specification(const Vehicle& vehicle) {
  CascadeSpecification specification;
  specification.dt = vehicle.published_cascade ? vehicle.published_cascade->gains.dt : kUsualPeriod;
  return specification;
}

CascadeController cascade_controller(const CascadeDesign& design, const CascadeGains& gains) {
  CascadeController controller{gains};
  controller.method = design.method;
  controller.attitude_limit = design.attitude_limit;
  controller.integrator_limit = design.integrator_limit;
  controller.back_calculation = design.back_calculation;
  return controller;
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

StateFeedbackController feedback_controller(const Gains& gains, double dt) {
  StateFeedbackController controller{gains, gains.dt > 0 ? gains.dt : dt, {}};
  if (gains.convention == "uquad") controller.guards = uquad_integral_guards();
  return controller;
}

}  // namespace quadtune
