// SPDX-License-Identifier: Apache-2.0
#include "laws/lqr_flown.hpp"

#include <fmt/format.h>

#include <cmath>
#include <ostream>

#include "arguments/flight_arguments.hpp"
#include "arguments/matrix_arguments.hpp"
#include "laws/given_gains.hpp"
#include "program/command_line.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/design/export_content.hpp"
#include "quadtune/workbench/flown/flown_check.hpp"
#include "quadtune/workbench/flown/flying_loop.hpp"
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

/// "T[k-1]", "tau_x[k-1]", …
std::vector<std::string> past_names(const std::vector<Signal>& inputs, int past) {
  std::vector<std::string> result;
  for (int j = 1; j <= past; ++j)
    for (const Signal& input : inputs) result.push_back(fmt::format("{}[k-{}]", input.name, j));
  return result;
}

Eigen::RowVectorXd row(const Eigen::MatrixXd& M) { return M.diagonal().transpose(); }

std::string weights_text(const LqiReport& report) {
  const ActuatorLqiWeights& weights = report.design.weights;
  const Gains& gains = report.design.lqi.gains;
  std::string text = table(row(weights.Q), {"Q"}, names_of(gains.states));
  if (!gains.integrals.empty())
    text += "\n" + table(row(weights.Q_integral), {"Q_int"}, names_of(gains.integrals));
  text += "\n" + table(row(weights.R), {"R"}, names_of(gains.inputs));
  if (weights.R_change.size() > 0)
    text += "\n" + table(row(weights.R_change), {"change"}, names_of(gains.inputs));
  return text;
}

std::string law_text(const LqiReport& report) {
  const Gains& gains = report.design.lqi.gains;
  std::string text = fmt::format("LQI sampled every {} s", number(gains.dt));
  if (!gains.memory) return text;
  if (gains.memory->K_lag.cwiseAbs().maxCoeff() > 0)
    text += fmt::format(", with the rotors' lag of {} s", number(gains.memory->lag(0)));
  if (gains.memory->past > 0)
    text += fmt::format(", with {} past command{}", gains.memory->past,
                        gains.memory->past == 1 ? "" : "s");
  return text;
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
  return told_of_weights(common, [&] {
    require_flight_words(flight);
    return lqi_report(vehicle, flown_lqi_options(vehicle, lqi_design(common, arguments)), flight,
                      at);
  });
}

void add_gains(Json& json, const Gains& gains) {
  json["K"] = internal::matrix_to_json(gains.K, "K");
  json["K_int"] = internal::matrix_to_json(gains.K_int, "K_int");
  json["states"] = internal::signals_to_json(gains.states);
  json["inputs"] = internal::signals_to_json(gains.inputs);
  json["integrals"] = names_of(gains.integrals);
  json["dt_s"] = gains.dt;
}

void add_loops(Json& json, const FlownLoop& flown, const MarginsReport& ideal) {
  json["flown"] = to_json(flown);
  json["margins"] = to_json(flown.margins);
  json["ideal"] = to_json(ideal);
}

void add_export(Json& json, const Vehicle& vehicle, const Gains& gains,
                const std::optional<StoredEstimator>& estimator) {
  ExportContent content;
  content.vehicle = vehicle;
  content.gains = gains;
  content.estimator = estimator;
  add_laws(json, content);
}

Json to_json(const LqiReport& report, const Vehicle& vehicle) {
  const FlownLqi& design = report.design;
  const Gains& gains = design.lqi.gains;
  Json json = {{"status", to_string(design.lqi.riccati.status)}, {"plant", "flown"}};
  add_gains(json, gains);
  if (gains.memory)
    json["memory"] = {{"lag_s", internal::vector_to_json(gains.memory->lag, "lag")},
                      {"K_lag", internal::matrix_to_json(gains.memory->K_lag, "K_lag")},
                      {"past", gains.memory->past},
                      {"K_past", internal::matrix_to_json(gains.memory->K_past, "K_past")}};
  else
    json["memory"] = nullptr;
  Json& weights = json["weights"];
  weights["Q"] = internal::vector_to_json(design.weights.Q.diagonal(), "Q");
  weights["Q_integral"] = internal::vector_to_json(design.weights.Q_integral.diagonal(), "Q_int");
  weights["R"] = internal::vector_to_json(design.weights.R.diagonal(), "R");
  weights["R_change"] =
      design.weights.R_change.size() > 0
          ? internal::vector_to_json(design.weights.R_change.diagonal(), "R_change")
          : Json();
  weights["softened"] = design.softened;
  weights["lowered"] = design.lowered;
  weights["margins_met"] = design.met;
  json["poles"] = internal::poles_to_json(design.lqi.riccati.poles, "poles");
  json["residual"] = internal::number_to_json(design.lqi.riccati.residual, "residual");
  json["rcond"] = internal::number_to_json(design.lqi.riccati.rcond, "rcond");
  json["notes"] = design.notes;
  add_loops(json, report.flown, report.ideal);
  add_export(json, vehicle, gains, report.estimator);
  return json;
}

std::string to_text(const LqiReport& report) {
  const Gains& gains = report.design.lqi.gains;
  const std::vector<std::string> inputs = names_of(gains.inputs);
  std::string text = section("law", law_text(report)) + section("weights", weights_text(report)) +
                     section("gain K", table(gains.K, inputs, names_of(gains.states)));
  if (!gains.integrals.empty())
    text += section("integral K", table(gains.K_int, inputs, names_of(gains.integrals)));
  if (gains.memory) {
    if (gains.memory->K_lag.cwiseAbs().maxCoeff() > 0)
      text += section("lag K", table(gains.memory->K_lag, inputs, inputs));
    if (gains.memory->past > 0)
      text += section("past K", table(gains.memory->K_past, inputs,
                                      past_names(gains.inputs, gains.memory->past)));
  }
  return text + section("flown loop", to_text(report.flown)) +
         section("margins of the flown loop", to_text(report.flown.margins)) +
         section("margins of the ideal plant", to_text(report.ideal));
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
