// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/export/gains_export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <utility>

#include "quadtune/convention.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/convert.hpp"
#include "quadtune/exports/exporter.hpp"
#include "quadtune/exports/firmware.hpp"
#include "quadtune/exports/included_estimator.hpp"
#include "quadtune/exports/schedule_table.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/design/cascade_report.hpp"
#include "quadtune/workbench/design/given_gains.hpp"
#include "quadtune/workbench/export/export_content.hpp"
#include "quadtune/workbench/firmware/firmware_import.hpp"
#include "quadtune/workbench/flown/flown_check.hpp"
#include "quadtune/workbench/flown/flying_loop.hpp"
#include "verify/manifest_vehicle.hpp"

namespace quadtune {

namespace {

double in_degrees(double angle) { return angle * 180 / std::numbers::pi; }

/// Reports how rounding to a firmware's numbers changes the margins of the cascade.
std::string margins_changed(const ExportContent& before, const ExportContent& after) {
  const auto margins = [](const ExportContent& content) {
    return assess_written_cascade(content.vehicle, content.cascade->gains, content.cascade->method,
                                  content.vehicle.name)
        .margins;
  };
  const MarginsReport was = margins(before), is = margins(after);
  std::string text =
      "margins of the cascade before and after the conversion, in a model without sensors, "
      "estimator "
      "and firmware:";
  for (std::size_t i = 0; i < was.loops.size() && i < is.loops.size(); ++i)
    text +=
        fmt::format("{} {} Ms {:.3f} -> {:.3f}, phase {:.1f} -> {:.1f} deg", i == 0 ? "" : ";",
                    is.names[i], was.loops[i].Ms, is.loops[i].Ms,
                    in_degrees(was.loops[i].phase_margin), in_degrees(is.loops[i].phase_margin));
  return text;
}

Firmware target_of(const ExportContent& content, ExportKind kind) {
  return firmware(firmware_kind(kind.name(), "--to"), content.firmware, kind.name());
}

/// The known parameters of the board that an export does not list, so that the board keeps them.
std::vector<Parameter> remaining(const ExportContent& content, const Firmware& target,
                                 const std::vector<Parameter>& written) {
  if (!content.board || content.board->firmware.kind != target.kind) return {};
  std::vector<Parameter> result;
  for (const Parameter& of_board : content.board->values) {
    const auto same = [&](const Parameter& other) { return other.name == of_board.name; };
    if (std::none_of(written.begin(), written.end(), same)) result.push_back(of_board);
  }
  return result;
}

/// The rotation loops on the board.
struct BoardTurns {
  std::vector<FirmwareTurn> turns;
  std::vector<Parameter> remaining;
};

BoardTurns turns_of(const ExportContent& content, const Firmware& target) {
  std::vector<Parameter> values =
      firmware_parameters(target, content.vehicle, content.cascade->gains).values;
  BoardTurns result{{}, remaining(content, target, values)};
  values.insert(values.end(), result.remaining.begin(), result.remaining.end());
  result.turns = firmware_turns(target, content.vehicle, values);
  return result;
}

/// Reports the rotation loops with the filters and delays of the firmware.
/// @throws NoSolution  if a loop is unstable
std::string turns_on_board(const ExportContent& content, ExportKind kind) {
  const Firmware target = target_of(content, kind);
  const BoardTurns board = turns_of(content, target);
  std::string text = "with the filters and the delay of the firmware at their defaults";
  if (!board.remaining.empty()) {
    std::vector<std::string> kept;
    for (const Parameter& one : board.remaining)
      kept.push_back(fmt::format("{} {:.6g}", one.name, one.value));
    text += fmt::format(", except {}, which the board keeps", internal::joined(kept, ", "));
  }
  text += ":";
  for (const FirmwareTurn& turn : board.turns) {
    if (!turn.whole.stable)
      throw NoSolution(fmt::format("{}: {} is unstable with the filters and the delay of {} {}; "
                                   "nothing was written; compute gains for this firmware with "
                                   "`quadtune pid V --for {}`",
                                   content.vehicle.name, to_string(turn.gains.axis), kind.name(),
                                   target.version, kind.name()),
                       content.vehicle.name);
    text += " " + describe(turn) + ";";
  }
  text.pop_back();
  return text;
}

/// @param name  of the user; empty: the vehicle that the laws name
Vehicle vehicle_of(const StoredLaws& laws, const std::string& name, const std::string& path) {
  if (!name.empty()) return load_vehicle(name);
  if (std::error_code ignored; std::filesystem::is_regular_file(
          std::filesystem::path(path) / std::string(kManifestName), ignored))
    return internal::vehicle_of_manifest(path, read_manifest(path), name);
  if (laws.vehicle.empty())
    throw OptionError("vehicle",
                      fmt::format("vehicle is missing, expected that of {}, which names none",
                                  internal::printable(path)));
  const std::vector<std::string> built_in = built_in_vehicles();
  if (std::find(built_in.begin(), built_in.end(), laws.vehicle) == built_in.end())
    throw OptionError(
        "vehicle",
        fmt::format("vehicle is missing, expected the file of '{}', the vehicle of {}, which is "
                    "not built in",
                    internal::printable(laws.vehicle), internal::printable(path)));
  return load_vehicle(laws.vehicle);
}

}  // namespace

void require_sampled(const StoredLaws& laws, const std::string& path) {
  if (laws.gains && !(laws.gains->dt > 0))
    throw InvalidInput(path,
                       "the gains are continuous, expected those of a sample period, e.g. by "
                       "`quadtune lqr V --method sampled --dt T`, because a computer flies them");
}

ExportContent export_content(StoredLaws laws, const std::string& vehicle, const std::string& path) {
  ExportContent content;
  content.vehicle = vehicle_of(laws, vehicle, path);
  content.gains = std::move(laws.gains);
  content.cascade = std::move(laws.cascade);
  content.estimator = std::move(laws.estimator);
  content.board = std::move(laws.parameters);
  if (content.gains) content.gains->vehicle = content.vehicle.name;
  if (content.cascade)
    content.cascade_plant = cascade_plant(content.vehicle, *content.cascade, path);
  content.versions = library_versions();
  content.inputs = {{vehicle_file_name(content.vehicle), content.vehicle.text}};
  return content;
}

ExportContent schedule_content(const std::string& path, const std::string& vehicle) {
  const std::string text = internal::read_text_file(path, kScheduleTableLimit);
  GainSchedule schedule = parse_schedule(text, path, table_format(path, path));
  StoredLaws no_laws;
  no_laws.vehicle = schedule.vehicle;
  ExportContent content = export_content(std::move(no_laws), vehicle, path);
  require_vehicle({schedule.vehicle, {}, {}}, content.vehicle, path);
  content.schedule = std::move(schedule);
  content.inputs.push_back({std::filesystem::path(path).filename().string(), text});
  return content;
}

std::vector<std::string> adapt_to_program(ExportContent& content, ExportKind kind) {
  const Exporter& exporter = exporter_of(kind, "--to");
  if (content.schedule) {
    const Eigen::Index points = content.schedule->size();
    const Eigen::Index none = points - content.schedule->solved_count();
    std::vector<std::string> told;
    if (!(content.schedule->dt > 0))
      told.emplace_back(
          "the gains are continuous, so they are valid only for a short control period; gains of "
          "`lqr V --schedule GRID --method sampled --dt T` are computed for the period T");
    if (none > 0)
      told.push_back(fmt::format("{} of {} {} no gain; the program's status reports that", none,
                                 internal::counted(points, "point"), none == 1 ? "has" : "have"));
    return told;
  }
  if (exporter.target.is_firmware) {
    const ExportContent before = content;
    content = exporter.fit(std::move(content));
    content.cascade_plant = cascade_plant(content.vehicle, *content.cascade, kind.name());
    std::vector<std::string> told = content.firmware_notes;
    told.push_back(margins_changed(before, content));
    told.push_back(turns_on_board(content, kind));
    return told;
  }
  const std::string& words = exporter.convention;
  if (content.gains && !words.empty())
    content.gains = in_convention(*content.gains, convention(words, "--to"));
  std::vector<std::string> notes;
  const std::string& adapter = content.flight_code.adapter;
  if (kind.name() == "c" && !adapter.empty() && adapter != "main")
    notes.push_back(
        fmt::format("the estimate is that of the firmware of '{}': the program does not "
                    "include the estimator with which the law was evaluated",
                    adapter));
  else if (kind.name() == "c" && included_estimator(content.estimator, adapter).empty())
    notes.emplace_back(
        "the gains name no estimator: the program expects the estimate from its caller");
  if (!content.gains || !(content.gains->dt > 0)) return notes;
  const VerifyModel model = model_of(content.vehicle, *content.gains);
  content.plant = model.plant;
  // The flight program's K*.txt do not contain a trim.
  if (!content.gains->u0.isZero(0)) return notes;
  content.gains->u0 = model.u0;
  notes.push_back(fmt::format("the gains have no trim; that of {} is used", content.vehicle.name));
  return notes;
}

std::string weak_loops(const ExportContent& content, ExportKind kind) {
  if (!exporter_of(kind, "--to").target.is_firmware || !content.cascade) return "";
  std::string weak;
  for (const FirmwareTurn& turn : turns_of(content, target_of(content, kind)).turns)
    if (!has_margins_to_fly(turn)) weak += (weak.empty() ? "" : ", ") + describe(turn);
  if (weak.empty()) return "";
  return fmt::format(
      "with the filters and the delay of {}, the margins are too small to fly ({}; expected {})",
      kind.name(), weak, margins_to_fly());
}

std::string unstable_loop(const ExportContent& content) {
  const auto problem = [&](const char* what, const Eigen::VectorXcd& poles) -> std::string {
    const double radius = poles.cwiseAbs().maxCoeff();
    if (radius < 1) return "";
    return fmt::format("the loop of {} with {} is unstable (spectral radius {:.6g})", what,
                       content.vehicle.name, radius);
  };
  std::string found;
  if (content.gains && content.plant)
    found = problem("these gains", closed_loop_poles(*content.plant, *content.gains));
  if (found.empty() && content.cascade && content.cascade_plant)
    found = problem("this cascade", closed_loop_poles(*content.cascade_plant, *content.cascade));
  return found;
}

std::string unstable_flown_loop(const ExportContent& content) {
  for (const FlownLaw& law :
       flown_laws(content.vehicle, content.gains, content.cascade, content.estimator))
    if (law.loop && !law.holds())
      return fmt::format("the flown loop of the {} is unstable: {}", law.name, describe(*law.loop));
  return "";
}

}  // namespace quadtune
