// SPDX-License-Identifier: Apache-2.0
#include "lqr_vehicle.hpp"

#include <fmt/format.h>

#include <optional>
#include <ostream>

#include "program/refusal.hpp"
#include "quadtune/exports/schedule_table.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/design/lqi_report.hpp"
#include "quadtune/workbench/design/lqr_report.hpp"
#include "quadtune/workbench/design/matrix_report.hpp"
#include "quadtune/workbench/schedule/schedule_axes.hpp"
#include "quadtune/workbench/schedule/schedule_report.hpp"
#include "report/gains/gains.hpp"

namespace quadtune::cli {
namespace {

/// The format of the table of a schedule, if one is written.
std::optional<TableFormat> wanted_table(const Context& context) {
  if (context.file.empty()) return context.json ? std::optional(TableFormat::json) : std::nullopt;
  const TableFormat format = table_format(context.file, "-o");
  if (context.json && format != TableFormat::json)
    refuse("-o", "-o is '{}', expected a name that ends in .json with --json",
           internal::printable(context.file));
  return format;
}

}  // namespace

void require_solved(const RiccatiResult& riccati, const std::string& plant) {
  if (!riccati.solved())
    throw NoSolution(fmt::format("lqr: {}: {}", to_string(riccati.status), riccati.culprit),
                     riccati.status == RiccatiStatus::not_detectable ? "--Q" : plant);
}

void run_flown_lqr(const LqrArguments& common, const FlownLqrArguments& arguments,
                   Context& context) {
  const Vehicle vehicle = load_vehicle(common.plant.vehicle);
  const LqiReport report = design_on_flown_plant(
      common, arguments, [&](const FlightOptions& flight, const FlownLoopOptions& at) {
        return lqi_report(vehicle, flown_lqi_options(vehicle, lqi_design(common, arguments)),
                          flight, at);
      });
  context.notes(report.messages);
  context.print([&] { return to_json(report, vehicle); }, [&] { return to_text(report); });
}

void run_matrix_lqr(const LqrArguments& common, const FlownLqrArguments& arguments,
                    bool asks_for_inputs, Context& context) {
  const Vehicle vehicle = load_vehicle(common.plant.vehicle);
  const LqiDesign design = matrix_design(common, arguments, asks_for_inputs);
  const MatrixReport report = design_on_flown_plant(
      common, arguments, [&](const FlightOptions& flight, const FlownLoopOptions& at) {
        return matrix_report(vehicle, design, flight, at);
      });
  context.notes(report.messages);
  context.print([&] { return to_json(report, vehicle); }, [&] { return to_text(report); });
}

void run_ideal_lqr(const LqrArguments& arguments, const std::string& evidence, Context& context) {
  const MarginsEvidence margins =
      evidence.empty() ? MarginsEvidence::full : margins_evidence(evidence);
  LinearVehicle plant = make_plant(arguments.plant);
  const LqrDesign design =
      make_design(arguments, plant.model.plant.states, plant.model.plant.inputs);
  const VehicleLqrReport report = lqr_report(std::move(plant), design, margins);
  context.notes(report.messages);
  require_solved(report.feedback.riccati, arguments.plant.vehicle);
  context.print([&] { return to_json(report); }, [&] { return to_text(report); });
}

void run_schedule(const LqrArguments& arguments, const std::string& grid, Context& context) {
  const std::vector<ScheduleAxis> axes = schedule_axes(grid, "--schedule");
  const std::optional<TableFormat> format = wanted_table(context);
  const Vehicle vehicle = load_vehicle(arguments.plant.vehicle);
  const ContinuousLti words =
      Linearizer(vehicle, linearize_options(arguments.plant)).unsolved().plant;
  const LqrDesign design = make_design(arguments, words.states, words.inputs);
  const ScheduleReport report =
      schedule_report(vehicle, axes, design, {arguments.plant.yaw, context.threads, &interrupted},
                      arguments.plant.vehicle);
  context.notes(report.messages);
  context.out << (format ? schedule_text(report.schedule, *format) : to_text(report.schedule));
}

}  // namespace quadtune::cli
