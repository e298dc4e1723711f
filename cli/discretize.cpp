// SPDX-License-Identifier: Apache-2.0
/// quadtune discretize: one system by one method, or back.
#include <optional>
#include <utility>

#include "arguments/flight_arguments.hpp"
#include "arguments/matrix_arguments.hpp"
#include "arguments/plant_arguments.hpp"
#include "arguments/plot_argument.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/json.hpp"
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
  if (options.is_fraction())
    line.refuse_given({"--A", "--B", "--C", "--D", "--input-delay", "--output-delay"},
                      "came with --num and --den, expected matrices or a transfer function");
  else
    line.refuse_given({"--delay"},
                      "came without --num and --den, expected --input-delay or --output-delay for "
                      "a plant of matrices");
  if (options.inverse)
    line.refuse_given({"--input-delay", "--output-delay"},
                      "came with --inverse, expected none because the delays of a discrete plant "
                      "are states of it");
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
    if (text.empty())
      refuse("discretize", option, "{} is missing, expected coefficients such as 1,0.5", option);
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
    refuse("discretize", "--inverse",
           "--inverse came with --method {}, expected zoh or tustin, whose way back is built",
           options.method);
  const SampledPlant sampled = option_of_command("discretize", [&] {
    require_prewarp(by);
    return options.is_fraction() ? sample_fraction(options, by)
                                 : sample_matrices(options, by, context.in);
  });
  context.notes("discretize: warning: ", sampled.warnings);
  context.print([&] { return to_json(sampled); }, [&] { return to_text(sampled); });
}

void run_comparison(const Options& options, Context& context) {
  if (options.vehicle.empty())
    refuse("discretize", "--compare",
           "--compare came without a vehicle, expected one: quadtune discretize V --compare");
  const bool flown = asks_for_flown_plant(options.compared_plant, "discretize");
  const MethodComparison comparison = compare_sampling_methods(options.vehicle, options.dt, flown);
  draw(
      options.plot, [&] { return sampling_figure(comparison); }, context);
  context.print([&] { return to_json(comparison); }, [&] { return to_text(comparison); });
}

void run_discretize(const CommandLine& line, const Options& options, Context& context) {
  if (!line.was_given("--dt"))
    refuse("discretize", "--dt", "--dt is missing, expected a sample period in seconds");
  require_positive(options.dt, "discretize", "--dt");
  require_picture(options.plot, "discretize");
  if (options.compare) {
    line.refuse_given({"--A", "--B", "--C", "--D", "--num", "--den", "--delay", "--method",
                       "--prewarp", "--input-delay", "--output-delay", "--inverse"},
                      "came with --compare, expected a vehicle alone because all methods are tried "
                      "on its closed loops");
    run_comparison(options, context);
    return;
  }
  line.refuse_given(
      {"V"},
      "came without --compare, expected it, or --A and --B or --num and --den for one system");
  line.refuse_given(
      {"--plant"},
      "came without --compare, expected it because a system of one's own is the plant");
  line.refuse_given({"--plot"},
                    "came without --compare, expected it because only the comparison is drawn");
  refuse_mixtures(line, options);
  run_system(options, context);
}

/// Of one system, and how it is sampled.
void add_system_options(CommandLine& line, Options& options) {
  line.add_option("--A FILE", options.A, "dynamics (nx x nx)");
  line.add_option("--B FILE", options.B, "inputs (nx x nu)");
  line.add_option("--C FILE", options.C, "outputs (ny x nx); the states");
  line.add_option("--D FILE", options.D, "feed-through (ny x nu); zero");
  line.add_option("--num LIST", options.num, "zeros' polynomial, highest power first");
  line.add_option("--den LIST", options.den, "poles' polynomial, likewise");
  line.add_number("--delay T", options.delay, "of --num/--den [s]");
  line.add_number("--dt T", options.dt, "sample period [s]");
  line.add_option("--method NAME", options.method,
                  "zoh (default), foh, impulse, euler, backward-euler, tustin or matched");
  line.add_number("--prewarp W", options.prewarp, "frequency at which tustin is exact [rad/s]");
  line.add_option("--input-delay LIST", options.input_delay, "of each input, or of all [s]");
  line.add_option("--output-delay LIST", options.output_delay, "of each output, or of all [s]");
  line.add_flag("--inverse", options.inverse,
                "the system is discrete; back to continuous by zoh or tustin");
}

void add_options(CommandLine& line, Options& options) {
  line.add_option("V", options.vehicle, "with --compare: a built-in vehicle or a file");
  line.add_flag("--compare", options.compare,
                "every method at T/2, T and 2 T on the vehicle's LQR and PID loops");
  line.add_option("--plant NAME", options.compared_plant,
                  "with --compare: flown (default) judges the laws as they run on the plant with "
                  "the sensors and the estimator as well; ideal does not");
  add_plot_option(line, options.plot);
  add_system_options(line, options);
}

}  // namespace

Verb discretize_verb() {
  return {"discretize",
          "--A FILE --B FILE [--C FILE --D FILE] | --num LIST --den LIST | V --compare, --dt T "
          "[--method NAME]",
          "sample a continuous system, or back; or compare the methods on a vehicle's loops",
          "quadtune discretize --A docs/examples/A.txt --B docs/examples/B.txt --dt 0.01 --method "
          "tustin",
          with_options(add_options, run_discretize)};
}

}  // namespace quadtune::cli
