// SPDX-License-Identifier: Apache-2.0
/// quadtune pid: PID gains for a transfer function, by requirement, by rule, or by optimization
/// within bounds; or for the cascade of a vehicle.
#include "quadtune/control/pid.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <vector>

#include "arguments/loop_arguments.hpp"
#include "arguments/matrix_arguments.hpp"
#include "arguments/plot_argument.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/synthesis/pid/ultimate_rules.hpp"
#include "quadtune/workbench/design/vehicle_cascade.hpp"
#include "quadtune/workbench/systems/pid_report.hpp"
#include "report/loops/loops.hpp"
#include "report/loops/matrix_loops.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string vehicle;
  CascadeOptions cascade;  // of the vehicle; Ms_max serves for a transfer function, too
  bool free = false;       // --free: not bounded by the vehicle's published gains
  std::string num, den, type = "PID", rule;
  double delay = 0;                               // [s]
  std::optional<double> crossover, phase_margin;  // [rad/s], [deg]
  std::optional<double> Tf, tau_c;                // [s]
  std::optional<double> Mt_max, noise_gain_max;
  std::optional<double> Ku, Tu;  // [output / error], [s]
  std::string gains;             // "Kp,Ki,Kd,Tf"
  PlotArgument plot;
};

ContinuousTransferFunction read_plant(const Options& options) {
  ContinuousTransferFunction plant{coefficients(options.num, "--num"),
                                   coefficients(options.den, "--den"), options.delay};
  require_not_negative(options.delay, "--delay");
  validate(plant, "--num, --den");
  return plant;
}

PidBounds bounds_of(const Options& options) {
  PidBounds bounds;
  bounds.Ms_max = options.cascade.Ms_max.value_or(bounds.Ms_max);
  bounds.Mt_max = options.Mt_max.value_or(bounds.Mt_max);
  bounds.noise_gain_max = options.noise_gain_max.value_or(bounds.noise_gain_max);
  return bounds;
}

/// Requires exactly one of the three ways to compute gains.
void require_one_way(const Options& options) {
  const bool requirement = options.crossover || options.phase_margin;
  const bool rule = !options.rule.empty();
  const bool bounds = options.cascade.Ms_max || options.Mt_max || options.noise_gain_max;
  if (!requirement && !rule && !bounds)
    refuse("--crossover",
           "the plant has no requirement, expected --crossover with --phase-margin, --rule, or "
           "--Ms-max with optional --Mt-max and --noise-gain-max");
  std::vector<std::string> given;
  if (requirement) given.emplace_back("--crossover with --phase-margin");
  if (rule) given.emplace_back("--rule");
  if (bounds) given.emplace_back("the bounds of --Ms-max");
  if (given.size() > 1)
    refuse("--crossover",
           "{} are given together, expected only one of them, because each determines the gains",
           internal::joined(given, " and "));
  if (requirement && !(options.crossover && options.phase_margin))
    refuse(options.crossover ? "--phase-margin" : "--crossover",
           "--crossover and --phase-margin belong together, expected both");
  require_not_negative(options.Tf.value_or(0), "--Tf");
  if (rule && options.Tf)
    refuse(
        "--Tf",
        "--Tf cannot be combined with --rule, whose filter time is a tenth of the derivative time");
}

PidRequest request_of(const Options& options) {
  PidRequest request;
  request.type = pid_type(options.type);
  request.Tf = options.Tf.value_or(0);
  if (options.crossover)
    request.by = PidCrossover{*options.crossover, *options.phase_margin};
  else if (!options.rule.empty())
    request.by = PidRule{options.rule, options.tau_c};
  else
    request.by = bounds_of(options);
  return request;
}

/// --integrator of a controller that is discretized at --dt; by default tustin.
PidMethod method_of(const Options& options) {
  return options.cascade.integrator ? pid_method(*options.cascade.integrator, "--integrator")
                                    : PidMethod::tustin;
}

/// Adds the controller at the sample period of --dt, if it was given.
void add_discrete(internal::Json& json, const PidGains& gains, const Options& options) {
  if (options.cascade.dt)
    json["discrete"] = discrete_pid_json(gains, *options.cascade.dt, method_of(options));
}
std::string discrete_text(const PidGains& gains, const Options& options) {
  return options.cascade.dt ? section("discrete", discrete_pid_text(gains, *options.cascade.dt,
                                                                    method_of(options)))
                            : "";
}

/// Requires gains that can be discretized at --dt.
///
/// @param option  where they come from
void require_discrete(const PidGains& gains, const Options& options, const char* option) {
  if (!options.cascade.dt) return;
  try {
    (void)pid_settings(gains, *options.cascade.dt, method_of(options));
  } catch (const InvalidInput& error) {
    refuse(option, "{}: {}", option, error.message());
  }
}

/// Warns if sampling at --dt takes much of a delay that the loop can tolerate.
/// @param delay  [s]
void warn_of_period(const Options& options, double delay, const char* what,
                    const Context& context) {
  constexpr double kShare = 0.25;
  const double sampling = options.cascade.dt.value_or(0) / 2;  // mean delay of a held output
  if (sampling > kShare * delay)
    context.note(fmt::format("warning: --dt {} adds a delay of {} s, {:.0f} % of {}",
                             *options.cascade.dt, number(sampling), 100 * sampling / delay, what));
}

void print_gains(const PidGains& gains, const std::string& how, const Options& options,
                 Context& context) {
  require_discrete(gains, options, options.gains.empty() ? "--dt" : "--gains");
  context.print(
      [&] {
        internal::Json json = {
            {"Kp", gains.Kp}, {"Ki", gains.Ki}, {"Kd", gains.Kd}, {"Tf", gains.Tf}, {"how", how}};
        add_discrete(json, gains, options);
        return json;
      },
      [&] {
        return section("gains", fmt::format("Kp {}  Ki {} 1/s  Kd {} s  Tf {} s", number(gains.Kp),
                                            number(gains.Ki), number(gains.Kd), number(gains.Tf))) +
               section("by", how) + discrete_text(gains, options);
      });
}

/// Gains from the ultimate gain, or given ones: without a plant, hence without margins.
void run_without_plant(const CommandLine& line, const Options& options, Context& context) {
  line.refuse_given({"--num", "--den", "--delay", "--crossover", "--phase-margin", "--Tf",
                     "--tau-c", "--Ms-max", "--Mt-max", "--noise-gain-max", "--plot"},
                    "cannot be combined with --Ku or --gains, which need no plant");
  if (!options.gains.empty()) {
    line.refuse_given({"--Ku", "--Tu", "--rule", "--type"}, "cannot be combined with --gains");
    if (!options.cascade.dt)
      refuse("--dt", "--dt is missing, expected the sample period at which the gains run");
    print_gains(pid_gains_of(options.gains, "--gains"), "given", options, context);
    return;
  }
  if (!options.Ku || !options.Tu)
    refuse(options.Ku ? "--Tu" : "--Ku", "--Ku and --Tu belong together, expected both");
  require_positive(*options.Tu, "--Tu");
  const std::string rule = options.rule.empty() ? "ziegler-nichols" : options.rule;
  const PidGains gains = ultimate_rule(rule, pid_type(options.type), *options.Ku, *options.Tu);
  print_gains(gains,
              fmt::format("{} by {} for an ultimate gain of {} and a period of {} s", options.type,
                          rule, number(*options.Ku), number(*options.Tu)),
              options, context);
  warn_of_period(options, *options.Tu / 5, "a fifth of the ultimate period", context);
}

void run_transfer_function(const Options& options, Context& context) {
  require_picture(options.plot);
  if (options.num.empty() && options.den.empty())
    refuse("V", "the plant is missing, expected a vehicle, or --num and --den");
  require_one_way(options);
  const PidRequest request = request_of(options);
  const PidReport report = pid_report(read_plant(options), request);
  if (report.needs_filter)
    refuse("--Tf",
           "the gain of the derivative is unbounded for this plant; expected a filter with --Tf");
  draw(
      options.plot, [&] { return pid_figure(report, options.num, options.den); }, context);
  require_discrete(report.gains, options, "--dt");
  context.print(
      [&] {
        internal::Json json = to_json(report);
        add_discrete(json, report.gains, options);
        return json;
      },
      [&] { return to_text(report) + discrete_text(report.gains, options); });
  context.notes("warning: ", margin_warnings(report.margins));
  warn_of_period(options, report.margins.loops.front().delay_margin,
                 "the delay margin of the continuous loop", context);
}

// Options of the other mode are rejected. If they were ignored, the gains would not be the
// requested ones.

void run_vehicle(const CommandLine& line, Options& options, Context& context) {
  require_picture(options.plot);
  line.refuse_given(
      {"--num", "--den", "--delay", "--type", "--crossover", "--phase-margin", "--Tf", "--rule",
       "--tau-c", "--Mt-max", "--noise-gain-max", "--Ku", "--Tu", "--gains"},
      "belongs to a transfer function; use --bandwidth, --Ms-max and similar options "
      "with a vehicle");
  if (line.was_given("--free")) options.cascade.use_published = !options.free;
  const Vehicle vehicle = load_vehicle(options.vehicle);
  const VehicleCascade cascade = vehicle_cascade(vehicle, options.cascade, options.vehicle);
  draw(
      options.plot, [&] { return cascade_figure(cascade); }, context);
  if (!cascade.loop) context.note("note: the flown loop is not analysed: " + cascade.not_analysed);
  context.print([&] { return to_json(cascade); }, [&] { return to_text(cascade); });
  context.notes(notes_of(cascade));
}

void run_pid(const CommandLine& line, Options& options, Context& context) {
  if (options.vehicle.empty()) {
    line.refuse_given({"--method", "--plant", "--bandwidth", "--sensor-delay", "--structure",
                       "--motor-lag", "--rate-lead", "--tracking-max", "--integral", "--free"},
                      "belongs to a vehicle; expected `pid V`");
    if (options.cascade.dt) require_positive(*options.cascade.dt, "--dt");
    if (line.was_given("--integrator") && !options.cascade.dt)
      refuse("--integrator", "--integrator requires --dt, the sample period");
    if (options.Ku || options.Tu || !options.gains.empty()) {
      run_without_plant(line, options, context);
      return;
    }
    run_transfer_function(options, context);
    return;
  }
  run_vehicle(line, options, context);
}

void add_transfer_function_options(CommandLine& line, Options& options) {
  line.add_option("--num LIST", options.num, "numerator of the plant, descending powers");
  line.add_option("--den LIST", options.den, "denominator, descending powers");
  line.add_number("--delay S", options.delay, "delay of the plant [s]");
  line.add_option("--type TYPE", options.type, "P, PI, PD or PID (default)");
  line.add_number("--crossover W", options.crossover, "crossover frequency of the loop [rad/s]");
  line.add_number("--phase-margin DEG", options.phase_margin,
                  "phase margin at the crossover [deg]");
  line.add_number("--Tf S", options.Tf, "time constant of the derivative filter [s]; default 0");
  line.add_option("--rule NAME", options.rule,
                  "amigo, simc, ziegler-nichols, cohen-coon or lambda; from the ultimate gain: "
                  "pessen, some-overshoot, no-overshoot or tyreus-luyben");
  line.add_number("--Ku K", options.Ku,
                  "in place of a plant: gain at which a proportional loop oscillates; with --rule, "
                  "by default ziegler-nichols");
  line.add_number("--Tu S", options.Tu, "with --Ku: period of that oscillation [s]");
  line.add_option("--gains LIST", options.gains,
                  "in place of a plant: Kp,Ki,Kd,Tf to discretize at --dt");
  line.add_number("--tau-c S", options.tau_c,
                  "with the rules simc and lambda: time constant of the closed loop [s]");
  line.add_number(
      "--Ms-max M", options.cascade.Ms_max,
      "upper bound of max |S|, default 1.4; without V, the integral gain is maximized within it; "
      "with V, it applies to each loop");
  line.add_number("--Mt-max M", options.Mt_max, "as --Ms-max, with max |T| of at most M as well");
  line.add_number("--noise-gain-max G", options.noise_gain_max,
                  "as --Ms-max, with max |C S| of at most G as well");
}

void add_cascade_options(CommandLine& line, CascadeOptions& options, bool& free) {
  line.add_number(
      "--dt T", options.dt,
      "control period [s]; with V, the default is that of its published gains, or 0.005; "
      "without V, the difference equation at this period is printed as well");
  line.add_option(
      "--bandwidth LIST", options.bandwidth,
      "with V: crossover of the rate loops [rad/s]: roll=40,x=2, or one number for all");
  line.add_option("--sensor-delay LIST", options.sensor_delay,
                  "with V: delay of the measurements [s]: one number, or roll=0.005,x=0.02");
  line.add_option("--structure NAME", options.structure,
                  "with V: pid (default), or p-pi: a gain before a PI controller of the rate, as "
                  "in autopilots");
  line.add_option("--for NAME", options.for_firmware,
                  "with V: px4, ardupilot, betaflight or crazyflie: use the structure of this "
                  "firmware, and bound the margins with its filters and delay as well");
  line.add_option(
      "--firmware VERSION", options.firmware.version,
      "with --for: version of the firmware; default: px4 1.16, ardupilot 4.6, betaflight "
      "2026.6, crazyflie 2026.08");
  line.add_option("--setup NAME", options.firmware.setup,
                  "with --for crazyflie: standard (default), legacy, thrust-kit or brushless");
  line.add_number(
      "--rate-lead S", options.rate_lead,
      "with V: lead of the rate in the roll and pitch loops [s], which compensates a part "
      "of the motor lag; default: half the motor lag with --for px4 or ardupilot, "
      "otherwise 0");
  line.add_number("--motor-lag S", options.motor_lag,
                  "with V: time constant of the motor lag [s]; default: that of the vehicle");
  line.add_number("--tracking-max M", options.tracking_max,
                  "with V: upper bound of max |value / set point|; default 1.3");
  line.add_option("--integral LIST", options.integral,
                  "with V: loops that have an integral, or none; default: all");
  line.add_option("--integrator NAME", options.integrator,
                  "euler, backward-euler or tustin; default: with V euler, otherwise tustin");
  line.add_flag(
      "--free", free,
      "with V: do not bound the loops by the Ms, noise and load peak of the published gains");
}

void add_options(CommandLine& line, Options& options) {
  line.add_option("V", options.vehicle, "a built-in vehicle's name or a vehicle file");
  line.add_option(
      "--method M", options.cascade.method,
      "flown (default unless the vehicle has a satellite receiver below 5 Hz and no "
      "optical flow): all gains at once on the flown plant; loops: loop by loop, implied by "
      "--bandwidth, --Ms-max and similar options");
  line.add_option(
      "--plant NAME", options.cascade.plant,
      "ideal: the textbook plant with 12 states, loop by loop; default: the flown plant, "
      "or with --method loops the rigid body with motor lag; the flown loop is always "
      "reported");
  add_cascade_options(line, options.cascade, options.free);
  add_transfer_function_options(line, options);
  add_plot_option(line, options.plot);
}

}  // namespace

Verb pid_verb() {
  return {
      "pid",
      "V [options]   or   --num LIST --den LIST [--delay S] (--crossover W --phase-margin DEG "
      "| --rule NAME | --Ms-max M)   or   --Ku K --Tu S [--rule NAME]   or   --gains LIST --dt T",
      "PID gains for a vehicle's cascade or for a transfer function",
      "quadtune pid --num 1 --den 1,3,3,1 --type PI --crossover 0.5205 --phase-margin 60",
      with_options(add_options, run_pid)};
}

}  // namespace quadtune::cli
