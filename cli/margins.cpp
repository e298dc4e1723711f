// SPDX-License-Identifier: Apache-2.0
/// quadtune margins: of a transfer function, of a gain on matrices, or of a vehicle's gains.
#include "quadtune/synthesis/margins.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <memory>
#include <optional>
#include <ostream>

#include "arguments/flight_arguments.hpp"
#include "arguments/matrix_arguments.hpp"
#include "arguments/plot_argument.hpp"
#include "arguments/plant_arguments.hpp"
#include "quadtune/workbench/design/given_gains.hpp"
#include "quadtune/workbench/design/looks_sampled.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/control/cascade_law.hpp"
#include "quadtune/discretize/delay.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/matrix_checks.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"
#include "quadtune/workbench/flown/flying_loop.hpp"
#include "report/loops/cascade_report.hpp"
#include "report/loops/flown_report.hpp"
#include "report/loops/margins_report.hpp"
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

/// A loop with the names of its channels.
struct NamedLoop {
  OpenLoop loop;
  std::vector<std::string> names;
  std::string taken_as = {};    ///< what matrices were taken for, where nothing declared it
  std::string controller = {};  ///< of a vehicle's loop: FlightOptions::controller
};

/// What A and B are, as `lqr` asks it.
enum class Kind { continuous, discrete, sampled };

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

/// Whole samples: of a discrete loop nothing between them is known.
int delay_in_samples(double delay, double dt) {
  const double samples = delay / dt;
  if (std::abs(samples - std::round(samples)) > 1e-9 * std::max(1.0, samples))
    throw UsageError(fmt::format("quadtune margins: --delay is {} s, expected a whole number of "
                                 "samples of {} s because the loop is discrete",
                                 number(delay), number(dt)),
                     "--delay");
  constexpr double kMost = 2000;
  if (samples > kMost)
    throw UsageError(fmt::format("quadtune margins: --delay is {} samples, expected at most {}",
                                 number(samples), kMost),
                     "--delay");
  return static_cast<int>(std::round(samples));
}

NamedLoop transfer_function_loop(const Options& options, bool discrete) {
  const Eigen::VectorXd num = coefficients(options.num, "margins", "--num");
  const Eigen::VectorXd den = coefficients(options.den, "margins", "--den");
  if (discrete) {
    const DiscreteTransferFunction g{num, den, options.dt,
                                     delay_in_samples(options.delay, options.dt)};
    validate(g, "--num, --den");
    return {OpenLoop(g), {}};
  }
  const ContinuousTransferFunction g{num, den, options.delay};
  validate(g, "--num, --den");
  return {OpenLoop(g), {}};
}

DiscreteLti delayed(DiscreteLti loop, double delay) {
  if (delay == 0) return loop;
  const double exact = delay_in_samples(delay, loop.dt) * loop.dt;
  return with_delays(loop, {Eigen::VectorXd::Constant(loop.B.cols(), exact), {}});
}

/// The loop K (λI - A)⁻¹ B, or (λI - A)⁻¹ B K.
template <class Lti>
Lti cut(const Lti& plant, const Eigen::MatrixXd& K, bool at_states) {
  Lti loop = plant;
  if (at_states)
    loop.B = (plant.B * K).eval();
  else
    loop.C = K;
  return loop;
}

/// Declared, or by --dt alone.
Kind kind_of(const Options& options, bool has_dt, bool has_sampled) {
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
    return Kind::sampled;
  }
  return has_dt ? Kind::discrete : Kind::continuous;
}

bool is_stable(const Eigen::MatrixXd& closed, bool discrete) {
  const Eigen::VectorXcd poles = closed.eigenvalues();
  return discrete ? poles.cwiseAbs().maxCoeff() < 1 : poles.real().maxCoeff() < 0;
}

/// Of matrices that nobody declared: what they are taken for, with a warning where that looks wrong
/// because the loop is stable only when they are the other kind.
std::string taken_as(const ContinuousLti& plant, const Eigen::MatrixXd& K, bool discrete) {
  const Eigen::MatrixXd closed = plant.A - plant.B * K;
  const bool looks_wrong = !is_stable(closed, discrete) && is_stable(closed, !discrete);
  if (!discrete)
    return looks_wrong ? "warning: A and B are taken as continuous, but A - B K is stable only if "
                         "they are discrete: --discrete --dt T takes them so"
                       : "";
  const std::string taken = "A and B are taken as discrete because of --dt";
  if (const std::string why = why_not_sampled(plant.A); !looks_wrong && !why.empty())
    return fmt::format(
        "warning: {}, but A {}, which no plant that is sampled without delays has: --sampled DT "
        "takes them as continuous, --discrete says that they are discrete",
        taken, why);
  return looks_wrong
             ? "warning: " + taken +
                   ", but A - B K is stable only if they are continuous: --sampled DT takes "
                   "them so, with the input held"
             : "note: " + taken +
                   "; --discrete says so, --sampled DT takes them as continuous, with the "
                   "input held";
}

NamedLoop matrix_loop(const Options& options, Kind kind, std::istream& in) {
  const Eigen::MatrixXd A = require_matrix(options.A, in, "margins", "--A");
  const Eigen::MatrixXd B = require_matrix(options.B, in, "margins", "--B");
  const Eigen::MatrixXd K = require_matrix(options.K, in, "margins", "--K");
  require_shape(K, B.cols(), A.rows(), "--K", "K", "one row per input, one column per state");
  require_finite(K, "--K", "K");
  const bool at_states = cut_at_states(options);
  const std::vector<std::string> names =
      at_states ? numbered("x", A.rows()) : numbered("u", B.cols());
  const ContinuousLti plant{A, B, {}, {}, {}, {}, {}};
  validate(plant, "--A, --B");
  const bool declared = options.continuous || options.discrete || kind == Kind::sampled;
  const std::string taken = declared ? "" : taken_as(plant, K, kind == Kind::discrete);
  if (kind == Kind::continuous)
    return {OpenLoop(cut(plant, K, at_states), options.delay), names, taken};
  const DiscreteLti discrete = kind == Kind::sampled
                                   ? discretize_zoh(plant, options.sampled)
                                   : DiscreteLti{A, B, {}, {}, options.dt, {}, {}, {}};
  return {OpenLoop(delayed(cut(discrete, K, at_states), options.delay)), names, taken};
}

NamedLoop vehicle_loop(const Options& options) {
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
  const Vehicle vehicle = load_vehicle(options.vehicle);
  const GivenLaws given = read_given_laws(options.gains);
  require_vehicle(given.laws, vehicle, options.gains);
  if (!given.laws.gains) {
    const CascadeDesign& cascade = *given.laws.cascade;
    const DiscreteLti law = cascade_law(cascade.gains, cascade.method);
    const DiscreteLti plant = cascade_plant(without_lag(vehicle), cascade, options.gains);
    return {OpenLoop(delayed(cut_at_inputs(plant, law), options.delay)),
            names_or_numbers(law.outputs, std::ssize(law.outputs)), "", "cascaded-pid"};
  }
  const Gains& gains = *given.laws.gains;
  if (!(gains.dt > 0))
    throw InvalidInput(options.gains,
                       "the gains have no sample period; expected one because the "
                       "flown loop is sampled");
  const VerifyModel model = model_of(vehicle, gains);
  return {OpenLoop(delayed(open_loop(model.plant, gains), options.delay)),
          names_or_numbers(gains.inputs, std::ssize(gains.inputs)), "", "state-feedback"};
}

/// The flown loop of a vehicle: with the rotors' lag, the sensors and the estimator.
FlownLoop flown_vehicle_loop(const Options& options, const std::string& controller) {
  FlightOptions flight;
  flight.vehicle = options.vehicle;
  flight.gains = options.gains;
  flight.controller = controller;
  flight.estimator = options.estimator;
  flight.sensors = options.sensors;
  FlownLoopOptions at;
  at.height = options.height;
  at.command_delay = options.delay;
  const PlannedFlight plan = plan_of_command(flight, "margins");
  const double most = kMostDelayPeriods * control_period(plan.setup);
  if (options.delay > most * (1 + 1e-9))
    throw UsageError(fmt::format("quadtune margins: --delay is {} s, expected at most {} s, {} "
                                 "samples, because each delayed sample is a state of the loop",
                                 number(options.delay), number(most), kMostDelayPeriods),
                     "--delay");
  return flown_loop(plan, at);
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

/// @param flown_option  the first option given of those for the flown loop; or empty
void require_flown(const Options& options, const std::string& flown_option) {
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
  const NamedLoop named =
      !options.vehicle.empty() ? vehicle_loop(options)
      : matrices ? matrix_loop(options, kind_of(options, has_dt, has_sampled), context.in)
                 : transfer_function_loop(options, has_dt);
  const MarginsReport ideal = margins_report(named.loop, named.names);
  std::optional<FlownLoop> flown;
  if (!options.vehicle.empty() && options.plant == "flown")
    flown = flown_vehicle_loop(options, named.controller);
  const MarginsReport& report = flown ? flown->margins : ideal;
  draw(
      options.plot, [&] { return margins_figure(figure_title(options), named.loop, ideal); },
      context);
  if (context.json) {
    internal::Json json = to_json(report);
    json["time"] = named.loop.discrete() ? "discrete" : "continuous";
    json["dt"] = named.loop.discrete() ? internal::Json(named.loop.dt()) : internal::Json();
    if (!options.vehicle.empty()) json["plant"] = options.plant;
    if (flown) {
      json["flown"] = to_json(*flown);
      json["ideal"] = to_json(ideal);
    }
    context.out << internal::readable(json) << "\n";
  } else {
    context.out << section(
        "loop", named.loop.discrete() ? fmt::format("discrete, every {} s", number(named.loop.dt()))
                                      : "continuous");
    if (flown) context.out << section("flown loop", to_text(*flown));
    context.out << section(flown ? "margins of the flown loop" : "margins", to_text(report));
    if (flown) context.out << section("margins of the ideal plant", to_text(ideal));
  }
  if (!named.taken_as.empty()) context.note("margins: " + named.taken_as);
  if (flown)
    for (const std::string& note : flown_notes(*flown)) context.note("margins: note: " + note);
  for (const std::string& note : margin_notes(report)) context.note("margins: note: " + note);
  for (const std::string& warning : margin_warnings(report))
    context.note("margins: warning: " + warning);
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
        line.add_option("--num", options->num, "numerator, descending powers")->type_name("LIST");
        line.add_option("--den", options->den, "denominator, descending powers")->type_name("LIST");
        line.add_option("--A", options->A, "dynamics (nx x nx)")->type_name("FILE");
        line.add_option("--B", options->B, "inputs (nx x nu)")->type_name("FILE");
        line.add_option("--K", options->K, "gain of u = -K x (nu x nx)")->type_name("FILE");
        line.add_option("--cut", options->cut,
                        "with matrices: where the loop is cut, inputs (default) or states")
            ->type_name("PLACE");
        line.add_flag("--continuous", options->continuous, "A and B are continuous (default)");
        line.add_flag("--discrete", options->discrete, "A and B are discrete, with --dt");
        Option* sampled = line.add_number("--sampled", options->sampled,
                                          "continuous A and B with the input held for DT seconds")
                              ->type_name("DT");
        Option* dt = line.add_number("--dt", options->dt,
                                     "sample period [s]: the coefficients are of z, the matrices "
                                     "discrete")
                         ->type_name("T");
        line.add_number("--delay", options->delay,
                        "delay in the loop [s]; whole samples of a discrete one")
            ->type_name("S");
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
        std::vector<const Option*> of_flown;
        for (const char* name : {"--estimator", "--sensors", "--height", "--plant"})
          of_flown.push_back(line.find(name));
        add_plot_option(line, options->plot);
        return [options, dt, sampled, of_flown](Context& context) {
          std::string came;
          for (const Option* option : of_flown)
            if (came.empty() && option->was_given()) came = option->name();
          require_flown(*options, came);
          run(*options, dt->was_given(), sampled->was_given(), context);
        };
      }};
}

}  // namespace quadtune::cli
