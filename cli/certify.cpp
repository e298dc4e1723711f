// SPDX-License-Identifier: Apache-2.0
/// quadtune certify: is the loop of exported gains stable for all vehicles of a box?
#include "quadtune/workbench/verify/certify.hpp"

#include <fmt/format.h>

#include <memory>
#include <ostream>

#include "arguments/flight_arguments.hpp"
#include "arguments/read_number.hpp"
#include "arguments/plant_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "report/loops/certify_report.hpp"

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

/// Wrong ranges are told before the export is read.
CertifyOptions certify_options(const Options& options, const Context& context) {
  CertifyOptions certify;
  certify.vehicle = options.vehicle;
  certify.controller = options.controller;
  certify.mass = read_ratios(options.mass, "--mass");
  certify.inertia = read_ratios(options.inertia, "--inertia");
  certify.thrust = read_ratios(options.thrust, "--thrust");
  if (!options.delay.empty()) certify.delay = read_seconds(options.delay, "--delay", true);
  if (!options.lag.empty()) certify.lag = read_seconds(options.lag, "--lag", false);
  if (!options.integrator.empty())
    certify.integrator = pid_method(options.integrator, "--integrator");
  certify.flown = asks_for_flown_plant(options.plant, "certify");
  certify.most_boxes = static_cast<int>(options.budget);
  certify.seed = context.seed;
  certify.threads = context.threads;
  certify.stop = interrupted;
  return certify;
}

void run(const Options& options, Context& context) {
  if (options.directory.empty())
    throw UsageError("quadtune certify: expected an export's directory", "DIR");
  const CertifyOptions asked = certify_options(options, context);
  const CertifyReport report =
      option_of_command("certify", [&] { return certify(options.directory, asked); });
  if (report.failed)
    throw Refusal(fmt::format("certify: {} does not verify: {}: {}", options.directory,
                              report.failed->name, report.failed->detail),
                  options.directory);
  context.out << (context.json ? internal::readable(to_json(report)) + "\n" : to_text(report));
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
              options->controller = option_of_command(
                  "certify", [&] { return controller_kind(options->controller); });
              run(*options, context);
            };
          }};
}

}  // namespace quadtune::cli
