// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/vehicle_cascade.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "firmware/turn_parts.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/firmware/firmware_gains.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"
#include "quadtune/workbench/flown/flown_check.hpp"
#include "quadtune/workbench/flown/plant_word.hpp"

namespace quadtune {
namespace {

/// The first set option that only the loop-by-loop rules accept; empty if none is set.
std::string option_of_loops(const CascadeOptions& options) {
  const std::pair<const char*, bool> all[] = {{"Ms-max", options.Ms_max.has_value()},
                                              {"bandwidth", options.bandwidth.has_value()},
                                              {"sensor-delay", options.sensor_delay.has_value()},
                                              {"motor-lag", options.motor_lag.has_value()},
                                              {"tracking-max", options.tracking_max.has_value()},
                                              {"integral", options.integral.has_value()},
                                              {"integrator", options.integrator.has_value()},
                                              {"free", options.use_published.has_value()}};
  for (const auto& [key, set] : all)
    if (set) return key;
  return "";
}

/// Whether the textbook plant is requested, for which the loops are designed one by one.
bool asks_for_ideal_plant(const CascadeOptions& options) {
  if (options.plant.empty() || asks_for_flown_plant(options.plant)) return false;
  if (options.method == "flown")
    throw OptionError("method",
                      "method flown does not support --plant ideal; expected --method loops, which "
                      "ignores sensors and estimator");
  if (options.motor_lag)
    throw OptionError("motor-lag",
                      "motor-lag does not apply to --plant ideal, because rotors of the "
                      "textbook plant have no lag");
  return true;
}

/// Whether all gains are designed at once on the flown plant, instead of loop by loop.
bool designs_on_flown_plant(const CascadeOptions& options, const Vehicle& vehicle) {
  const std::string& method = options.method;
  if (!method.empty() && method != "loops" && method != "flown")
    throw OptionError("method", fmt::format("method is '{}', expected flown or loops{}",
                                            internal::printable(method),
                                            internal::did_you_mean(method, {"flown", "loops"})));
  if (asks_for_ideal_plant(options) || method == "loops") return false;
  const std::string of_loops = option_of_loops(options);
  if (method.empty()) return usually_on_flown_plant(vehicle) && of_loops.empty();
  if (!of_loops.empty()) throw OptionError(of_loops, of_loops + " requires --method loops");
  return true;
}

/// The firmware for which the cascade is designed, if any.
std::vector<Firmware> firmware_of(const CascadeOptions& options) {
  const FirmwareOptions& details = options.firmware;
  if (!options.for_firmware) {
    for (const auto& [key, value] :
         {std::pair{"firmware", details.version}, std::pair{"setup", details.setup}})
      if (!value.empty())
        throw OptionError(
            key, fmt::format("{} is given without a firmware, expected --for as well", key));
    return {};
  }
  const FirmwareKind kind = [&] {
    try {
      return firmware_kind(*options.for_firmware, "for");
    } catch (const InvalidInput& error) {
      throw OptionError("for", error.what());
    }
  }();
  if (options.structure.value_or("p-pi") == "pid" && structure_of(kind) == CascadeStructure::p_pi)
    throw OptionError("structure",
                      fmt::format("structure is 'pid', expected p-pi, because {} flies a gain "
                                  "before a PI controller of the rate",
                                  to_string(kind)));
  return {firmware_of_options(kind, details)};
}

FlownGains cascade_on_flown_plant(const Vehicle& vehicle, const CascadeSpecification& specification,
                                  const std::vector<Firmware>& firmwares,
                                  const CascadeOptions& asked) {
  FlownGainsOptions options;
  options.dt = specification.dt;
  options.structure = specification.structure;
  options.rate_lead = asked.rate_lead;
  try {
    return firmware_gains(vehicle, firmwares, options);
  } catch (const OptionError&) {
    throw;
  } catch (const InvalidInput& error) {
    // The period may be too short for the estimator.
    if (!asked.dt || error.where() != "estimator general") throw;
    throw OptionError("dt", fmt::format("dt: {}", error.what()));
  }
}

ExportContent content_of(const Vehicle& vehicle, const CascadeReport& report, bool flown) {
  ExportContent content;
  content.vehicle = vehicle;
  content.cascade = CascadeDesign{report.cascade.gains, {}, report.specification.method};
  content.cascade->back_calculation = designed_back_calculation(report.cascade.gains.dt);
  content.cascade->velocity_feed_forward = true;
  content.cascade->conditional_integration = true;
  content.cascade->integrator_limit = CascadeController{}.integrator_limit;
  content.cascade->attitude_limit =
      flown ? kDesignedAttitudeLimit : CascadeController{}.attitude_limit;
  content.estimator = stored_estimator(vehicle, "", report.cascade.gains.dt);
  return content;
}

}  // namespace

VehicleCascade vehicle_cascade(const Vehicle& vehicle, const CascadeOptions& options,
                               const std::string& where) {
  CascadeSpecification specification = cascade_specification(options, vehicle);
  const bool on_flown_plant = designs_on_flown_plant(options, vehicle);
  VehicleCascade result;
  result.ideal = !on_flown_plant && asks_for_ideal_plant(options);
  if (result.ideal) specification.lag = 0;
  const std::vector<Firmware> firmwares = firmware_of(options);
  if (!firmwares.empty() && !on_flown_plant)
    throw OptionError("for",
                      "for requires the flown plant, expected --method flown, because "
                      "--method loops does not include the filters of a firmware");
  if (options.rate_lead && !on_flown_plant) {
    const std::string implied = option_of_loops(options);
    throw OptionError(
        "rate-lead",
        implied.empty()
            ? "rate-lead requires the flown plant, expected --method flown, because --method loops "
              "has no lead"
            : fmt::format("rate-lead cannot be combined with --{}, which requires --method loops, "
                          "because that method has no lead",
                          implied));
  }
  if (on_flown_plant) {
    result.flown = cascade_on_flown_plant(vehicle, specification, firmwares, options);
    result.report = assess_written_cascade(vehicle, as_cascade(*result.flown, specification.dt),
                                           specification.method, where);
  } else {
    result.report = design_cascade(vehicle, specification, where);
  }
  result.content = content_of(vehicle, result.report, on_flown_plant);
  if (on_flown_plant && firmwares.empty() && !options.rate_lead &&
      internal::has_slow_motors(vehicle))
    result.advice = fmt::format(
        "the lag of the motors, {:.3g} s, limits the loops of roll and pitch; --rate-lead {:.3g}, "
        "which `quadtune design V` uses, makes them faster and better damped",
        internal::rotor_lag(vehicle), internal::usual_rate_lead(vehicle));
  const CascadeDesign& cascade = *result.content.cascade;
  try {
    result.loop = flown_loop(hover_under(vehicle, cascade_controller(cascade, cascade.gains),
                                         result.content.estimator, ""));
  } catch (const InvalidInput& error) {
    result.not_analysed = error.message();
  }
  return result;
}

std::vector<std::string> notes_of(const VehicleCascade& cascade) {
  std::vector<std::string> notes;
  const auto add = [&](const char* kind, const std::vector<std::string>& texts) {
    for (const std::string& text : texts) notes.push_back(kind + text);
  };
  add("note: ", cascade.report.cascade.notes);
  if (cascade.flown) add("note: ", cascade.flown->notes);
  if (!cascade.advice.empty()) add("note: ", {cascade.advice});
  // Loops that were designed for the flown plant are judged there.
  if (!cascade.loop || !cascade.flown) add("warning: ", cascade_warnings(cascade.report));
  if (!cascade.loop) return notes;
  const FlownLoop& loop = *cascade.loop;
  add("note: ", flown_notes(loop));
  add("note: ", margin_notes(loop.margins));
  if (loop.grows())
    notes.push_back(fmt::format("warning: the flown loop is unstable; {}{}", describe(loop),
                                cascade.ideal
                                    ? "; without --plant ideal the design includes the rotors' "
                                      "lag, the sensors and the estimator"
                                    : ""));
  add("warning: flown loop: ", margin_warnings(loop.margins));
  return notes;
}

}  // namespace quadtune
