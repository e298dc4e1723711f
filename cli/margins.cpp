// SPDX-License-Identifier: Apache-2.0
/// quadtune margins: margins of a transfer function, of a gain with matrices, or of a vehicle's
/// gains.
#include <fmt/format.h>

#include <optional>

#include "arguments/flight_arguments.hpp"
#include "arguments/loop_arguments.hpp"
#include "arguments/matrix_arguments.hpp"
#include "arguments/plant_arguments.hpp"
#include "arguments/plot_argument.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/matrix_checks.hpp"
#include "quadtune/workbench/design/named_loop.hpp"
#include "quadtune/workbench/flown/plant_word.hpp"
#include "quadtune/workbench/systems/matrix_loop.hpp"
#include "report/loops/loops.hpp"
#include "report/loops/matrix_loops.hpp"
#include "report/plots/loop_figure.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  FlightOptions flight;  ///< of the flown loop: vehicle, gains, estimator and sensors
  FlownLoopOptions at;
  std::string num, den, A, B, C, D, K, cut = "inputs", plant = "flown";
  std::string frd, measured = "loop";
  ControllerArguments controller;
  TimeArguments time;  ///< of the matrices
  std::optional<double> dt;
  double delay = 0, skew = 0;
  PlotArgument plot;

  [[nodiscard]] bool has_vehicle() const { return !flight.vehicle.empty(); }
  [[nodiscard]] bool has_fraction() const { return !num.empty() || !den.empty(); }
  [[nodiscard]] bool has_matrices() const {
    return !A.empty() || !B.empty() || !C.empty() || !D.empty() || !K.empty();
  }
};

/// Whether the loop is cut at the states, or with outputs instead of a gain at the outputs.
bool cut_at_end(const Options& options) {
  const bool has_outputs = options.K.empty();
  if (options.cut == "inputs") return false;
  if (!options.has_vehicle() && options.cut == (has_outputs ? "outputs" : "states")) return true;
  if (options.has_vehicle())
    refuse("--cut", "--cut is '{}', expected inputs, the only place with a vehicle", options.cut);
  refuse("--cut", "--cut is '{}', expected inputs or {}", options.cut,
         has_outputs ? "outputs" : "states");
}

/// The plant of a transfer function with a controller as matrices; its delay is one of the loop.
NamedLoop loop_with_controller(const Options& options, const LoopController& controller) {
  const Eigen::VectorXd num = coefficients(options.num, "--num");
  const Eigen::VectorXd den = coefficients(options.den, "--den");
  MatrixLoopOptions loop;
  loop.delay = options.delay;
  loop.at_outputs = cut_at_end(options);
  if (!options.dt) {
    const ContinuousTransferFunction g{num, den, 0};
    validate(g, "--num, --den");
    return matrix_loop(realize(g), controller, loop);
  }
  const DiscreteTransferFunction g{num, den, *options.dt, 0};
  validate(g, "--num, --den");
  const DiscreteLti plant = realize(g);
  loop.time = MatrixTime::discrete;
  loop.dt = *options.dt;
  return matrix_loop({plant.A, plant.B, plant.C, plant.D, {}, {}, {}}, controller, loop);
}

NamedLoop transfer_function_loop(const Options& options, std::istream& in) {
  if (const auto controller = controller_of(options.controller, in))
    return loop_with_controller(options, *controller);
  const Eigen::VectorXd num = coefficients(options.num, "--num");
  const Eigen::VectorXd den = coefficients(options.den, "--den");
  if (options.dt) {
    const DiscreteTransferFunction g{num, den, *options.dt,
                                     whole_samples(options.delay, *options.dt)};
    validate(g, "--num, --den");
    return {OpenLoop(g)};
  }
  const ContinuousTransferFunction g{num, den, options.delay};
  validate(g, "--num, --den");
  return {OpenLoop(g)};
}

/// How the matrices are to be read, as declared by an option or implied by --dt.
MatrixTime time_of(const TimeArguments& time, const std::optional<double>& dt) {
  require_one_time(time);
  if (time.discrete && !dt)
    refuse("--dt", "--dt is missing, expected the sample period with --discrete");
  if (dt && (time.continuous || time.sampled))
    refuse("--dt",
           "--dt cannot be combined with {}; use --sampled DT for continuous A and B whose input "
           "is held, or --discrete for discrete A and B",
           time.continuous ? "--continuous" : "--sampled");
  if (time.sampled) require_positive(*time.sampled, "--sampled");
  return time.sampled ? MatrixTime::sampled : dt ? MatrixTime::discrete : MatrixTime::continuous;
}

/// The loop A, B, C, D, or the plant of these matrices with a controller.
NamedLoop output_loop(const Options& options, std::istream& in) {
  MatrixLoopOptions loop;
  loop.time = time_of(options.time, options.dt);
  loop.dt = options.time.sampled.value_or(options.dt.value_or(0));
  loop.delay = options.delay;
  loop.at_outputs = cut_at_end(options);
  ContinuousLti plant;
  plant.A = require_matrix(options.A, in, "--A");
  plant.B = require_matrix(options.B, in, "--B");
  if (options.C.empty())
    refuse("--K", "--K or --C is missing, expected a matrix file for one of them");
  plant.C = require_matrix(options.C, in, "--C");
  plant.D = read_matrix(options.D, in, "--D");
  validate(plant, "--A, --B, --C, --D");
  return matrix_loop(plant, controller_of(options.controller, in), loop);
}

NamedLoop gain_matrix_loop(const Options& options, std::istream& in) {
  if (!options.C.empty() || !options.D.empty())
    refuse("--C",
           "--C and --D cannot be combined with --K, which is a gain on the states; a gain on the "
           "outputs is --controller-D");
  if (options.controller.given())
    refuse("--K", "--K cannot be combined with a controller, expected only one of the two");
  GainLoopOptions gain;
  gain.time = time_of(options.time, options.dt);
  gain.dt = options.time.sampled.value_or(options.dt.value_or(0));
  gain.declared = options.time.count() > 0;
  gain.delay = options.delay;
  const Eigen::MatrixXd A = require_matrix(options.A, in, "--A");
  const Eigen::MatrixXd B = require_matrix(options.B, in, "--B");
  const Eigen::MatrixXd K = require_matrix(options.K, in, "--K");
  require_shape(K, B.cols(), A.rows(), "--K", "K", "one row per input, one column per state");
  require_finite(K, "--K", "K");
  gain.at_states = cut_at_end(options);
  const ContinuousLti plant{A, B, {}, {}, {}, {}, {}};
  validate(plant, "--A, --B");
  return gain_loop(plant, K, gain);
}

/// Margins of frequency response data.
void run_data(const Options& options, Context& context) {
  if (!options.plot.file.empty())
    refuse("--plot", "--plot requires a model of the loop, and --frd gives none");
  const FrequencyDataReport report =
      frequency_data_report(read_frequency_data(options.frd), measured_response(options.measured),
                            controller_of(options.controller, context.in), options.dt.value_or(0),
                            options.delay, options.skew);
  context.print([&] { return to_json(report); }, [&] { return to_text(report); });
  context.notes("note: ", report.notes);
  context.notes("warning: ", margin_warnings(report.margins));
}

LoopReport vehicle_loop(const Options& options) {
  if (options.flight.gains.empty())
    refuse(
        "--gains",
        "--gains is missing, expected the gains of the vehicle: a file or an export's directory");
  (void)cut_at_end(options);
  FlownLoopOptions at = options.at;
  at.command_delay = options.delay;
  return loop_report(options.flight, at, options.plant == "flown");
}

/// Requires exactly one of the ways to define a loop, and no option of the others.
void require_one_loop(const Options& options, const CommandLine& line) {
  std::vector<std::string> given;
  if (options.has_fraction()) given.emplace_back("a transfer function");
  if (options.has_matrices()) given.emplace_back("matrices");
  if (!options.frd.empty()) given.emplace_back("--frd");
  if (options.has_vehicle())
    given.push_back("the vehicle '" + internal::printable(options.flight.vehicle) + "'");
  if (given.size() != 1)
    refuse("V",
           "{}expected one of these loops: --num and --den; --A, --B and --K; --A, --B and --C; "
           "--frd; "
           "a vehicle with --gains",
           given.empty() ? "" : internal::joined(given, " and ") + " were given, ");
  if (options.has_vehicle() && options.controller.given())
    refuse("V",
           "a vehicle cannot be combined with a controller, because its gains are "
           "the controller; expected --gains");
  if (options.has_vehicle() && options.plant == "flown" && line.was_given("--skew"))
    refuse("--skew", "--skew does not apply to the flown loop; expected --plant ideal");
  if (options.frd.empty() && line.was_given("--measured"))
    refuse("--measured", "--measured requires --frd");
  if (line.was_given("--integrator") && options.controller.pid.empty())
    refuse("--integrator", "--integrator requires --pid");
  if (line.was_given("--integrator") && !options.dt && !options.time.sampled)
    refuse("--integrator",
           "--integrator requires a discrete loop, expected --dt or --sampled with it");
  const bool plain = options.has_fraction() && !options.controller.given();
  if ((plain || !options.frd.empty()) && line.was_given("--cut"))
    refuse("--cut", "--cut requires {}",
           plain ? "matrices or a controller" : "a model of the loop");
  if (!options.frd.empty() && options.dt && !options.controller.given())
    refuse("--dt", "--dt with --frd is the period of a controller, expected --pid or another one");
  if (!options.flight.gains.empty() && !options.has_vehicle())
    refuse("--gains", "--gains requires a vehicle; expected `margins V --gains FILE`");
}

/// The title of the picture: the loop as the command line defines it.
std::string figure_title(const Options& options) {
  if (options.has_matrices() && options.K.empty())
    return fmt::format("Loop of A {}, B {}, C {}{}", options.A, options.B, options.C,
                       options.controller.given() ? " with its controller" : "");
  const std::string what =
      options.has_vehicle()    ? fmt::format("{} with the gains {}, ideal plant",
                                             options.flight.vehicle, options.flight.gains)
      : options.has_matrices() ? fmt::format("A {}, B {}, K {}", options.A, options.B, options.K)
                               : fmt::format("num {}, den {}", options.num, options.den);
  const double dt = options.dt.value_or(options.time.sampled.value_or(0));
  return "Loop of " + what + (dt > 0 ? fmt::format(", sampled every {} s", number(dt)) : "") +
         (options.delay > 0 ? fmt::format(", delay {} s", number(options.delay)) : "");
}

void require_flown(const Options& options, const CommandLine& line) {
  std::string flown_option;  // the first that was given
  for (const char* name : {"--estimator", "--sensors", "--height", "--plant"})
    if (flown_option.empty() && line.was_given(name)) flown_option = name;
  (void)asks_for_flown_plant(options.plant);
  require_positive(options.at.height, "--height", "metres");
  if (flown_option.empty()) return;
  if (!options.has_vehicle())
    refuse(flown_option, "{} requires a vehicle; expected `margins V --gains FILE`", flown_option);
  if (options.plant == "ideal" && flown_option != "--plant")
    refuse(flown_option, "{} applies to the flown loop and cannot be combined with --plant ideal",
           flown_option);
}

void require_sane(const Options& options, const CommandLine& line) {
  require_flown(options, line);
  require_one_loop(options, line);
  require_picture(options.plot);
  require_not_negative(options.delay, "--delay");
  if (options.dt) require_positive(*options.dt, "--dt");
  if (options.dt && options.has_vehicle())
    refuse("--dt",
           "--dt applies to a transfer function or to matrices only, because the gains of a "
           "vehicle have their own period");
  if (!options.has_matrices() && options.time.count() > 0)
    refuse(options.time.sampled      ? "--sampled"
           : options.time.continuous ? "--continuous"
                                     : "--discrete",
           "--continuous, --discrete and --sampled apply to matrices only");
}

LoopReport report_of(const Options& options, std::istream& in) {
  if (options.has_vehicle()) return vehicle_loop(options);
  if (!options.has_matrices()) return loop_report(transfer_function_loop(options, in));
  return loop_report(options.K.empty() ? output_loop(options, in) : gain_matrix_loop(options, in));
}

void run_margins(const CommandLine& line, const Options& options, Context& context) {
  require_sane(options, line);
  if (!options.frd.empty()) {
    run_data(options, context);
    return;
  }
  LoopReport report = report_of(options, context.in);
  if (options.skew != 0) set_skew(report.ideal, report.loop.loop, options.skew);
  draw(
      options.plot,
      [&] { return margins_figure(figure_title(options), report.loop.loop, report.ideal); },
      context);
  context.print(
      [&] {
        internal::Json json = to_json(report);
        json["skew"] = options.skew;
        return json;
      },
      [&] {
        return to_text(report) +
               (options.has_vehicle() ? "" : section("peaks", peaks_text(report.ideal)));
      });
  if (!report.loop.taken_as.empty()) context.note(report.loop.taken_as);
  if (report.flown) context.notes("note: ", flown_notes(*report.flown));
  context.notes("note: ", margin_notes(report.margins()));
  context.notes("warning: ", margin_warnings(report.margins()));
}

/// Adds the options of a transfer function and of matrices.
void add_loop_options(CommandLine& line, Options& options) {
  line.add_option("--num LIST", options.num, "numerator, descending powers");
  line.add_option("--den LIST", options.den, "denominator, descending powers");
  line.add_option("--A FILE", options.A, "dynamics (nx x nx)");
  line.add_option("--B FILE", options.B, "inputs (nx x nu)");
  line.add_option("--K FILE", options.K, "gain of u = -K x (nu x nx)");
  line.add_option(
      "--C FILE", options.C,
      "outputs (ny x nx); in place of K, so that A, B, C, D are the loop or, with a controller, "
      "the plant");
  line.add_option("--D FILE", options.D, "feed-through (ny x nu); default: 0");
  add_controller_options(line, options.controller);
  line.add_option("--frd FILE", options.frd,
                  "measured frequency response: a text with the columns w or f, and re and im, or "
                  "mag or mag_db and phase_deg or phase_rad");
  line.add_option("--measured WHAT", options.measured,
                  "with --frd: loop (default), T (set point to output) or S (disturbance at the "
                  "output to output); with a controller, loop means the plant");
  line.add_option("--cut PLACE", options.cut,
                  "with matrices: where the loop is cut, inputs (default), or states with --K, "
                  "outputs with --C");
  line.add_number("--skew S", options.skew,
                  "skew of the disk margins: 0 (default) balances S and T, 1 is that of S, -1 that "
                  "of T");
  line.add_flag("--continuous", options.time.continuous, "A and B are continuous (default)");
  line.add_flag("--discrete", options.time.discrete, "A and B are discrete, with --dt");
  line.add_number("--sampled DT", options.time.sampled,
                  "continuous A and B with the input held for DT [s]");
  line.add_number("--dt T", options.dt,
                  "sample period [s]: the coefficients are those of z, the matrices are discrete");
  line.add_number("--delay S", options.delay,
                  "delay in the loop [s]; a whole number of samples if the loop is discrete");
}

void add_options(CommandLine& line, Options& options) {
  line.add_option("V", options.flight.vehicle, "built-in vehicle or vehicle file");
  line.add_option("--gains FILE", options.flight.gains,
                  "with V: an export, a file of gains or a design file");
  add_loop_options(line, options);
  line.add_option("--plant NAME", options.plant,
                  "with V: flown (default) includes motor lag, sample times and delays of the "
                  "sensors, and estimator; ideal is the textbook plant with 12 states");
  line.add_option("--estimator NAME", options.flight.estimator,
                  "with V: as for `quadtune fly`; default: one that the sensors allow");
  line.add_option("--sensors NAME", options.flight.sensors, "with V: real (default) or ideal");
  line.add_number("--height M", options.at.height, "with V: height of the hover [m], default 1.1");
  add_plot_option(line, options.plot);
}

}  // namespace

Verb margins_verb() {
  return {"margins",
          "--num LIST --den LIST [--delay S]   or   --A FILE --B FILE (--K FILE | --C FILE) "
          "[--discrete --dt T | --sampled DT]   or   --frd FILE   or   V --gains FILE [--plant "
          "ideal]",
          "gain, phase, delay and disk margins of a loop under negative feedback",
          "quadtune margins --num 25 --den 1,10,10,10", with_options(add_options, run_margins)};
}

}  // namespace quadtune::cli
