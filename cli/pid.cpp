// SPDX-License-Identifier: Apache-2.0
/// quadtune pid: PID gains for a transfer function, by requirement, by rule, or the best within
/// bounds.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <ostream>

#include "arguments/cascade_arguments.hpp"
#include "arguments/flight_arguments.hpp"
#include "arguments/matrix_arguments.hpp"
#include "arguments/plot_argument.hpp"
#include "arguments/plant_arguments.hpp"
#include "report/gains/laws_json.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/synthesis/pid_loop.hpp"
#include "quadtune/synthesis/pid_optimum.hpp"
#include "quadtune/synthesis/pid_rules.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/flown/flown_check.hpp"
#include "quadtune/workbench/flown/flown_gains.hpp"
#include "report/loops/cascade_report.hpp"
#include "report/loops/flown_report.hpp"
#include "report/loops/margins_report.hpp"
#include "report/plots/loop_figure.hpp"
#include "report/text/print.hpp"
#include "report/gains/matrix_report.hpp"

namespace quadtune::cli {
namespace {

using internal::Json;

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
};

/// Gains, and how they were found, in words.
struct Found {
  PidGains gains;
  std::string how;
};

const std::vector<std::string> kRules = {"amigo", "simc", "ziegler-nichols", "cohen-coon",
                                         "lambda"};

PidType read_type(const std::string& word) {
  for (const PidType type : {PidType::P, PidType::PI, PidType::PD, PidType::PID})
    if (word == to_string(type)) return type;
  throw UsageError(fmt::format("quadtune pid: --type is '{}', expected P, PI, PD or PID", word),
                   "--type");
}

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

// --- three ways ----------------------------------------------------------------------------------

Found by_requirement(const ContinuousTransferFunction& plant, PidType type,
                     const Options& options) {
  require_positive(options.crossover, "pid", "--crossover", "rad/s");
  if (!(options.phase_margin > 0 && options.phase_margin < 180))
    throw UsageError(fmt::format("quadtune pid: --phase-margin is {} deg, expected more than 0 and "
                                 "less than 180",
                                 number(options.phase_margin)),
                     "--phase-margin");
  LoopRequirement requirement;
  requirement.type = type;
  requirement.crossover = options.crossover;
  requirement.phase_margin = options.phase_margin * std::numbers::pi / 180;
  requirement.Tf = options.Tf;
  const PidLoopDesign design = pid_for_crossover(plant, requirement);
  if (!design.solved())
    throw NoSolution(fmt::format("pid: {}: {}", to_string(design.status), design.culprit),
                     "--crossover");
  return {design.gains,
          fmt::format("{} for a crossover of {} rad/s and a phase margin of {} deg", options.type,
                      number(options.crossover), number(options.phase_margin))};
}

template <class Model>
Model require_fitted(const LagFit<Model>& fit) {
  if (!fit.fitted())
    throw NoSolution("pid: the rule needs a model of one lag and a delay: " + fit.culprit,
                     "--rule");
  return fit.model;
}

std::string model_text(const FopdtModel& model) {
  return fmt::format("{} e^(-{} s)/({} s + 1)", number(model.gain), number(model.delay),
                     number(model.time_constant));
}

/// SIMC keeps a second lag for its PID, as its half rule gives it.
Found by_simc(const ContinuousTransferFunction& plant, PidType type, double tau_c, bool has_tau_c) {
  if (type == PidType::PID) {
    const SopdtModel model = require_fitted(half_rule_sopdt(plant));
    const double used = has_tau_c ? tau_c : model.delay;
    return {simc(model, used),
            fmt::format("PID by SIMC for {} e^(-{} s)/(({} s + 1)({} s + 1)), tau_c {} s",
                        number(model.gain), number(model.delay), number(model.time_constant),
                        number(model.second), number(used))};
  }
  if (type != PidType::PI)
    throw UsageError("quadtune pid: --rule simc has PI and PID, expected one of them as --type",
                     "--type");
  const LagFit<FopdtModel> half = half_rule_fopdt(plant);
  const FopdtModel model = half.fitted() ? half.model : require_fitted(fit_fopdt(plant));
  const double used = has_tau_c ? tau_c : model.delay;
  return {simc(model, used),
          fmt::format("PI by SIMC for {}, tau_c {} s", model_text(model), number(used))};
}

Found by_rule(const ContinuousTransferFunction& plant, PidType type, const Options& options,
              bool has_tau_c) {
  if (std::find(kRules.begin(), kRules.end(), options.rule) == kRules.end())
    throw UsageError(
        fmt::format("quadtune pid: --rule is '{}', expected one of {}{}", options.rule,
                    internal::joined(kRules, ", "), internal::did_you_mean(options.rule, kRules)),
        "--rule");
  const bool takes_tau_c = options.rule == "simc" || options.rule == "lambda";
  if (has_tau_c && !takes_tau_c)
    throw UsageError("quadtune pid: --tau-c belongs to the rules simc and lambda, expected none",
                     "--tau-c");
  if (has_tau_c) require_positive(options.tau_c, "pid", "--tau-c");
  if (options.rule == "simc") return by_simc(plant, type, options.tau_c, has_tau_c);
  const FopdtModel model = require_fitted(fit_fopdt(plant));
  const double lambda = has_tau_c ? options.tau_c : std::max(model.delay, model.time_constant / 3);
  const PidGains gains = options.rule == "amigo"             ? amigo(type, model)
                         : options.rule == "ziegler-nichols" ? ziegler_nichols_step(type, model)
                         : options.rule == "cohen-coon"      ? cohen_coon(type, model)
                                                             : lambda_tuning(type, model, lambda);
  return {gains, fmt::format(
                     "{} by {} for {}{}", options.type, options.rule, model_text(model),
                     options.rule == "lambda" ? fmt::format(", lambda {} s", number(lambda)) : "")};
}

Found by_bounds(const ContinuousTransferFunction& plant, PidType type, const Options& options,
                const Given& given) {
  PidBounds bounds;
  if (given.Ms_max) bounds.Ms_max = options.Ms_max;
  if (given.Mt_max) bounds.Mt_max = options.Mt_max;
  if (given.noise_gain_max) bounds.noise_gain_max = options.noise_gain_max;
  if (type != PidType::PI && type != PidType::PID)
    throw UsageError(
        "quadtune pid: --Ms-max asks for the greatest integral gain, expected --type "
        "PI or PID",
        "--type");
  const PidOptimum optimum = greatest_integral_gain(plant, type, bounds, options.Tf);
  if (!optimum.solved())
    throw NoSolution(fmt::format("pid: {}: {}", to_string(optimum.status), optimum.culprit),
                     "--Ms-max");
  return {optimum.gains,
          fmt::format("{} of the greatest Ki; bound by {}", options.type,
                      optimum.binding.empty()
                          ? "nothing"
                          : fmt::format("{}", internal::joined(optimum.binding, ", ")))};
}

// --- what came out -------------------------------------------------------------------------------

void print(const Found& found, const MarginsReport& margins, Context& context) {
  const LoopMargins& m = margins.loops[0];
  const PidGains& g = found.gains;
  if (context.json) {
    const Json loops = to_json(margins)["loops"];
    const Json& loop = loops[0];
    context.out << internal::readable(Json{{"Kp", g.Kp},
                                           {"Ki", g.Ki},
                                           {"Kd", g.Kd},
                                           {"Tf", g.Tf},
                                           {"stable", m.stable},
                                           {"crossover", loop["crossover"]},
                                           {"phase_margin_deg", loop["phase_margin_deg"]},
                                           {"gain_margin_db", loop["gain_margin_db"]},
                                           {"Ms", loop["Ms"]},
                                           {"Mt", loop["Mt"]},
                                           {"how", found.how},
                                           {"margins", to_json(margins)}})
                << "\n";
    return;
  }
  std::string gains = fmt::format("Kp {}", number(g.Kp));
  if (g.Ki != 0) gains += fmt::format("  Ki {} 1/s", number(g.Ki));
  if (g.Kd != 0) gains += fmt::format("  Kd {} s  Tf {} s", number(g.Kd), number(g.Tf));
  context.out << section("gains", gains) << section("by", found.how)
              << section("margins", to_text(margins));
}

/// The gains and the plant in a line.
std::string figure_title(const Options& options, const PidGains& g) {
  std::string text = fmt::format("{}: Kp {}", options.type, number(g.Kp));
  if (g.Ki != 0) text += fmt::format(", Ki {} 1/s", number(g.Ki));
  if (g.Kd != 0) text += fmt::format(", Kd {} s, Tf {} s", number(g.Kd), number(g.Tf));
  text += fmt::format(" with num {}, den {}", options.num, options.den);
  return text + (options.delay > 0 ? fmt::format(", delay {} s", number(options.delay)) : "");
}

void run(const Options& options, const Given& given, Context& context) {
  require_picture(options.plot, "pid");
  const bool requirement = given.crossover || given.phase_margin;
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
  const PidType type = read_type(options.type);
  const ContinuousTransferFunction plant = read_plant(options);
  const Found found = requirement ? by_requirement(plant, type, options)
                      : rule      ? by_rule(plant, type, options, given.tau_c)
                                  : by_bounds(plant, type, options, given);
  const ContinuousTransferFunction loop = loop_of(plant, found.gains);
  if (loop.num.size() > loop.den.size())
    throw UsageError(
        "quadtune pid: the derivative of this plant has no bound, expected a filter "
        "with --Tf",
        "--Tf");
  const MarginsReport margins = margins_report(OpenLoop(loop), {});
  draw(
      options.plot,
      [&] { return pid_figure(figure_title(options, found.gains), plant, found.gains, margins); },
      context);
  print(found, margins, context);
  for (const std::string& warning : margin_warnings(margins))
    context.note("pid: warning: " + warning);
}

// --- a vehicle -----------------------------------------------------------------------------------

/// Refuses options of the other mode: taken in silence they would give other gains than were asked.
void refuse_options(const CommandLine& line, const std::vector<std::string>& names,
                    const char* why) {
  for (const std::string& name : names)
    if (line.was_given(name)) throw UsageError(fmt::format("quadtune pid: {} {}", name, why), name);
}

/// Options that only the rules of the loops take.
std::vector<std::string> loop_option_names() {
  std::vector<std::string> names = {"--Ms-max"};
  for (const std::string& name : cascade_option_names())
    if (name != "--dt") names.push_back(name);
  return names;
}

/// Whether --plant asks for the textbook plant, on which the loops are designed one by one.
bool asks_for_ideal_plant(const CommandLine& line, const Options& options) {
  if (options.plant.empty() || asks_for_flown_plant(options.plant, "pid")) return false;
  if (options.method == "flown")
    throw UsageError(
        "quadtune pid: --method flown came with --plant ideal, expected --method loops, which "
        "knows of no sensors and no estimator",
        "--method");
  refuse_options(line, {"--motor-lag"},
                 "came with --plant ideal, expected none because rotors of the textbook plant do "
                 "not lag");
  return true;
}

/// The loop that flies under a cascade, about a hover; none, with a note, where it cannot be
/// analysed.
std::optional<FlownLoop> flown_loop_of(const Vehicle& vehicle, const CascadeDesign& cascade,
                                       const std::optional<StoredEstimator>& estimator,
                                       const Context& context) {
  try {
    return flown_loop(
        hover_under(vehicle, cascade_controller(cascade, cascade.gains), estimator, ""));
  } catch (const InvalidInput& error) {
    context.note(fmt::format("pid: note: the flown loop is not analysed: {}", error.what()));
    return {};
  }
}

/// Whether all gains are designed at once on the flown plant, which is the default, or loop by
/// loop.
bool designs_on_flown_plant(const CommandLine& line, const Options& options,
                            const Vehicle& vehicle) {
  static const std::vector<std::string> kMethods = {"flown", "loops"};
  if (!options.method.empty() && options.method != "loops" && options.method != "flown")
    throw UsageError(fmt::format("quadtune pid: --method is '{}', expected flown or loops{}",
                                 internal::printable(options.method),
                                 internal::did_you_mean(options.method, kMethods)),
                     "--method");
  if (asks_for_ideal_plant(line, options) || options.method == "loops") return false;
  const std::vector<std::string> names = loop_option_names();
  if (options.method.empty())
    return usually_on_flown_plant(vehicle) &&
           std::none_of(names.begin(), names.end(),
                        [&](const std::string& name) { return line.was_given(name); });
  refuse_options(line, names, "belongs to --method loops, expected it");
  return true;
}

void run_vehicle(const CommandLine& line, const Options& options, Context& context) {
  require_picture(options.plot, "pid");
  refuse_options(line,
                 {"--num", "--den", "--delay", "--type", "--crossover", "--phase-margin", "--Tf",
                  "--rule", "--tau-c", "--Mt-max", "--noise-gain-max"},
                 "belongs to a transfer function, expected --bandwidth, --Ms-max and the like with "
                 "a vehicle");
  const Vehicle vehicle = load_vehicle(options.vehicle);
  CascadeSpecification specification =
      cascade_specification(line, options.cascade, options.Ms_max, vehicle);
  const bool on_flown_plant = designs_on_flown_plant(line, options, vehicle);
  const bool ideal = !on_flown_plant && asks_for_ideal_plant(line, options);
  if (ideal) specification.lag = 0;
  std::optional<FlownGains> flown;
  if (on_flown_plant) {
    FlownGainsOptions of_flown;
    of_flown.dt = specification.dt;
    flown = period_of_command("pid", line.was_given("--dt"),
                           [&] { return flown_gains(vehicle, of_flown); });
  }
  const CascadeReport report =
      flown ? assess_written_cascade(vehicle, as_cascade(*flown, specification.dt),
                                     specification.method, options.vehicle)
            : design_cascade(vehicle, specification, options.vehicle);
  draw(
      options.plot,
      [&] {
        return margins_figure(fmt::format("PID cascade of {} every {} s, cut at the wrench",
                                          report.vehicle, number(report.specification.dt)),
                              OpenLoop(report.open_loop), report.margins);
      },
      context);
  ExportContent content;
  content.vehicle = vehicle;
  content.cascade = CascadeDesign{report.cascade.gains, {}, report.specification.method};
  content.cascade->back_calculation = kDesignedBackCalculation;
  content.cascade->velocity_feed_forward = true;
  content.cascade->conditional_integration = true;
  content.cascade->integrator_limit = CascadeController{}.integrator_limit;
  content.cascade->attitude_limit =
      flown ? kDesignedAttitudeLimit : CascadeController{}.attitude_limit;
  content.estimator = stored_estimator(vehicle, "", report.cascade.gains.dt);
  const std::optional<FlownLoop> loop =
      flown_loop_of(vehicle, *content.cascade, content.estimator, context);
  if (context.json) {
    Json json = to_json(report);
    json["method"] = flown ? "flown" : "loops";
    json["plant"] = ideal ? "ideal" : flown ? "flown" : "lag";
    if (flown) json["flown"] = family_json(*flown);
    json["flown_loop"] = Json();
    if (loop) {
      json["flown_loop"] = to_json(*loop);
      json["flown_loop"]["margins"] = to_json(loop->margins);
    }
    add_laws(json, content);
    context.out << internal::readable(json) << "\n";
  } else {
    context.out << to_text(report);
    if (flown) context.out << section("flown", family_text(*flown));
    if (loop)
      context.out << section("flown loop", to_text(*loop))
                  << section("margins of the flown loop", to_text(loop->margins));
  }
  for (const std::string& note : report.cascade.notes) context.note("pid: note: " + note);
  if (flown)
    for (const std::string& note : flown->notes) context.note("pid: note: " + note);
  for (const std::string& warning : cascade_warnings(report))
    context.note("pid: warning: " + warning);
  if (!loop) return;
  for (const std::string& note : flown_notes(*loop)) context.note("pid: note: " + note);
  for (const std::string& note : margin_notes(loop->margins)) context.note("pid: note: " + note);
  if (loop->grows())
    context.note(fmt::format("pid: warning: the flown loop is unstable; {}{}", in_words(*loop),
                             ideal ? "; without --plant ideal the design includes the rotors' lag, "
                                     "the sensors and the estimator"
                                   : ""));
  for (const std::string& warning : margin_warnings(loop->margins))
    context.note("pid: warning: flown loop: " + warning);
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
        line.add_option("--num", options->num, "numerator of the plant, descending powers")
            ->type_name("LIST");
        line.add_option("--den", options->den, "denominator, descending powers")->type_name("LIST");
        line.add_number("--delay", options->delay, "delay of the plant [s]")->type_name("S");
        line.add_option("--type", options->type, "P, PI, PD or PID (default)")->type_name("TYPE");
        Option* crossover = line.add_number("--crossover", options->crossover,
                                            "where the loop's gain shall be 1 [rad/s]")
                                ->type_name("W");
        Option* phase = line.add_number("--phase-margin", options->phase_margin, "there [deg]")
                            ->type_name("DEG");
        Option* Tf =
            line.add_number("--Tf", options->Tf, "time constant of the derivative's filter [s]; 0")
                ->type_name("S");
        line.add_option("--rule", options->rule,
                        "amigo, simc, ziegler-nichols, cohen-coon or lambda")
            ->type_name("NAME");
        Option* tau_c =
            line.add_number("--tau-c", options->tau_c,
                            "with the rules simc and lambda: time constant of the closed loop [s]")
                ->type_name("S");
        Option* Ms = line.add_number("--Ms-max", options->Ms_max,
                                     "greatest integral gain with max |S| up to this; 1.4")
                         ->type_name("M");
        Option* Mt =
            line.add_number("--Mt-max", options->Mt_max, "and max |T| up to this")->type_name("M");
        Option* noise =
            line.add_number("--noise-gain-max", options->noise_gain_max, "and max |C S| up to this")
                ->type_name("G");
        add_plot_option(line, options->plot);
        return [=, owner = &line](Context& context) {
          if (!options->vehicle.empty()) return run_vehicle(*owner, *options, context);
          refuse_options(*owner, {"--method", "--plant"}, "belongs to a vehicle, expected one");
          refuse_options(*owner, cascade_option_names(), "belongs to a vehicle, expected one");
          run(*options,
              {crossover->was_given(), phase->was_given(), Tf->was_given(), tau_c->was_given(),
               Ms->was_given(), Mt->was_given(), noise->was_given()},
              context);
        };
      }};
}

}  // namespace quadtune::cli
