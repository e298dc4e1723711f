// SPDX-License-Identifier: Apache-2.0
/// quadtune discretize: one system by one method, or back.
#include "quadtune/discretize/discretize.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <ostream>

#include "arguments/matrix_arguments.hpp"
#include "arguments/plant_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/discretize/sample_time.hpp"
#include "quadtune/discretize/to_continuous.hpp"
#include "quadtune/internal/json.hpp"
#include "report/loops/method_comparison.hpp"
#include "report/text/print.hpp"
#include "arguments/plot_argument.hpp"

namespace quadtune::cli {
namespace {

using internal::Json;

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

/// What was asked for, checked.
struct Task {
  DiscretizationMethod method;
  DiscretizationOptions options;
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

std::optional<double> read_prewarp(const Options& options, DiscretizationMethod method) {
  if (!options.has_prewarp) return {};
  if (method != DiscretizationMethod::tustin)
    refuse("--prewarp", fmt::format("came with --method {}, expected tustin because only it bends "
                                    "frequencies in a way that this undoes",
                                    options.method));
  const double nyquist = std::numbers::pi / options.dt;
  if (!(options.prewarp > 0 && options.prewarp < nyquist))
    refuse("--prewarp",
           fmt::format("is {:.6g} rad/s, expected more than 0 and less than {:.6g} rad/s "
                       "(pi/dt) because samples do not show other frequencies",
                       options.prewarp, nyquist));
  return options.prewarp;
}

Eigen::VectorXd read_list(const std::string& text, const std::string& option) {
  const std::vector<double> numbers = number_list(text, "discretize", option);
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), std::ssize(numbers));
}

/// Seconds for each of `count` channels; one number stands for all.
Eigen::VectorXd read_delays(const std::string& text, const std::string& option, Eigen::Index count,
                            const std::string& channels) {
  if (text.empty()) return {};
  Eigen::VectorXd delays = read_list(text, option);
  for (const double delay : delays)
    if (delay < 0)
      refuse(option,
             fmt::format("has {} s, expected 0 or more because the future is not known", delay));
  if (delays.size() == 1) return Eigen::VectorXd::Constant(count, delays[0]);
  if (delays.size() != count)
    refuse(option, fmt::format("has {} entries, expected {} or one for all {}", delays.size(),
                               count, channels));
  return delays;
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

double read_delay(const Options& options) {
  if (options.delay < 0)
    refuse("--delay", fmt::format("is {} s, expected 0 or more because the future is not known",
                                  options.delay));
  return options.delay;
}

int delay_in_samples(const Options& options) {
  const double samples = read_delay(options) / options.dt;
  if (std::abs(samples - std::round(samples)) > 1e-9 || samples > 1e9)
    refuse("--delay", fmt::format("is {} s, expected a whole number of samples of {} s because the "
                                  "plant is discrete",
                                  options.delay, options.dt));
  return static_cast<int>(std::round(samples));
}

// --- printing ------------------------------------------------------------------------------------

void warn(const std::vector<std::string>& warnings, const Context& context) {
  for (const std::string& warning : warnings) context.note("discretize: warning: " + warning);
}

void finish(Json json, const Options& options, const std::vector<std::string>& warnings,
            Context& context) {
  json["dt"] = options.dt;
  json["method"] = options.method;
  if (options.inverse) json["inverse"] = true;
  json["warnings"] = warnings;
  context.out << internal::readable(json) << "\n";
}

std::string how(const Options& options) {
  return number(options.dt) + " s, " + options.method + (options.inverse ? ", to continuous" : "");
}

/// Names of states are told where delays have added to them.
template <class Lti>
void print(const Lti& plant, const Options& options, const std::vector<std::string>& warnings,
           Context& context) {
  warn(warnings, context);
  if (context.json) {
    Json json;
    json["A"] = internal::matrix_to_json(plant.A, "A");
    json["B"] = internal::matrix_to_json(plant.B, "B");
    json["C"] = internal::matrix_to_json(plant.C, "C");
    json["D"] = internal::matrix_to_json(plant.D, "D");
    if (!plant.states.empty())
      json["states"] = names_or_numbers(plant.states, std::ssize(plant.states));
    finish(std::move(json), options, warnings, context);
    return;
  }
  context.out << section("A", plain(plant.A)) << section("B", plain(plant.B))
              << section("C", plain(plant.C)) << section("D", plain(plant.D));
  if (!plant.states.empty()) context.out << section("states", names(plant.states));
  context.out << section("dt", how(options));
}

void print(const Eigen::VectorXd& num, const Eigen::VectorXd& den, const std::string& delay_key,
           const Json& delay, const Options& options, const std::vector<std::string>& warnings,
           Context& context) {
  warn(warnings, context);
  if (context.json) {
    Json json;
    json["num"] = internal::vector_to_json(num, "num");
    json["den"] = internal::vector_to_json(den, "den");
    json[delay_key] = delay;
    finish(std::move(json), options, warnings, context);
    return;
  }
  context.out << section("num", plain(num.transpose())) << section("den", plain(den.transpose()));
  if (delay != 0)
    context.out << section("delay", delay_key == "delay_s"
                                        ? number(delay.get<double>()) + " s"
                                        : internal::json_text(delay) + " samples");
  context.out << section("dt", how(options));
}

// --- running -------------------------------------------------------------------------------------

void run_fraction(const Options& options, const Task& task, Context& context) {
  if (options.inverse) {
    auto plant = read_fraction<DiscreteTransferFunction>(options);
    plant.dt = options.dt;
    plant.delay = delay_in_samples(options);
    const ContinuousTransferFunction result =
        to_continuous(plant, task.method, task.options.prewarp);
    print(result.num, result.den, "delay_s", result.delay, options, {}, context);
    return;
  }
  auto plant = read_fraction<ContinuousTransferFunction>(options);
  plant.delay = read_delay(options);
  const DiscreteTransferFunction result = discretize(plant, options.dt, task.method, task.options);
  print(result.num, result.den, "delay_samples", result.delay, options,
        sample_time_warnings(plant, options.dt), context);
}

void run_matrices(const Options& options, Task task, Context& context) {
  if (options.inverse) {
    auto plant = read_plant<DiscreteLti>(options, context.in);
    plant.dt = options.dt;
    print(to_continuous(plant, task.method, task.options.prewarp), options, {}, context);
    return;
  }
  const auto plant = read_plant<ContinuousLti>(options, context.in);
  task.options.delays = {
      read_delays(options.input_delay, "--input-delay", plant.B.cols(), "inputs"),
      read_delays(options.output_delay, "--output-delay", plant.C.rows(), "outputs")};
  const DiscreteLti result = discretize(plant, options.dt, task.method, task.options);
  print(result, options, sample_time_warnings(plant, options.dt), context);
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
  const MethodComparison comparison = compare_methods(options.vehicle, options.dt, flown);
  draw(options.plot, comparison.figure, context);
  context.out << (context.json ? internal::readable(comparison.json) + "\n" : comparison.text);
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
  Task task{discretization_method(options.method, "--method"), {}};
  if (options.inverse && task.method != DiscretizationMethod::zoh &&
      task.method != DiscretizationMethod::tustin)
    refuse("--inverse", fmt::format("came with --method {}, expected zoh or tustin, whose way back "
                                    "is built",
                                    options.method));
  task.options.prewarp = read_prewarp(options, task.method);
  if (options.is_fraction())
    run_fraction(options, task, context);
  else
    run_matrices(options, task, context);
}

}  // namespace

Verb discretize_verb() {
  return {
      "discretize",
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
        line.add_option("--A", options->A, "dynamics (nx x nx)")->type_name("FILE");
        line.add_option("--B", options->B, "inputs (nx x nu)")->type_name("FILE");
        line.add_option("--C", options->C, "outputs (ny x nx); the states")->type_name("FILE");
        line.add_option("--D", options->D, "feed-through (ny x nu); zero")->type_name("FILE");
        line.add_option("--num", options->num, "zeros' polynomial, highest power first")
            ->type_name("LIST");
        line.add_option("--den", options->den, "poles' polynomial, likewise")->type_name("LIST");
        Option* delay =
            line.add_number("--delay", options->delay, "of --num/--den [s]")->type_name("T");
        Option* dt = line.add_number("--dt", options->dt, "sample period [s]")->type_name("T");
        line.add_option("--method", options->method,
                        "zoh (default), foh, impulse, euler, backward-euler, tustin or matched")
            ->type_name("NAME");
        Option* prewarp = line.add_number("--prewarp", options->prewarp,
                                          "frequency at which tustin is exact [rad/s]")
                              ->type_name("W");
        line.add_option("--input-delay", options->input_delay, "of each input, or of all [s]")
            ->type_name("LIST");
        line.add_option("--output-delay", options->output_delay, "of each output, or of all [s]")
            ->type_name("LIST");
        line.add_flag("--inverse", options->inverse,
                      "the system is discrete; back to continuous by zoh or tustin");
        return [options, dt, delay, prewarp, owner = &line](Context& context) {
          if (!dt->was_given())
            throw UsageError(
                "quadtune discretize: --dt is missing, expected a sample period "
                "in seconds",
                "--dt");
          options->has_delay = delay->was_given();
          options->has_prewarp = prewarp->was_given();
          run_discretize(*options, *owner, context);
        };
      }};
}

}  // namespace quadtune::cli
