// SPDX-License-Identifier: Apache-2.0
/// quadtune certify: is the loop of exported gains stable for all vehicles of a box?
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <ostream>

#include "certify_report.hpp"
#include "flight_arguments.hpp"
#include "number_arguments.hpp"
#include "print.hpp"
#include "program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/read_gains.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/tuning/uncertain_vehicle.hpp"
#include "refusal.hpp"
#include "verify_report.hpp"

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
  u.delay =
      options.delay.empty() ? UncertainRange{0, dt} : read_seconds(options.delay, "--delay", true);
  require_short(u.delay, dt);
  const double own = vehicle.rotors.front().lag;
  u.lag =
      options.lag.empty() ? UncertainRange{own, own} : read_seconds(options.lag, "--lag", false);
  if (options.lag.empty() && std::any_of(vehicle.rotors.begin(), vehicle.rotors.end(),
                                         [&](const Rotor& rotor) { return rotor.lag != own; }))
    throw InvalidInput(vehicle.name,
                       "the rotors have different lags, expected --lag LOW:HIGH for all");
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

/// The laws of the export that are asked for, not yet looked at.
std::vector<CertifiedLaw> laws_of(const Options& options, const Vehicle& vehicle) {
  const StoredLaws stored = read_laws(options.directory);
  std::vector<CertifiedLaw> laws;
  if (stored.gains && asked_for(options, "state-feedback"))
    laws.push_back({"state feedback",
                    stored.gains->dt,
                    uncertain_hover(vehicle, *stored.gains,
                                    uncertainty_of(options, vehicle, stored.gains->dt)),
                    {}});
  if (stored.cascade && asked_for(options, "cascaded-pid")) {
    const CascadeDesign& cascade = *stored.cascade;
    const PidMethod method = options.integrator.empty()
                                 ? cascade.method
                                 : pid_method(options.integrator, "--integrator");
    laws.push_back({"cascade",
                    cascade.gains.dt,
                    uncertain_hover(vehicle, cascade.gains, method,
                                    uncertainty_of(options, vehicle, cascade.gains.dt)),
                    {}});
  }
  if (laws.empty())
    throw InvalidInput(options.directory,
                       fmt::format("the export has no {}, expected a law whose loop can be closed",
                                   options.controller.empty() ? "gains" : options.controller));
  return laws;
}

/// Before anything is read: a wrong range is told without an export.
void require_ranges(const Options& options) {
  (void)read_ratios(options.mass, "--mass");
  (void)read_ratios(options.inertia, "--inertia");
  (void)read_ratios(options.thrust, "--thrust");
  if (!options.delay.empty()) (void)read_seconds(options.delay, "--delay", true);
  if (!options.lag.empty()) (void)read_seconds(options.lag, "--lag", false);
  if (!options.integrator.empty()) (void)pid_method(options.integrator, "--integrator");
}

void run(const Options& options, Context& context) {
  if (options.directory.empty())
    throw UsageError("quadtune certify: expected an export's directory", "DIR");
  require_ranges(options);
  require_verified(options);
  const Manifest manifest = read_manifest(options.directory);
  const Vehicle vehicle = vehicle_of(options, manifest);
  CertifyReport report{options.directory, vehicle.name, laws_of(options, vehicle)};
  RobustnessOptions robustness;
  robustness.seed = context.seed;
  robustness.proof.most_boxes = static_cast<int>(options.budget);
  robustness.proof.interrupted = interrupted;
  for (CertifiedLaw& law : report.laws) {
    law.robustness = assess_robustness(law.family, robustness);
    if (law.robustness.proof.status == StabilityProofStatus::interrupted) throw Interrupted();
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
          "quadtune certify out/uquad-hover", [](CLI::App& app) -> Action {
            auto options = std::make_shared<Options>();
            app.add_option("DIR", options->directory, "an export's directory");
            app.add_option("--mass", options->mass, "ratios of the mass (default 0.9:1.1)")
                ->type_name("LOW:HIGH");
            app.add_option("--inertia", options->inertia,
                           "ratios of each principal moment (default 0.8:1.2)")
                ->type_name("LOW:HIGH");
            app.add_option("--thrust", options->thrust,
                           "ratios of the rotors' thrust and drag torque (default 0.9:1.1)")
                ->type_name("LOW:HIGH");
            app.add_option("--delay", options->delay,
                           "delay of the loop beyond the hold [s] (default 0 to one period)")
                ->type_name("LOW:HIGH");
            app.add_option("--lag", options->lag,
                           "time constant of the motors [s] (default the vehicle's)")
                ->type_name("LOW:HIGH");
            app.add_option(
                   "--controller", options->controller,
                   "state-feedback (or lqr), cascaded-pid (or pid); all of the export if absent")
                ->type_name("NAME");
            app.add_option("--integrator", options->integrator,
                           "of a cascade: euler, backward-euler or tustin (default: the export's)")
                ->type_name("METHOD");
            app.add_option("--vehicle", options->vehicle,
                           "the vehicle, where the manifest's is not built in")
                ->type_name("V");
            add_count(app, "--budget", options->budget, 1,
                      "boxes that a proof may look at (default 20000)")
                ->type_name("N");
            return [options](Context& context) {
              options->controller =
                  told_of_command("certify", [&] { return controller_kind(options->controller); });
              run(*options, context);
            };
          }};
}

}  // namespace quadtune::cli
