// SPDX-License-Identifier: Apache-2.0
/// quadtune margins: of a transfer function, of a gain on matrices, or of a vehicle's gains.
#include <fmt/format.h>

#include <memory>
#include <ostream>

#include "arguments/flight_arguments.hpp"
#include "arguments/matrix_arguments.hpp"
#include "arguments/plant_arguments.hpp"
#include "arguments/plot_argument.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/matrix_checks.hpp"
#include "quadtune/workbench/design/named_loop.hpp"
#include "report/loops/loop_report.hpp"
#include "report/plots/loop_figure.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string vehicle, gains, num, den, A, B, K;
  std::string cut = "inputs";
  bool continuous = false;
  bool discrete = false;
  double sampled = 0;
  double dt = 0;
  double delay = 0;
  std::string plant = "flown", estimator, sensors;
  double height = FlownLoopOptions().height;
  PlotArgument plot;
};

bool cut_at_states(const Options& options) {
  if (options.cut == "inputs") return false;
  if (options.cut == "states") return true;
  throw UsageError(
      fmt::format("quadtune margins: --cut is '{}', expected inputs or states", options.cut),
      "--cut");
}

void require_delay(double delay) {
  if (delay < 0)
    throw UsageError(
        fmt::format("quadtune margins: --delay is {} s, expected 0 or more", number(delay)),
        "--delay");
}

NamedLoop transfer_function_loop(const Options& options, bool discrete) {
  const Eigen::VectorXd num = coefficients(options.num, "margins", "--num");
  const Eigen::VectorXd den = coefficients(options.den, "margins", "--den");
  if (discrete) {
    const DiscreteTransferFunction g{num, den, options.dt,
                                     whole_samples(options.delay, options.dt)};
    validate(g, "--num, --den");
    return {OpenLoop(g)};
  }
  const ContinuousTransferFunction g{num, den, options.delay};
  validate(g, "--num, --den");
  return {OpenLoop(g)};
}

/// Declared, or by --dt alone.
MatrixTime time_of(const Options& options, bool has_dt, bool has_sampled) {
  const auto refuse = [](const std::string& what, const std::string& option) {
    throw UsageError("quadtune margins: " + what, option);
  };
  if (static_cast<int>(options.continuous) + static_cast<int>(options.discrete) +
          static_cast<int>(has_sampled) >
      1)
    refuse("more than one of --continuous, --discrete and --sampled came, expected one",
           has_sampled ? "--sampled" : "--discrete");
  if (options.discrete && !has_dt)
    refuse("--dt is missing, expected the sample period with --discrete", "--dt");
  if (has_dt && (options.continuous || has_sampled))
    refuse(
        fmt::format("--dt came with {}, expected --sampled DT for continuous A and B whose input "
                    "is held, or --discrete for A and B that are discrete",
                    options.continuous ? "--continuous" : "--sampled"),
        "--dt");
  if (has_sampled) {
    require_positive(options.sampled, "margins", "--sampled");
    return MatrixTime::sampled;
  }
  return has_dt ? MatrixTime::discrete : MatrixTime::continuous;
}

NamedLoop matrix_loop(const Options& options, MatrixTime time, std::istream& in) {
  const Eigen::MatrixXd A = require_matrix(options.A, in, "margins", "--A");
  const Eigen::MatrixXd B = require_matrix(options.B, in, "margins", "--B");
  const Eigen::MatrixXd K = require_matrix(options.K, in, "margins", "--K");
  require_shape(K, B.cols(), A.rows(), "--K", "K", "one row per input, one column per state");
  require_finite(K, "--K", "K");
  GainLoopOptions gain;
  gain.time = time;
  gain.dt = time == MatrixTime::sampled ? options.sampled : options.dt;
  gain.declared = options.continuous || options.discrete || time == MatrixTime::sampled;
  gain.at_states = cut_at_states(options);
  gain.delay = options.delay;
  const ContinuousLti plant{A, B, {}, {}, {}, {}, {}};
  validate(plant, "--A, --B");
  return gain_loop(plant, K, gain);
}

LoopReport vehicle_loop(const Options& options) {
  if (options.gains.empty())
    throw UsageError(
        "quadtune margins: --gains is missing, expected the gains of the vehicle: a "
        "file or the directory of an export",
        "--gains");
  if (cut_at_states(options))
    throw UsageError(
        "quadtune margins: --cut states belongs to matrices, expected inputs with a "
        "vehicle",
        "--cut");
  FlightOptions flight;
  flight.vehicle = options.vehicle;
  flight.gains = options.gains;
  flight.estimator = options.estimator;
  flight.sensors = options.sensors;
  FlownLoopOptions at;
  at.height = options.height;
  at.command_delay = options.delay;
  return loop_report(flight, at, options.plant == "flown");
}

/// Exactly one of the three ways to name a loop.
void require_one_loop(const Options& options) {
  const bool fraction = !options.num.empty() || !options.den.empty();
  const bool matrices = !options.A.empty() || !options.B.empty() || !options.K.empty();
  const bool vehicle = !options.vehicle.empty();
  if (static_cast<int>(fraction) + static_cast<int>(matrices) + static_cast<int>(vehicle) != 1)
    throw UsageError(
        "quadtune margins: expected one of --num and --den, or --A, --B and --K, or a "
        "vehicle with --gains",
        "V");
  if (!options.gains.empty() && !vehicle)
    throw UsageError(
        "quadtune margins: --gains requires a vehicle; expected `margins V --gains FILE`",
        "--gains");
}

/// What the picture is of, as it was asked for.
std::string figure_title(const Options& options) {
  const std::string what =
      !options.vehicle.empty()
          ? fmt::format("{} with the gains {}, ideal plant", options.vehicle, options.gains)
      : !options.num.empty() ? fmt::format("num {}, den {}", options.num, options.den)
                             : fmt::format("A {}, B {}, K {}", options.A, options.B, options.K);
  return "Loop of " + what +
         (options.dt > 0        ? fmt::format(", sampled every {} s", number(options.dt))
          : options.sampled > 0 ? fmt::format(", sampled every {} s", number(options.sampled))
                                : "") +
         (options.delay > 0 ? fmt::format(", delay {} s", number(options.delay)) : "");
}

void require_flown(const Options& options, const CommandLine& line) {
  std::string flown_option;  // the first that came
  for (const char* name : {"--estimator", "--sensors", "--height", "--plant"})
    if (flown_option.empty() && line.was_given(name)) flown_option = name;
  (void)asks_for_flown_plant(options.plant, "margins");
  require_positive(options.height, "margins", "--height", "metres");
  if (flown_option.empty()) return;
  if (options.vehicle.empty())
    throw UsageError(
        fmt::format("quadtune margins: {} requires a vehicle; expected `margins V --gains FILE`",
                    flown_option),
        flown_option);
  if (options.plant == "ideal" && flown_option != "--plant")
    throw UsageError(fmt::format("quadtune margins: {} applies to the flown loop and cannot be "
                                 "combined with --plant ideal",
                                 flown_option),
                     flown_option);
}

void tell(const LoopReport& report, const Context& context) {
  const auto note = [&](const std::string& text) { context.note("margins: " + text); };
  if (!report.loop.taken_as.empty()) note(report.loop.taken_as);
  if (report.flown)
    for (const std::string& text : flown_notes(*report.flown)) note("note: " + text);
  for (const std::string& text : margin_notes(report.margins())) note("note: " + text);
  for (const std::string& text : margin_warnings(report.margins())) note("warning: " + text);
}

void run(const Options& options, bool has_dt, bool has_sampled, Context& context) {
  require_one_loop(options);
  require_picture(options.plot, "margins");
  require_delay(options.delay);
  const bool matrices = !options.A.empty() || !options.B.empty() || !options.K.empty();
  if (has_dt) require_positive(options.dt, "margins", "--dt");
  if (has_dt && !options.vehicle.empty())
    throw UsageError(
        "quadtune margins: --dt belongs to a transfer function or matrices, expected "
        "none because the gains have their own",
        "--dt");
  if (!matrices && (options.continuous || options.discrete || has_sampled))
    throw UsageError(
        "quadtune margins: --continuous, --discrete and --sampled belong to matrices, expected "
        "none "
        "of them",
        has_sampled          ? "--sampled"
        : options.continuous ? "--continuous"
                             : "--discrete");
  const LoopReport report = option_of_command("margins", [&] {
    if (!options.vehicle.empty()) return vehicle_loop(options);
    return loop_report(matrices
                           ? matrix_loop(options, time_of(options, has_dt, has_sampled), context.in)
                           : transfer_function_loop(options, has_dt));
  });
  draw(
      options.plot,
      [&] { return margins_figure(figure_title(options), report.loop.loop, report.ideal); },
      context);
  context.out << (context.json ? internal::readable(to_json(report)) + "\n" : to_text(report));
  tell(report, context);
}

/// Of a transfer function or of matrices.
void add_loop_options(CommandLine& line, Options& options) {
  line.add_option("--num", options.num, "numerator, descending powers")->type_name("LIST");
  line.add_option("--den", options.den, "denominator, descending powers")->type_name("LIST");
  line.add_option("--A", options.A, "dynamics (nx x nx)")->type_name("FILE");
  line.add_option("--B", options.B, "inputs (nx x nu)")->type_name("FILE");
  line.add_option("--K", options.K, "gain of u = -K x (nu x nx)")->type_name("FILE");
  line.add_option("--cut", options.cut,
                  "with matrices: where the loop is cut, inputs (default) or states")
      ->type_name("PLACE");
  line.add_flag("--continuous", options.continuous, "A and B are continuous (default)");
  line.add_flag("--discrete", options.discrete, "A and B are discrete, with --dt");
  line.add_number("--sampled", options.sampled,
                  "continuous A and B with the input held for DT seconds")
      ->type_name("DT");
  line.add_number("--dt", options.dt,
                  "sample period [s]: the coefficients are of z, the matrices "
                  "discrete")
      ->type_name("T");
  line.add_number("--delay", options.delay,
                  "delay in the loop [s]; whole samples of a discrete one")
      ->type_name("S");
}

}  // namespace

Verb margins_verb() {
  return {
      "margins",
      "--num LIST --den LIST [--delay S]   or   --A FILE --B FILE --K FILE [--discrete --dt T | "
      "--sampled DT]   or   V --gains FILE [--plant ideal]",
      "gain, phase, delay and disk margins of a loop under negative feedback",
      "quadtune margins --num 25 --den 1,10,10,10", [](CommandLine& line) -> Action {
        auto options = std::make_shared<Options>();
        line.add_option("V", options->vehicle, "built-in vehicle or vehicle file");
        line.add_option("--gains", options->gains,
                        "with V: an export, a file of gains or a design file")
            ->type_name("FILE");
        add_loop_options(line, *options);
        line.add_option(
                "--plant", options->plant,
                "with V: flown (default) includes the rotors' lag, the sensors' clocks and delays "
                "and the estimator; ideal is the textbook plant with 12 states")
            ->type_name("NAME");
        line.add_option("--estimator", options->estimator,
                        "with V: as for `quadtune fly`; default: what the sensors allow")
            ->type_name("NAME");
        line.add_option("--sensors", options->sensors, "with V: real (default) or ideal")
            ->type_name("NAME");
        line.add_number("--height", options->height, "with V: height of the hover [m], default 1.1")
            ->type_name("M");
        add_plot_option(line, options->plot);
        return [options, owner = &line](Context& context) {
          require_flown(*options, *owner);
          run(*options, owner->was_given("--dt"), owner->was_given("--sampled"), context);
        };
      }};
}

}  // namespace quadtune::cli
