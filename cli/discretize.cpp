// SPDX-License-Identifier: Apache-2.0
/// quadtune discretize: one system by one method, or back.
#include <fmt/format.h>

#include <memory>
#include <ostream>
#include <utility>

#include "arguments/flight_arguments.hpp"
#include "arguments/matrix_arguments.hpp"
#include "arguments/plant_arguments.hpp"
#include "arguments/plot_argument.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/sampling/sampled_plant.hpp"
#include "report/loops/method_comparison.hpp"
#include "report/loops/sampled_plant.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string vehicle;
  PlotArgument plot;
  std::string A, B, C, D, num, den, method = "zoh", input_delay, output_delay;
  std::string compared_plant = "flown";
  double dt = 0;
  double prewarp = 0;
  double delay = 0;
  bool has_prewarp = false;
  bool has_delay = false;
  bool inverse = false;
  bool compare = false;

  [[nodiscard]] bool is_fraction() const { return !num.empty() || !den.empty(); }
};

// --- reading -------------------------------------------------------------------------------------

[[noreturn]] void refuse(const std::string& option, const std::string& message) {
  throw UsageError(fmt::format("quadtune discretize: {} {}", option, message), option);
}

void refuse_mixtures(const Options& options) {
  const auto given = [](const std::string& text) { return !text.empty(); };
  const std::pair<const char*, bool> matrices[] = {{"--A", given(options.A)},
                                                   {"--B", given(options.B)},
                                                   {"--C", given(options.C)},
                                                   {"--D", given(options.D)},
                                                   {"--input-delay", given(options.input_delay)},
                                                   {"--output-delay", given(options.output_delay)}};
  for (const auto& [option, came] : matrices)
    if (came && options.is_fraction())
      refuse(option, "came with --num and --den, expected matrices or a transfer function");
  if (options.has_delay && !options.is_fraction())
    refuse("--delay",
           "came without --num and --den, expected --input-delay or --output-delay for "
           "a plant of matrices");
  for (const auto& [option, text] : {std::pair("--input-delay", options.input_delay),
                                     std::pair("--output-delay", options.output_delay)})
    if (options.inverse && given(text))
      refuse(option,
             "came with --inverse, expected none because the delays of a discrete plant are "
             "states of it");
}

Eigen::VectorXd read_list(const std::string& text, const std::string& option) {
  const std::vector<double> numbers = number_list(text, "discretize", option);
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), std::ssize(numbers));
}

/// ContinuousLti or DiscreteLti.
template <class Lti>
Lti read_plant(const Options& options, std::istream& in) {
  Lti plant;
  plant.A = require_matrix(options.A, in, "discretize", "--A");
  plant.B = require_matrix(options.B, in, "discretize", "--B");
  plant.C = options.C.empty() ? Eigen::MatrixXd::Identity(plant.A.rows(), plant.A.rows()).eval()
                              : read_matrix(options.C, in);
  plant.D = options.D.empty() ? Eigen::MatrixXd::Zero(plant.C.rows(), plant.B.cols()).eval()
                              : read_matrix(options.D, in);
  return plant;
}

/// num and den of a ContinuousTransferFunction or a DiscreteTransferFunction.
template <class Fraction>
Fraction read_fraction(const Options& options) {
  for (const auto& [option, text] :
       {std::pair("--num", options.num), std::pair("--den", options.den)})
    if (text.empty()) refuse(option, "is missing, expected coefficients such as 1,0.5");
  Fraction plant;
  plant.num = read_list(options.num, "--num");
  plant.den = read_list(options.den, "--den");
  return plant;
}

SampledPlant sample_fraction(const Options& options, const SamplingOptions& by) {
  if (options.inverse)
    return continuous_plant(read_fraction<DiscreteTransferFunction>(options), options.delay, by);
  auto plant = read_fraction<ContinuousTransferFunction>(options);
  plant.delay = options.delay;
  return sampled_plant(plant, by);
}

SampledPlant sample_matrices(const Options& options, const SamplingOptions& by, std::istream& in) {
  if (options.inverse) return continuous_plant(read_plant<DiscreteLti>(options, in), by);
  const auto plant = read_plant<ContinuousLti>(options, in);
  ChannelDelays delays;
  delays.input = channel_delays(read_list(options.input_delay, "--input-delay"), "input-delay",
                                plant.B.cols(), "inputs");
  delays.output = channel_delays(read_list(options.output_delay, "--output-delay"), "output-delay",
                                 plant.C.rows(), "outputs");
  return sampled_plant(plant, delays, by);
}

void run_system(const Options& options, Context& context) {
  SamplingOptions by{discretization_method(options.method, "--method"), options.dt};
  if (options.inverse && by.method != DiscretizationMethod::zoh &&
      by.method != DiscretizationMethod::tustin)
    refuse("--inverse", fmt::format("came with --method {}, expected zoh or tustin, whose way back "
                                    "is built",
                                    options.method));
  if (options.has_prewarp) by.prewarp = options.prewarp;
  const SampledPlant sampled = option_of_command("discretize", [&] {
    require_prewarp(by);
    return options.is_fraction() ? sample_fraction(options, by)
                                 : sample_matrices(options, by, context.in);
  });
  for (const std::string& warning : sampled.warnings)
    context.note("discretize: warning: " + warning);
  context.out << (context.json ? internal::readable(to_json(sampled)) + "\n" : to_text(sampled));
}

/// The options of one system do not belong to the comparison, nor the comparison's to one system.
void refuse_options_of_a_system(const CommandLine& line) {
  for (const char* option : {"--A", "--B", "--C", "--D", "--num", "--den", "--delay", "--method",
                             "--prewarp", "--input-delay", "--output-delay", "--inverse"})
    if (line.was_given(option))
      refuse(option,
             "came with --compare, expected a vehicle alone because all methods are tried "
             "on its closed loops");
}

void run_comparison(const Options& options, Context& context) {
  if (options.vehicle.empty())
    refuse("--compare", "came without a vehicle, expected one: quadtune discretize V --compare");
  const bool flown = asks_for_flown_plant(options.compared_plant, "discretize");
  const MethodComparison comparison = compare_sampling_methods(options.vehicle, options.dt, flown);
  draw(
      options.plot, [&] { return sampling_figure(comparison); }, context);
  context.out << (context.json ? internal::readable(to_json(comparison)) + "\n"
                               : to_text(comparison));
}

void run_discretize(const Options& options, const CommandLine& line, Context& context) {
  require_positive(options.dt, "discretize", "--dt");
  require_picture(options.plot, "discretize");
  if (options.compare) {
    refuse_options_of_a_system(line);
    run_comparison(options, context);
    return;
  }
  if (!options.vehicle.empty())
    refuse("V",
           "came without --compare, expected it, or --A and --B or --num and --den for one "
           "system");
  if (line.was_given("--plant"))
    refuse("--plant",
           "came without --compare, expected it because a system of one's own is the plant");
  if (!options.plot.file.empty())
    refuse("--plot", "came without --compare, expected it because only the comparison is drawn");
  refuse_mixtures(options);
  run_system(options, context);
}

/// Of one system, and how it is sampled.
void add_system_options(CommandLine& line, Options& options) {
  line.add_option("--A", options.A, "dynamics (nx x nx)")->type_name("FILE");
  line.add_option("--B", options.B, "inputs (nx x nu)")->type_name("FILE");
  line.add_option("--C", options.C, "outputs (ny x nx); the states")->type_name("FILE");
  line.add_option("--D", options.D, "feed-through (ny x nu); zero")->type_name("FILE");
  line.add_option("--num", options.num, "zeros' polynomial, highest power first")
      ->type_name("LIST");
  line.add_option("--den", options.den, "poles' polynomial, likewise")->type_name("LIST");
  line.add_number("--delay", options.delay, "of --num/--den [s]")->type_name("T");
  line.add_number("--dt", options.dt, "sample period [s]")->type_name("T");
  line.add_option("--method", options.method,
                  "zoh (default), foh, impulse, euler, backward-euler, tustin or matched")
      ->type_name("NAME");
  line.add_number("--prewarp", options.prewarp, "frequency at which tustin is exact [rad/s]")
      ->type_name("W");
  line.add_option("--input-delay", options.input_delay, "of each input, or of all [s]")
      ->type_name("LIST");
  line.add_option("--output-delay", options.output_delay, "of each output, or of all [s]")
      ->type_name("LIST");
  line.add_flag("--inverse", options.inverse,
                "the system is discrete; back to continuous by zoh or tustin");
}

}  // namespace

Verb discretize_verb() {
  return {"discretize",
          "--A FILE --B FILE [--C FILE --D FILE] | --num LIST --den LIST | V --compare, --dt T "
          "[--method NAME]",
          "sample a continuous system, or back; or compare the methods on a vehicle's loops",
          "quadtune discretize --A docs/examples/A.txt --B docs/examples/B.txt --dt 0.01 --method "
          "tustin",
          [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            line.add_option("V", options->vehicle, "with --compare: a built-in vehicle or a file");
            line.add_flag("--compare", options->compare,
                          "every method at T/2, T and 2 T on the vehicle's LQR and PID loops");
            line.add_option("--plant", options->compared_plant,
                            "with --compare: flown (default) judges the laws as they run on the "
                            "plant with the sensors and the estimator as well; ideal does not")
                ->type_name("NAME");
            add_plot_option(line, options->plot);
            add_system_options(line, *options);
            return [options, owner = &line](Context& context) {
              if (!owner->was_given("--dt"))
                throw UsageError(
                    "quadtune discretize: --dt is missing, expected a sample period "
                    "in seconds",
                    "--dt");
              options->has_delay = owner->was_given("--delay");
              options->has_prewarp = owner->was_given("--prewarp");
              run_discretize(*options, *owner, context);
            };
          }};
}

}  // namespace quadtune::cli
