// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/firmware/firmware_import.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "firmware/turn_parts.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/synthesis/open_loop.hpp"
#include "quadtune/workbench/design/cascade_report.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/design/vehicle_cascade.hpp"
#include "quadtune/workbench/export/export_content.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"
#include "quadtune/workbench/flown/flown_check.hpp"

namespace quadtune {
namespace {

constexpr double kMinPhase = 20;  // [deg]
constexpr double kMaxMs = 3;

double degrees(double angle) { return angle * 180 / std::numbers::pi; }

FirmwareTurn turn_of(const Firmware& firmware, const Vehicle& vehicle, const FirmwareLoop& loop,
                     const std::vector<Parameter>& values) {
  FirmwareTurn turn;
  turn.gains = loop;
  turn.inertia = vehicle.inertia.diagonal()(internal::body_axis(loop.axis));
  turn.damping = turn_damping(vehicle, loop.axis);
  turn.delay = firmware_delay(firmware, vehicle, values);
  turn.lag = internal::rotor_lag(vehicle);
  const auto margins = [&](bool angle) {
    return loop_margins(OpenLoop(firmware_turn_loop(firmware, vehicle, loop, values, angle)));
  };
  turn.rate = margins(false);
  turn.whole = margins(true);
  return turn;
}

/// Notes about parts of a loop that a cascade of PidLoops cannot represent.
void note_left_out(const FirmwareTurn& turn, std::vector<std::string>& notes) {
  if (const double D = turn.gains.derivative(); D != 0)
    notes.push_back(
        fmt::format("{}: D acts as {:.3g} kg m^2 of additional inertia, {:.0f} % of the vehicle's",
                    to_string(turn.gains.axis), D, 100 * D / turn.inertia));
  if (turn.gains.double_integral() != 0)
    notes.push_back(fmt::format(
        "{}: the controllers of angle and rate both have an integral. Flights and the margins of "
        "the whole loop include the product of the two; the cascade, which other commands use, "
        "does not",
        to_string(turn.gains.axis)));
}

void note_weak(const std::vector<FirmwareTurn>& turns, std::vector<std::string>& notes) {
  std::vector<std::string> unstable, weak;
  for (const FirmwareTurn& turn : turns) {
    if (!turn.whole.stable)
      unstable.push_back(to_string(turn.gains.axis));
    else if (!has_margins_to_fly(turn))
      weak.push_back(describe(turn));
  }
  if (!unstable.empty())
    notes.push_back(
        fmt::format("the loops of {} are UNSTABLE in the firmware, with its filters and "
                    "its delay",
                    internal::joined(unstable, " and ")));
  if (!weak.empty())
    notes.push_back(fmt::format("the margins are too small to fly: {}; expected {}",
                                internal::joined(weak, ", "), margins_to_fly()));
}

void note_hover(const Firmware& firmware, const Vehicle& vehicle, const ParameterFile& file,
                std::vector<std::string>& notes) {
  for (const char* name : {"MPC_THR_HOVER", "MOT_THST_HOVER"})
    for (const Parameter& parameter : file.values) {
      if (parameter.name != name || !(parameter.value > 0)) continue;
      const double expected = firmware_scale(firmware, vehicle, file.values).hover;
      constexpr double kTold = 0.1;
      if (std::abs(parameter.value / expected - 1) > kTold)
        notes.push_back(
            fmt::format("{} is {:.3g}, but the vehicle file gives {:.3g}: if the former was "
                        "learned in flight, the vehicle's thrust or mass is wrong",
                        name, parameter.value, expected));
    }
}

/// Notes values outside the ranges that the firmware publishes, most often because of a unit.
void note_ranges(const Firmware& firmware, const ParameterFile& file,
                 std::vector<std::string>& notes) {
  std::vector<std::string> outside;
  for (const ParameterFacts& facts : parameter_facts(firmware)) {
    const double low = facts.min.value_or(-INFINITY), high = facts.max.value_or(INFINITY);
    for (const Parameter& parameter : file.values)
      if (parameter.name == facts.name && !(parameter.value >= low && parameter.value <= high))
        outside.push_back(
            fmt::format("{} is {:.6g} ({:g} to {:g})", facts.name, parameter.value, low, high));
  }
  if (!outside.empty())
    notes.push_back(
        fmt::format("outside the published range: {}", internal::joined(outside, ", ")));
}

ExportContent content_of(const Vehicle& vehicle, const CascadeGains& gains) {
  ExportContent content;
  content.vehicle = vehicle;
  content.cascade = CascadeDesign{gains, {}, PidMethod::forward_euler};
  content.cascade->back_calculation = designed_back_calculation(gains.dt);
  content.cascade->velocity_feed_forward = true;
  content.cascade->conditional_integration = true;
  content.cascade->integrator_limit = CascadeController{}.integrator_limit;
  content.cascade->attitude_limit = kDesignedAttitudeLimit;
  content.estimator = stored_estimator(vehicle, "", gains.dt);
  content.versions = library_versions();
  content.inputs = {{vehicle_file_name(vehicle), vehicle.text}};
  return content;
}

}  // namespace

bool has_margins_to_fly(const FirmwareTurn& turn) {
  return turn.whole.stable && degrees(turn.whole.phase_margin) >= kMinPhase &&
         turn.whole.Ms <= kMaxMs;
}

std::string margins_to_fly() {
  return fmt::format("a phase of at least {} deg and an Ms of at most {}", kMinPhase, kMaxMs);
}

std::string describe(const FirmwareTurn& turn) {
  return fmt::format("{} phase {:.1f} deg, Ms {:.2f}", to_string(turn.gains.axis),
                     degrees(turn.whole.phase_margin), turn.whole.Ms);
}

std::vector<FirmwareTurn> firmware_turns(const Firmware& firmware, const Vehicle& vehicle,
                                         const std::vector<Parameter>& values) {
  std::vector<FirmwareTurn> result;
  for (const FirmwareLoop& loop : firmware_loops(firmware, vehicle, values))
    if (internal::turns(loop.axis)) result.push_back(turn_of(firmware, vehicle, loop, values));
  return result;
}

FirmwareImport import_parameters(const Firmware& firmware, const Vehicle& vehicle,
                                 const std::optional<ParameterFile>& file, double dt) {
  FirmwareImport result;
  result.firmware = firmware;
  result.vehicle = vehicle;
  const std::vector<Parameter> values = file ? file->values : std::vector<Parameter>();
  result.loops = firmware_loops(firmware, vehicle, values);
  result.turns = firmware_turns(firmware, vehicle, values);
  if (firmware.kind == FirmwareKind::ardupilot)
    result.notes.emplace_back(
        "altitude: the firmware's loop of the vertical acceleration initially gives about half of "
        "the requested acceleration. Only `fly` simulates this. In flight, the height is therefore "
        "damped less than the margins suggest");
  CascadeGains pilot;
  for (const FirmwareLoop& loop : result.loops) {
    if (!loop.flies && pilot.loops.empty()) {
      pilot = vehicle_cascade(vehicle, {}, vehicle.name).content.cascade->gains;
      result.notes.emplace_back(
          "x, y and altitude are controlled by the pilot: the loops of `quadtune pid V` are used "
          "instead");
    }
  }
  if (file) {
    result.notes.insert(result.notes.end(), file->notes.begin(), file->notes.end());
    if (file->others > 0)
      result.notes.push_back(fmt::format("{} of the file {} not belong to these loops",
                                         internal::counted(file->others, "other parameter"),
                                         file->others == 1 ? "does" : "do"));
    note_ranges(firmware, *file, result.notes);
    note_hover(firmware, vehicle, *file, result.notes);
  }
  for (const FirmwareTurn& turn : result.turns) note_left_out(turn, result.notes);
  note_weak(result.turns, result.notes);
  result.content =
      content_of(vehicle, cascade_of(result.loops, pilot, dt > 0 ? dt : kFirmwarePeriod));
  result.content.parameters = StoredParameters{firmware, values};
  const CascadeDesign& cascade = *result.content.cascade;
  try {
    result.flown = flown_loop(hover_under(vehicle, cascade_controller(cascade, cascade.gains),
                                          result.content.estimator, ""));
  } catch (const InvalidInput& error) {
    result.notes.push_back(std::string("the flown loop is not analysed: ") + error.message());
  }
  return result;
}

}  // namespace quadtune
