// SPDX-License-Identifier: Apache-2.0
/// quadtune discretize: samples one system by one method, or converts it back to continuous time.
#include <optional>
#include <utility>

#include "arguments/matrix_arguments.hpp"
#include "arguments/plant_arguments.hpp"
#include "arguments/plot_argument.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/flown/plant_word.hpp"
#include "quadtune/workbench/sampling/method_comparison.hpp"
#include "quadtune/workbench/sampling/sampled_plant.hpp"
#include "report/loops/loops.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string vehicle;
  PlotArgument plot;
  std::string A, B, C, D, num, den, method = "zoh", input_delay, output_delay;
  std::string compared_plant = "flown";
  double dt = 0, delay = 0;       // [s]
  std::optional<double> prewarp;  // [rad/s]
  bool inverse = false, compare = false;

  [[nodiscard]] bool is_fraction() const { return !num.empty() || !den.empty(); }
};

// --- reading -------------------------------------------------------------------------------------

void refuse_mixtures(const CommandLine& line, const Options& options) {
  if (options.is_fraction()) {
    line.refuse_given(
        {"--A", "--B", "--C", "--D"},
        "cannot be combined with --num and --den; expected matrices or a transfer function");
    line.refuse_given({"--input-delay", "--output-delay"},
                      "requires --A and --B; use --delay for a transfer function");
  } else {
    line.refuse_given(
        {"--delay"},
        "requires --num and --den; use --input-delay or --output-delay for a plant of matrices");
  }
  if (options.inverse)
    line.refuse_given({"--input-delay", "--output-delay"},
                      "cannot be combined with --inverse, because the delays of a discrete plant "
                      "are among its states");
}

Eigen::VectorXd read_list(const std::string& text, const std::string& option) {
  const std::vector<double> numbers = number_list(text, option);
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), std::ssize(numbers));
}

/// ContinuousLti or DiscreteLti.
template <class Lti>
Lti read_plant(const Options& options, std::istream& in) {
  Lti plant;
  plant.A = require_matrix(options.A, in, "--A");
  plant.B = require_matrix(options.B, in, "--B");
  plant.C = options.C.empty() ? Eigen::MatrixXd::Identity(plant.A.rows(), plant.A.rows()).eval()
                              : read_matrix(options.C, in, "--C");
  plant.D = options.D.empty() ? Eigen::MatrixXd::Zero(plant.C.rows(), plant.B.cols()).eval()
                              : read_matrix(options.D, in, "--D");
  return plant;
}

/// num and den of a ContinuousTransferFunction or a DiscreteTransferFunction.
template <class Fraction>
Fraction read_fraction(const Options& options) {
  for (const auto& [option, text] :
       {std::pair("--num", options.num), std::pair("--den", options.den)})
    if (text.empty()) refuse(option, "{} is missing, expected coefficients such as 1,0.5", option);
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
  const SamplingOptions by{discretization_method(options.method, "--method"), options.dt,
                           options.prewarp};
  if (options.inverse && by.method != DiscretizationMethod::zoh &&
      by.method != DiscretizationMethod::tustin)
    refuse("--inverse",
           "--inverse cannot be combined with --method {}; the inverse exists for zoh and tustin",
           options.method);
  require_prewarp(by);
  const SampledPlant sampled = options.is_fraction() ? sample_fraction(options, by)
                                                     : sample_matrices(options, by, context.in);
  context.notes("warning: ", sampled.warnings);
  context.print([&] { return to_json(sampled); }, [&] { return to_text(sampled); });
}

void run_comparison(const Options& options, Context& context) {
  if (options.vehicle.empty())
    refuse("--compare", "--compare requires a vehicle; expected: quadtune discretize V --compare");
  const bool flown = asks_for_flown_plant(options.compared_plant);
  const MethodComparison comparison = compare_sampling_methods(options.vehicle, options.dt, flown);
  draw(
      options.plot, [&] { return sampling_figure(comparison); }, context);
  context.print([&] { return to_json(comparison); }, [&] { return to_text(comparison); });
}

void run_discretize(const CommandLine& line, const Options& options, Context& context) {
  if (!line.was_given("--dt"))
    refuse("--dt", "--dt is missing, expected a sample period in seconds");
  require_positive(options.dt, "--dt");
  require_picture(options.plot);
  if (options.compare) {
    line.refuse_given({"--A", "--B", "--C", "--D", "--num", "--den", "--delay", "--method",
                       "--prewarp", "--input-delay", "--output-delay", "--inverse"},
                      "cannot be combined with --compare, which applies all methods to the closed "
                      "loops of a vehicle");
    run_comparison(options, context);
    return;
  }
  line.refuse_given({"V"},
                    "requires --compare; for one system use --A and --B, or --num and --den");
  line.refuse_given({"--plant"},
                    "requires --compare, because otherwise the given system is the plant");
  line.refuse_given({"--plot"}, "requires --compare, because only the comparison is drawn");
  refuse_mixtures(line, options);
  run_system(options, context);
}

/// Adds the options of one system and of its sampling.
void add_system_options(CommandLine& line, Options& options) {
  line.add_option("--A FILE", options.A, "dynamics (nx x nx)");
  line.add_option("--B FILE", options.B, "inputs (nx x nu)");
  line.add_option("--C FILE", options.C, "outputs (ny x nx); default: the states");
  line.add_option("--D FILE", options.D, "feed-through (ny x nu); default: 0");
  line.add_option("--num LIST", options.num, "numerator, descending powers");
  line.add_option("--den LIST", options.den, "denominator, descending powers");
  line.add_number("--delay T", options.delay, "delay of --num/--den [s]");
  line.add_number("--dt T", options.dt, "sample period [s]");
  line.add_option("--method NAME", options.method,
                  "zoh (default), foh, impulse, euler, backward-euler, tustin or matched");
  line.add_number("--prewarp W", options.prewarp, "frequency at which tustin is exact [rad/s]");
  line.add_option("--input-delay LIST", options.input_delay,
                  "delay of each input, or one for all [s]");
  line.add_option("--output-delay LIST", options.output_delay,
                  "delay of each output, or one for all [s]");
  line.add_flag("--inverse", options.inverse,
                "convert a discrete system to continuous time, by zoh or tustin");
}

void add_options(CommandLine& line, Options& options) {
  line.add_option("V", options.vehicle, "with --compare: a built-in vehicle or a vehicle file");
  line.add_flag("--compare", options.compare,
                "compare all methods at T/2, T and 2 T on the vehicle's LQR and PID loops");
  line.add_option("--plant NAME", options.compared_plant,
                  "with --compare: flown (default) analyses the laws also on the plant with the "
                  "sensors and the estimator; ideal does not");
  add_plot_option(line, options.plot);
  add_system_options(line, options);
}

}  // namespace

Verb discretize_verb() {
  return {
      "discretize",
      "--A FILE --B FILE [--C FILE --D FILE] | --num LIST --den LIST | V --compare, --dt T "
      "[--method NAME]",
      "sample a continuous system, or convert it back; or compare the methods on a vehicle's loops",
      "quadtune discretize --A docs/examples/A.txt --B docs/examples/B.txt --dt 0.01 --method "
      "tustin",
      with_options(add_options, run_discretize)};
}

}  // namespace quadtune::cli
