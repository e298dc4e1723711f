// SPDX-License-Identifier: Apache-2.0
#include "laws/lqr_flown.hpp"

#include <fmt/format.h>

#include <cmath>
#include <ostream>

#include "arguments/flight_arguments.hpp"
#include "arguments/matrix_arguments.hpp"
#include "report/gains/laws_json.hpp"
#include "program/command_line.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/design/export_content.hpp"
#include "quadtune/workbench/flown/flown_check.hpp"
#include "quadtune/workbench/flown/flying_loop.hpp"
#include "report/gains/lqi_report.hpp"
#include "report/loops/flown_report.hpp"
#include "report/loops/margins_report.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

using internal::Json;

constexpr const char* kFlownOptions[] = {"--change", "--past", "--estimator", "--sensors",
                                         "--height"};

std::vector<std::string> names_of(const std::vector<Signal>& signals) {
  return names_or_numbers(signals, std::ssize(signals));
}

}  // namespace

void add_flown_lqr_options(CommandLine& line, FlownLqrArguments& arguments) {
  line.add_option("--change", arguments.change,
                  "flown plant: weights of the change of each command from one period to "
                  "the next; none")
      ->type_name("LIST");
  line.add_number("--past", arguments.past,
                  "flown plant: control periods by which the law predicts; default: what meets the "
                  "margins with the smallest increase of the weights")
      ->type_name("N");
  line.add_option("--estimator", arguments.estimator,
                  "flown plant: as for `quadtune fly`; default: what the sensors allow")
      ->type_name("NAME");
  line.add_option("--sensors", arguments.sensors, "flown plant: real (default) or ideal")
      ->type_name("NAME");
  line.add_number("--height", arguments.height, "flown plant: height of the hover [m], default 1.1")
      ->type_name("M");
}

std::set<std::string> given_flown_options(const CommandLine& line) {
  std::set<std::string> given;
  for (const char* name : kFlownOptions)
    if (line.was_given(name)) given.insert(name);
  return given;
}

LqiDesign lqi_design(const LqrArguments& common, const FlownLqrArguments& arguments) {
  const std::string& verb = common.verb;
  LqiDesign design;
  if (common.has_dt) {
    require_positive(common.dt, verb, "--dt");
    design.dt = common.dt;
  }
  const std::vector<std::string> states = names_of(ned_convention().states);
  const std::vector<std::string> inputs = names_of(ned_convention().wrench);
  if (!common.integral.empty()) design.integrals = read_integrals(common, states);
  if (arguments.given.count("--past") > 0) {
    if (arguments.past != std::floor(arguments.past) || arguments.past < 0 ||
        arguments.past > kMostPastCommands)
      throw UsageError(
          fmt::format("quadtune {}: --past is {}, expected a whole number from 0 to {}", verb,
                      number(arguments.past), kMostPastCommands),
          "--past");
    design.past = static_cast<int>(arguments.past);
  }
  if (!common.Q.empty()) {
    std::vector<std::string> weighted = states;
    for (const std::string& name : design.integrals) weighted.push_back("int_" + name);
    const Eigen::VectorXd Q =
        diagonal_weights(common.Q, weighted.size(),
                         fmt::format("states: {}", internal::joined(weighted, " ")), verb, "--Q")
            .diagonal();
    design.Q = Q.head(12);
    design.Q_integral = Q.tail(Q.size() - 12);
  }
  const std::string of_inputs = fmt::format("inputs: {}", internal::joined(inputs, " "));
  if (!common.R.empty()) {
    design.R = diagonal_weights(common.R, inputs.size(), of_inputs, verb, "--R").diagonal();
    if (!(design.R->minCoeff() > 0))
      throw UsageError(fmt::format("quadtune {}: --R has a weight of 0, expected weights of more "
                                   "than 0",
                                   verb),
                       "--R");
  }
  if (!arguments.change.empty()) {
    if (design.past && *design.past < 1)
      throw UsageError(
          fmt::format("quadtune {}: --change came with --past 0, expected --past of at least 1 "
                      "because the law must know its last command",
                      verb),
          "--change");
    design.R_change =
        diagonal_weights(arguments.change, inputs.size(), of_inputs, verb, "--change").diagonal();
  }
  return design;
}

LqiReport lqi_of_command(const Vehicle& vehicle, const LqrArguments& common,
                         const FlownLqrArguments& arguments) {
  require_positive(arguments.height, common.verb, "--height", "metres");
  FlightOptions flight;
  flight.vehicle = common.plant.vehicle;
  flight.estimator = arguments.estimator;
  flight.sensors = arguments.sensors;
  FlownLoopOptions at;
  at.height = arguments.height;
  return weights_of_command(common, [&] {
    require_flight_words(flight);
    return lqi_report(vehicle, flown_lqi_options(vehicle, lqi_design(common, arguments)), flight,
                      at);
  });
}

void write_notes(const std::vector<std::string>& notes, const FlownLoop& flown,
                 const std::string& verb, const Context& context) {
  const auto note = [&](const std::string& text) {
    context.note(fmt::format("{}: note: {}", verb, text));
  };
  const auto warn = [&](const std::string& text) {
    context.note(fmt::format("{}: warning: {}", verb, text));
  };
  for (const std::string& text : notes) note(text);
  for (const std::string& text : flown_notes(flown)) note(text);
  for (const std::string& text : margin_notes(flown.margins)) note(text);
  if (flown.grows()) warn("the flown loop is unstable; " + in_words(flown));
  for (const std::string& text : margin_warnings(flown.margins)) warn(text);
}

void write_notes(const LqiReport& report, const std::string& verb, const Context& context) {
  write_notes(report.design.notes, report.flown, verb, context);
}

void run_flown_lqr(const LqrArguments& common, const FlownLqrArguments& arguments,
                   Context& context) {
  const Vehicle vehicle = load_vehicle(common.plant.vehicle);
  const LqiReport report = lqi_of_command(vehicle, common, arguments);
  write_notes(report, common.verb, context);
  if (context.json)
    context.out << internal::readable(to_json(report, vehicle)) << "\n";
  else
    context.out << to_text(report);
}

std::optional<FlownLoop> flown_loop_of_ideal(const Vehicle& vehicle, const Linearization& model,
                                             const Gains& gains, const Context& context) {
  if (gains.states.size() != 12 || !has_flown_loop(model.trim)) return {};
  try {
    return flown_loop(hover_under(vehicle, gains));
  } catch (const InvalidInput& error) {
    context.note(fmt::format("lqr: note: the flown loop is not analysed: {}", error.what()));
    return {};
  }
}

}  // namespace quadtune::cli
