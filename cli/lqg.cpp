// SPDX-License-Identifier: Apache-2.0
/// quadtune lqg: state feedback and filter together, with what the sensors' noise makes of them.
#include <fmt/format.h>

#include <memory>
#include <ostream>

#include "arguments/flight_arguments.hpp"
#include "arguments/matrix_arguments.hpp"
#include "laws/lqr_flown.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/design/lqg_report.hpp"
#include "report/loops/margins_report.hpp"
#include "report/text/print.hpp"
#include "report/gains/lqi_report.hpp"

namespace quadtune::cli {
namespace {

using internal::Json;

struct Options {
  LqrArguments common;
  FlownLqrArguments flown;
  double time = LqgOptions().time;
  bool recover = false;
  double noise_budget = LqgOptions().noise_budget;
};

std::vector<std::string> names_of(const std::vector<Signal>& signals) {
  return names_or_numbers(signals, std::ssize(signals));
}

Json lqg_json(const LqgReport& report, const Vehicle& vehicle) {
  Json json = to_json(report.lqi, vehicle);
  json["margins_at_estimates"] = to_json(report.at_estimates);
  const auto by_name = [](const std::vector<Signal>& signals, const Eigen::VectorXd& values) {
    Json table = Json::object();
    for (std::size_t i = 0; i < signals.size(); ++i)
      table[signals[i].name] = internal::finite_or_null(values(static_cast<Eigen::Index>(i)));
    return table;
  };
  const Gains& gains = report.lqi.design.lqi.gains;
  json["predicted_rms"] = {{"time_s", report.rms.time},
                           {"state", by_name(gains.states, report.rms.state)},
                           {"estimate_error", by_name(gains.states, report.rms.error)},
                           {"command", by_name(gains.inputs, report.rms.command)}};
  Json recoveries = Json::array();
  for (const Recovery& tried : report.recoveries)
    recoveries.push_back({{"factor", tried.factor},
                          {"share_of_margins", internal::finite_or_null(tried.share)},
                          {"command_noise", internal::finite_or_null(tried.noise)},
                          {"affordable", tried.affordable}});
  json["recovery"] = {{"factor", report.recovery}, {"tried", recoveries}};
  return json;
}

std::string recovery_text(const LqgReport& report) {
  std::string text =
      fmt::format("the filter's inertial noise times {}\n{:>8}{:>20}{:>16}",
                  number(report.recovery), "factor", "share of margins", "command noise");
  for (const Recovery& tried : report.recoveries)
    text += fmt::format("\n{:>8}{:>20.3f}{:>16.3f}{}", number(tried.factor), tried.share,
                        tried.noise, tried.affordable ? "" : "  exceeds the budget");
  return text;
}

std::string lqg_text(const LqgReport& report) {
  const Gains& gains = report.lqi.design.lqi.gains;
  Eigen::MatrixXd rms(2, 12);
  rms << report.rms.state.transpose(), report.rms.error.transpose();
  std::string text =
      to_text(report.lqi) + section("margins at the estimates", to_text(report.at_estimates)) +
      section(fmt::format("rms after {} s", number(report.rms.time)),
              table(rms, {"true", "estimate's error"}, names_of(gains.states)) + "\n" +
                  table(report.rms.command.transpose(), {"command"}, names_of(gains.inputs)));
  if (!report.recoveries.empty()) text += section("recovery", recovery_text(report));
  return text;
}

void run(const Options& options, Context& context) {
  if (options.common.plant.vehicle.empty())
    throw UsageError("quadtune lqg: expected a vehicle, built in or a file", "V");
  require_positive(options.time, "lqg", "--time");
  constexpr double kLongest = 1e6;
  if (options.time > kLongest)
    throw UsageError(fmt::format("quadtune lqg: --time is {}, expected at most {} s",
                                 number(options.time), number(kLongest)),
                     "--time");
  const Vehicle vehicle = load_vehicle(options.common.plant.vehicle);
  FlightOptions flight;
  flight.vehicle = options.common.plant.vehicle;
  flight.estimator = options.flown.estimator;
  flight.sensors = options.flown.sensors;
  FlownLoopOptions at;
  at.height = options.flown.height;
  require_positive(at.height, "lqg", "--height", "metres");
  const LqgReport report = weights_of_command(options.common, [&] {
    require_flight_words(flight);
    LqgOptions asked;
    asked.design = flown_lqi_options(vehicle, lqi_design(options.common, options.flown));
    asked.time = options.time;
    asked.recover = options.recover;
    asked.noise_budget = options.noise_budget;
    return lqg_report(vehicle, asked, flight, at);
  });
  write_notes(report.lqi, "lqg", context);
  const std::string& estimator = report.lqi.flown.estimator;
  if (estimator != "general" && estimator != "truth")
    context.note(
        fmt::format("lqg: note: the deviations are linear; flights agree with them with "
                    "the general filter, with the estimator {} they may be larger",
                    estimator));
  if (options.recover && report.recovery == 1)
    context.note(
        "lqg: note: no other noise of the filter has larger margins within the budget; what limits "
        "them is the delay of the loop");
  if (context.json)
    context.out << internal::readable(lqg_json(report, vehicle)) << "\n";
  else
    context.out << lqg_text(report);
}

}  // namespace

Verb lqg_verb() {
  return {
      "lqg", "V [options]",
      "state feedback and filter of a vehicle: predicted deviations, margins with the filter",
      "quadtune lqg mambo --recover", [](CommandLine& line) -> Action {
        auto options = std::make_shared<Options>();
        options->common.verb = "lqg";
        line.add_option("V", options->common.plant.vehicle, "built-in vehicle or vehicle file");
        line.add_option("--Q", options->common.Q,
                        "weights of the 12 states, then of the integrals; one number stands for "
                        "all; default: Bryson's rule, softened until the margins are met")
            ->type_name("FILE|LIST");
        line.add_option("--R", options->common.R, "weights of the wrench, likewise")
            ->type_name("FILE|LIST");
        line.add_option("--integral", options->common.integral,
                        "states to integrate, or none; default px,py,pz,yaw")
            ->type_name("LIST");
        line.add_number("--dt", options->common.dt, "control period [s], default 0.005")
            ->type_name("T");
        add_flown_lqr_options(line, options->flown);
        line.add_number("--time", options->time, "time of the prediction [s], default 60")
            ->type_name("S");
        line.add_flag("--recover", options->recover,
                      "raise the noise that the filter assumes of gyroscope and accelerometer "
                      "where that gives larger margins (loop transfer recovery)");
        line.add_number("--noise-budget", options->noise_budget,
                        "most by which --recover may multiply the rms of a command, default 1.5")
            ->type_name("F");
        return [options, owner = &line](Context& context) {
          options->common.has_dt = owner->was_given("--dt");
          options->flown.given = given_flown_options(*owner);
          if (!options->recover && owner->was_given("--noise-budget"))
            throw UsageError(
                "quadtune lqg: --noise-budget came without --recover, expected "
                "both",
                "--noise-budget");
          run(*options, context);
        };
      }};
}

}  // namespace quadtune::cli
