// SPDX-License-Identifier: Apache-2.0
/// quadtune certify: is the loop of exported gains stable for all vehicles of a box?
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <ostream>

#include "arguments/flight_arguments.hpp"
#include "arguments/read_number.hpp"
#include "arguments/plant_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/read_gains.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/tuning/uncertain_vehicle.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/flown/flown_box.hpp"
#include "quadtune/workbench/flown/flown_check.hpp"
#include "quadtune/workbench/flown/flying_loop.hpp"
#include "report/gains/verify_report.hpp"
#include "report/loops/certify_report.hpp"
#include "report/text/print.hpp"
#include "quadtune/workbench/verify/verify_directory.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string directory, vehicle, controller;
  std::string mass = "0.9:1.1";
  std::string inertia = "0.8:1.2";
  std::string thrust = "0.9:1.1";
  std::string delay;       // empty: up to one period
  std::string lag;         // empty: the vehicle's
  std::string integrator;  // empty: the export's
  std::string plant = "flown";
  std::uint64_t budget = 20000;
};

/// "LOW:HIGH", or one number for both.
UncertainRange read_range(const std::string& text, const std::string& option,
                          const std::string& expected) {
  const std::size_t colon = text.find(':');
  UncertainRange range;
  const bool ok = read_number(text.substr(0, colon), range.low) &&
                  (colon == std::string::npos || read_number(text.substr(colon + 1), range.high));
  if (colon == std::string::npos) range.high = range.low;
  if (!ok)
    throw UsageError(fmt::format("quadtune certify: {} is '{}', expected {}", option,
                                 internal::printable(text), expected),
                     option);
  return range;
}

UncertainRange read_ratios(const std::string& text, const std::string& option) {
  const std::string expected = "LOW:HIGH, ratios to the file's value with 0 < LOW <= 1 <= HIGH";
  const UncertainRange range = read_range(text, option, expected);
  if (!(range.low > 0) || !(range.low <= 1) || !(range.high >= 1))
    throw UsageError(fmt::format("quadtune certify: {} is '{}', expected {}", option,
                                 internal::printable(text), expected),
                     option);
  return range;
}

UncertainRange read_seconds(const std::string& text, const std::string& option, bool from_zero) {
  const std::string expected =
      from_zero ? "LOW:HIGH [s] with 0 <= LOW <= HIGH"
                : "LOW:HIGH [s] with 0 < LOW <= HIGH, or 0 for motors without lag";
  const UncertainRange range = read_range(text, option, expected);
  const bool none = range.low == 0 && range.high == 0;
  const bool starts = from_zero ? range.low >= 0 : range.low > 0 || none;
  if (!starts || !(range.low <= range.high))
    throw UsageError(fmt::format("quadtune certify: {} is '{}', expected {}", option,
                                 internal::printable(text), expected),
                     option);
  return range;
}

/// Beyond that the states of the delay outgrow the proof.
void require_short(const UncertainRange& delay, double dt) {
  if (delay.high > kMostDelayPeriods * dt)
    throw UsageError(fmt::format("quadtune certify: --delay is up to {} s, expected at most {} "
                                 "periods of {} s",
                                 number(delay.high), kMostDelayPeriods, number(dt)),
                     "--delay");
}

VehicleUncertainty uncertainty_of(const Options& options, const Vehicle& vehicle, double dt) {
  VehicleUncertainty u;
  u.mass = read_ratios(options.mass, "--mass");
  u.inertia = read_ratios(options.inertia, "--inertia");
  u.thrust = read_ratios(options.thrust, "--thrust");
  const double late = vehicle.motor.delay;  // then up to the jitter and one period of computing
  u.delay = options.delay.empty() ? UncertainRange{late, late + vehicle.motor.delay_jitter + dt}
                                  : read_seconds(options.delay, "--delay", true);
  require_short(u.delay, dt);
  const double own = slower_lag(vehicle.rotors.front());
  u.lag =
      options.lag.empty() ? UncertainRange{own, own} : read_seconds(options.lag, "--lag", false);
  if (options.lag.empty() &&
      std::any_of(vehicle.rotors.begin(), vehicle.rotors.end(),
                  [&](const Rotor& rotor) { return slower_lag(rotor) != own; }))
    throw InvalidInput(vehicle.name,
                       "the rotors have different lags, expected --lag LOW:HIGH for all");
  if (u.lag.high > kLongestLag)
    throw UsageError(fmt::format("quadtune certify: --lag is up to {} s, expected at most {} s",
                                 number(u.lag.high), number(kLongestLag)),
                     "--lag");
  return u;
}

/// What does not verify is not certified.
void require_verified(const Options& options) {
  const VerifyReport report = verify_directory(options.directory, options.vehicle);
  for (const VerifyCheck& check : report.checks)
    if (!check.ok)
      throw Refusal(fmt::format("certify: {} does not verify: {}: {}", options.directory,
                                check.name, check.detail),
                    options.directory);
}

Vehicle vehicle_of(const Options& options, const Manifest& manifest) {
  if (!options.vehicle.empty()) return load_vehicle(options.vehicle);
  try {
    return load_vehicle(manifest.vehicle);
  } catch (const std::exception&) {
    throw InvalidInput("certify", fmt::format("the manifest's vehicle '{}' is not built in, "
                                              "expected its file by --vehicle FILE",
                                              manifest.vehicle));
  }
}

bool asked_for(const Options& options, const std::string& controller) {
  return options.controller.empty() || options.controller == controller;
}

/// A law of the export that is asked for, not yet looked at, and how it flies.
struct AskedLaw {
  CertifiedLaw law;
  std::function<PlannedFlight()> hover;  ///< none if the gains are of another flight
};

std::vector<AskedLaw> laws_of(const Options& options, const Vehicle& vehicle) {
  const StoredLaws stored = read_laws(options.directory);
  std::vector<AskedLaw> laws;
  if (stored.gains && asked_for(options, "state-feedback")) {
    const Gains& gains = *stored.gains;
    AskedLaw& asked = laws.emplace_back();
    asked.law.name = "state feedback";
    asked.law.dt = gains.dt;
    asked.law.family = uncertain_hover(vehicle, gains, uncertainty_of(options, vehicle, gains.dt));
    if (has_flown_loop(linearization_of(vehicle, gains).trim))
      asked.hover = [vehicle, gains, estimator = stored.estimator] {
        return hover_under(vehicle, feedback_controller(gains, gains.dt), estimator,
                           gains.convention);
      };
  }
  if (stored.cascade && asked_for(options, "cascaded-pid")) {
    CascadeDesign cascade = *stored.cascade;
    if (!options.integrator.empty())
      cascade.method = pid_method(options.integrator, "--integrator");
    AskedLaw& asked = laws.emplace_back();
    asked.law.name = "cascade";
    asked.law.dt = cascade.gains.dt;
    asked.law.family = uncertain_hover(vehicle, cascade.gains, cascade.method,
                                       uncertainty_of(options, vehicle, cascade.gains.dt));
    asked.hover = [vehicle, cascade, estimator = stored.estimator] {
      return hover_under(vehicle, cascade_controller(cascade, cascade.gains), estimator, "");
    };
  }
  if (laws.empty())
    throw InvalidInput(options.directory,
                       fmt::format("the export has no {}, expected a law whose loop can be closed",
                                   options.controller.empty() ? "gains" : options.controller));
  return laws;
}

/// The flown loops of the box, where the gains are for a hover.
FlownBox flown_of(const AskedLaw& asked, const Context& context) {
  FlownBox none;
  if (!asked.hover) {
    none.why = "the gains are not for a level hover with the heading north";
    return none;
  }
  FlownBoxOptions options;
  options.also = asked.law.robustness.worst.parameters;
  options.threads = context.threads;
  options.interrupted = interrupted;
  try {
    return flown_box(asked.hover(), asked.law.family, options);
  } catch (const InvalidInput& error) {
    none.why = error.what();
    return none;
  }
}

/// Before anything is read: a wrong range is told without an export.
void require_ranges(const Options& options) {
  (void)read_ratios(options.mass, "--mass");
  (void)read_ratios(options.inertia, "--inertia");
  (void)read_ratios(options.thrust, "--thrust");
  if (!options.delay.empty()) (void)read_seconds(options.delay, "--delay", true);
  if (!options.lag.empty()) (void)read_seconds(options.lag, "--lag", false);
  if (!options.integrator.empty()) (void)pid_method(options.integrator, "--integrator");
  (void)asks_for_flown_plant(options.plant, "certify");
}

void run(const Options& options, Context& context) {
  if (options.directory.empty())
    throw UsageError("quadtune certify: expected an export's directory", "DIR");
  require_ranges(options);
  require_verified(options);
  const Manifest manifest = read_manifest(options.directory);
  const Vehicle vehicle = vehicle_of(options, manifest);
  CertifyReport report{options.directory, vehicle.name, {}};
  RobustnessOptions robustness;
  robustness.seed = context.seed;
  robustness.proof.most_boxes = static_cast<int>(options.budget);
  robustness.proof.threads = context.threads;
  robustness.proof.interrupted = interrupted;
  for (AskedLaw& asked : laws_of(options, vehicle)) {
    asked.law.robustness = assess_robustness(asked.law.family, robustness);
    if (asked.law.robustness.proof.status == StabilityProofStatus::interrupted) throw Interrupted();
    if (asks_for_flown_plant(options.plant, "certify")) asked.law.flown = flown_of(asked, context);
    report.laws.push_back(std::move(asked.law));
  }
  if (context.json)
    context.out << internal::readable(to_json(report)) << "\n";
  else
    context.out << to_text(report);
  for (const CertifiedLaw& law : report.laws)
    if (!law.proved()) throw AnswerIsNo(fmt::format("certify: {}", law.reason()));
}

}  // namespace

Verb certify_verb() {
  return {"certify",
          "DIR [--mass LOW:HIGH] [--inertia LOW:HIGH] [--thrust LOW:HIGH] [--delay "
          "LOW:HIGH]",
          "prove an export's loop stable for every vehicle of a box, or find one that is not",
          "quadtune certify out/uquad-hover", [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            line.add_option("DIR", options->directory, "an export's directory");
            line.add_option("--mass", options->mass, "ratios of the mass (default 0.9:1.1)")
                ->type_name("LOW:HIGH");
            line.add_option("--inertia", options->inertia,
                            "ratios of each principal moment (default 0.8:1.2)")
                ->type_name("LOW:HIGH");
            line.add_option("--thrust", options->thrust,
                            "ratios of the rotors' thrust and drag torque (default 0.9:1.1)")
                ->type_name("LOW:HIGH");
            line.add_option("--delay", options->delay,
                            "delay of the loop beyond the hold [s] (default 0 to one period)")
                ->type_name("LOW:HIGH");
            line.add_option("--lag", options->lag,
                            "time constant of the motors [s] (default the vehicle's)")
                ->type_name("LOW:HIGH");
            line.add_option(
                    "--controller", options->controller,
                    "state-feedback (or lqr), cascaded-pid (or pid); all of the export if absent")
                ->type_name("NAME");
            line.add_option("--integrator", options->integrator,
                            "of a cascade: euler, backward-euler or tustin (default: the export's)")
                ->type_name("METHOD");
            line.add_option("--vehicle", options->vehicle,
                            "the vehicle, where the manifest's is not built in")
                ->type_name("V");
            line.add_option("--plant", options->plant,
                            "flown (default) also looks at vehicles of the box with their sensors "
                            "and estimator; ideal does not")
                ->type_name("NAME");
            line.add_count("--budget", options->budget, 1,
                           "boxes that a proof may look at (default 20000)")
                ->type_name("N");
            return [options](Context& context) {
              options->controller =
                  option_of_command("certify", [&] { return controller_kind(options->controller); });
              run(*options, context);
            };
          }};
}

}  // namespace quadtune::cli
