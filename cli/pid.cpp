// SPDX-License-Identifier: Apache-2.0
/// quadtune pid: PID gains for a transfer function, by requirement, by rule, or the best within
/// bounds.
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <ostream>

#include "arguments/cascade_arguments.hpp"
#include "arguments/flight_arguments.hpp"
#include "arguments/matrix_arguments.hpp"
#include "arguments/plot_argument.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/design/pid_report.hpp"
#include "quadtune/workbench/design/vehicle_cascade.hpp"
#include "report/loops/pid_report.hpp"
#include "report/loops/vehicle_cascade.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string vehicle;
  std::string method;  ///< "flown", "loops"; empty: by the other options
  std::string plant;   ///< "flown", "ideal"; empty: flown
  CascadeArguments cascade;
  std::string num, den, type = "PID", rule;
  double delay = 0;         // [s]
  double crossover = 0;     // [rad/s]
  double phase_margin = 0;  // [deg]
  double Tf = 0;            // [s]
  double tau_c = 0;         // [s]
  double Ms_max = 0;
  double Mt_max = 0;
  double noise_gain_max = 0;
  PlotArgument plot;
};

/// Which options came; 0 may be a value.
struct Given {
  bool crossover, phase_margin, Tf, tau_c, Ms_max, Mt_max, noise_gain_max;

  [[nodiscard]] bool requirement() const { return crossover || phase_margin; }
};

ContinuousTransferFunction read_plant(const Options& options) {
  ContinuousTransferFunction plant{coefficients(options.num, "pid", "--num"),
                                   coefficients(options.den, "pid", "--den"), options.delay};
  if (options.delay < 0)
    throw UsageError(
        fmt::format("quadtune pid: --delay is {} s, expected 0 or more", number(options.delay)),
        "--delay");
  validate(plant, "--num, --den");
  return plant;
}

PidBounds bounds_of(const Options& options, const Given& given) {
  PidBounds bounds;
  if (given.Ms_max) bounds.Ms_max = options.Ms_max;
  if (given.Mt_max) bounds.Mt_max = options.Mt_max;
  if (given.noise_gain_max) bounds.noise_gain_max = options.noise_gain_max;
  return bounds;
}

/// Exactly one of the three ways to find gains.
void require_one_way(const Options& options, const Given& given) {
  const bool requirement = given.requirement();
  const bool rule = !options.rule.empty();
  const bool bounds = given.Ms_max || given.Mt_max || given.noise_gain_max;
  if (static_cast<int>(requirement) + static_cast<int>(rule) + static_cast<int>(bounds) != 1)
    throw UsageError(
        "quadtune pid: expected a vehicle, or one of --crossover with --phase-margin, --rule, or "
        "--Ms-max with --Mt-max and --noise-gain-max as wanted",
        "--crossover");
  if (requirement && !(given.crossover && given.phase_margin))
    throw UsageError("quadtune pid: --crossover and --phase-margin belong together, expected both",
                     given.crossover ? "--phase-margin" : "--crossover");
  if (options.Tf < 0)
    throw UsageError(
        fmt::format("quadtune pid: --Tf is {} s, expected 0 or more", number(options.Tf)), "--Tf");
  if (rule && given.Tf)
    throw UsageError(
        "quadtune pid: --Tf does not belong to --rule, whose filter is a tenth of its "
        "derivative time",
        "--Tf");
}

PidRequest request_of(const Options& options, const Given& given) {
  PidRequest request;
  request.type = pid_type(options.type);
  request.Tf = options.Tf;
  if (given.requirement())
    request.by = PidCrossover{options.crossover, options.phase_margin};
  else if (!options.rule.empty())
    request.by = PidRule{options.rule, given.tau_c ? std::optional(options.tau_c) : std::nullopt};
  else
    request.by = bounds_of(options, given);
  return request;
}

void run(const Options& options, const Given& given, Context& context) {
  require_picture(options.plot, "pid");
  require_one_way(options, given);
  const PidReport report = option_of_command("pid", [&] {
    const PidRequest request = request_of(options, given);
    return pid_report(read_plant(options), request);
  });
  if (report.needs_filter)
    throw UsageError(
        "quadtune pid: the derivative of this plant has no bound, expected a filter "
        "with --Tf",
        "--Tf");
  draw(
      options.plot, [&] { return pid_figure(report, options.num, options.den); }, context);
  context.out << (context.json ? internal::readable(to_json(report)) + "\n" : to_text(report));
  for (const std::string& warning : margin_warnings(report.margins))
    context.note("pid: warning: " + warning);
}

// --- a vehicle -----------------------------------------------------------------------------------

/// Refuses options of the other mode: taken in silence they would give other gains than were asked.
void refuse_options(const CommandLine& line, const std::vector<std::string>& names,
                    const char* why) {
  for (const std::string& name : names)
    if (line.was_given(name)) throw UsageError(fmt::format("quadtune pid: {} {}", name, why), name);
}

void run_vehicle(const CommandLine& line, const Options& options, Context& context) {
  require_picture(options.plot, "pid");
  refuse_options(line,
                 {"--num", "--den", "--delay", "--type", "--crossover", "--phase-margin", "--Tf",
                  "--rule", "--tau-c", "--Mt-max", "--noise-gain-max"},
                 "belongs to a transfer function, expected --bandwidth, --Ms-max and the like with "
                 "a vehicle");
  const Vehicle vehicle = load_vehicle(options.vehicle);
  CascadeOptions asked = given_cascade_options(line, options.cascade);
  if (line.was_given("--Ms-max")) asked.Ms_max = options.Ms_max;
  asked.method = options.method;
  asked.plant = options.plant;
  const VehicleCascade cascade =
      option_of_command("pid", [&] { return vehicle_cascade(vehicle, asked, options.vehicle); });
  draw(
      options.plot, [&] { return cascade_figure(cascade); }, context);
  if (!cascade.loop)
    context.note("pid: note: the flown loop is not analysed: " + cascade.not_analysed);
  context.out << (context.json ? internal::readable(to_json(cascade)) + "\n" : to_text(cascade));
  for (const std::string& note : notes_of(cascade)) context.note("pid: " + note);
}

void add_transfer_function_options(CommandLine& line, Options& options) {
  line.add_option("--num", options.num, "numerator of the plant, descending powers")
      ->type_name("LIST");
  line.add_option("--den", options.den, "denominator, descending powers")->type_name("LIST");
  line.add_number("--delay", options.delay, "delay of the plant [s]")->type_name("S");
  line.add_option("--type", options.type, "P, PI, PD or PID (default)")->type_name("TYPE");
  line.add_number("--crossover", options.crossover, "where the loop's gain shall be 1 [rad/s]")
      ->type_name("W");
  line.add_number("--phase-margin", options.phase_margin, "there [deg]")->type_name("DEG");
  line.add_number("--Tf", options.Tf, "time constant of the derivative's filter [s]; 0")
      ->type_name("S");
  line.add_option("--rule", options.rule, "amigo, simc, ziegler-nichols, cohen-coon or lambda")
      ->type_name("NAME");
  line.add_number("--tau-c", options.tau_c,
                  "with the rules simc and lambda: time constant of the closed loop [s]")
      ->type_name("S");
  line.add_number("--Ms-max", options.Ms_max, "greatest integral gain with max |S| up to this; 1.4")
      ->type_name("M");
  line.add_number("--Mt-max", options.Mt_max, "and max |T| up to this")->type_name("M");
  line.add_number("--noise-gain-max", options.noise_gain_max, "and max |C S| up to this")
      ->type_name("G");
}

Given given_of(const CommandLine& line) {
  return {line.was_given("--crossover"),
          line.was_given("--phase-margin"),
          line.was_given("--Tf"),
          line.was_given("--tau-c"),
          line.was_given("--Ms-max"),
          line.was_given("--Mt-max"),
          line.was_given("--noise-gain-max")};
}

}  // namespace

Verb pid_verb() {
  return {
      "pid",
      "V [options]   or   --num LIST --den LIST [--delay S] (--crossover W --phase-margin DEG | "
      "--rule NAME | --Ms-max M)",
      "PID gains for a vehicle's cascade or for a transfer function",
      "quadtune pid --num 1 --den 1,3,3,1 --type PI --crossover 0.5205 --phase-margin 60",
      [](CommandLine& line) -> Action {
        auto options = std::make_shared<Options>();
        line.add_option("V", options->vehicle, "a built-in vehicle's name or a vehicle file");
        line.add_option(
                "--method", options->method,
                "flown (default but for a satellite receiver below 5 Hz without optical flow): all "
                "gains at once on the flown plant; loops: loop by loop, implied by --bandwidth, "
                "--Ms-max and the like")
            ->type_name("M");
        line.add_option(
                "--plant", options->plant,
                "flown (default), or ideal: the textbook plant with 12 states, loop by loop; "
                "the flown loop is told in both cases")
            ->type_name("NAME");
        add_cascade_options(line, options->cascade);
        add_transfer_function_options(line, *options);
        add_plot_option(line, options->plot);
        return [=, owner = &line](Context& context) {
          if (!options->vehicle.empty()) return run_vehicle(*owner, *options, context);
          refuse_options(*owner, {"--method", "--plant"}, "belongs to a vehicle, expected one");
          refuse_options(*owner, cascade_option_names(), "belongs to a vehicle, expected one");
          run(*options, given_of(*owner), context);
        };
      }};
}

}  // namespace quadtune::cli
