// SPDX-License-Identifier: Apache-2.0
/// quadtune certify: is the loop of exported gains stable for all vehicles of a box?
#include "quadtune/workbench/verify/certify.hpp"

#include <fmt/format.h>

#include <optional>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/flown/plant_word.hpp"
#include "quadtune/workbench/verify/uncertain_range.hpp"
#include "report/loops/loops.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string directory, vehicle, controller;
  std::string plant = "flown";
  std::optional<std::string> mass, inertia, thrust;  // none: of [spread], or usual ratios
  std::optional<std::string> delay, lag;             // none: up to one period, the vehicle's
  std::string integrator;                            // empty: the export's
  std::uint64_t budget = 20000;
};

/// Wrong ranges are reported before the export is read.
CertifyOptions certify_options(const Options& options, const Context& context) {
  CertifyOptions certify;
  certify.vehicle = options.vehicle;
  certify.controller = options.controller;
  if (options.mass) certify.mass = uncertain_ratios(*options.mass, "mass");
  if (options.inertia) certify.inertia = uncertain_ratios(*options.inertia, "inertia");
  if (options.thrust) certify.thrust = uncertain_ratios(*options.thrust, "thrust");
  if (options.delay) certify.delay = uncertain_delay(*options.delay, "delay");
  if (options.lag) certify.lag = uncertain_lag(*options.lag, "lag");
  if (!options.integrator.empty())
    certify.integrator = pid_method(options.integrator, "--integrator");
  certify.flown = asks_for_flown_plant(options.plant);
  certify.max_boxes = static_cast<int>(options.budget);
  certify.seed = context.seed;
  certify.threads = context.threads;
  certify.stop = interrupted;
  return certify;
}

void run_certify(Options& options, Context& context) {
  options.controller = controller_kind(options.controller, false);
  if (options.directory.empty()) refuse("DIR", "expected an export's directory");
  const CertifyReport report = certify(options.directory, certify_options(options, context));
  if (report.failed)
    throw Refusal(fmt::format("{} does not verify: the check '{}' failed: {}", options.directory,
                              report.failed->name, report.failed->detail),
                  options.directory);
  context.print([&] { return to_json(report); }, [&] { return to_text(report); });
  for (const CertifiedLaw& law : report.laws)
    if (!law.proved()) throw AnswerIsNo(law.reason());
}

void add_options(CommandLine& line, Options& options) {
  line.add_option("DIR", options.directory, "an export's directory");
  line.add_option("--mass LOW:HIGH", options.mass,
                  "ratios of the mass (default: that of the vehicle's [spread], or 0.9:1.1)");
  line.add_option(
      "--inertia LOW:HIGH", options.inertia,
      "ratios of each principal moment (default: that of the vehicle's [spread], or 0.8:1.2)");
  line.add_option(
      "--thrust LOW:HIGH", options.thrust,
      "ratios of the rotors' thrust and drag torque (default: that of the vehicle's [spread], or "
      "0.9:1.1)");
  line.add_option("--delay LOW:HIGH", options.delay,
                  "delay of the loop in addition to the zero-order hold [s] (default: LOW is the "
                  "delay of the commands, HIGH is this delay plus its jitter plus one period)");
  line.add_option(
      "--lag LOW:HIGH", options.lag,
      "time constant of the motors [s] (default: that of the vehicle, the larger one if "
      "the file has two, with its [spread])");
  line.add_option(
      "--controller NAME", options.controller,
      "state-feedback (or lqr), cascaded-pid (or pid); default: every law of the export");
  line.add_option(
      "--integrator METHOD", options.integrator,
      "integration method of a cascade: euler, backward-euler or tustin (default: the export's)");
  line.add_option(
      "--vehicle V", options.vehicle,
      "the vehicle file, if the vehicle of the manifest is neither built in nor found near the "
      "export or in the working folder");
  line.add_option("--plant NAME", options.plant,
                  "flown (default) also analyses vehicles of the box with their sensors and "
                  "estimator; ideal does not");
  line.add_count("--budget N", options.budget, 1,
                 "maximum number of parts of the box that a proof may examine (default 20000)");
}

}  // namespace

Verb certify_verb() {
  return {"certify",
          "DIR [--mass LOW:HIGH] [--inertia LOW:HIGH] [--thrust LOW:HIGH] [--delay LOW:HIGH]",
          "prove an export's loop stable for every vehicle of a box, or find one that is not",
          "quadtune certify out/uquad-hover", with_options(add_options, run_certify)};
}

}  // namespace quadtune::cli
