// SPDX-License-Identifier: Apache-2.0
/// quadtune tune kalman: noise covariances from logs, with a verdict.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <optional>
#include <utility>

#include "arguments/log_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/progress.hpp"
#include "program/refusal.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/logs/filter_choice.hpp"
#include "quadtune/workbench/logs/noise_evidence.hpp"
#include "report/logs/logs.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string model, file, report, method = "ml";
  std::vector<std::string> logs, maps, truths, fixed, starts_at;
  LogArguments log;
  double holdout = 0.2;
  std::optional<double> gate, student;
  std::optional<double> budget;
  std::uint64_t starts = 3;
  bool profile = false, force = false;
};

FilterModel model_of(const Options& options) {
  if (options.model.empty())
    refuse("--model", "--model is missing, expected a filter model's name or file");
  FilterModel model = load_filter_model(options.model);
  FilterChoice choice{options.fixed, {}, options.gate.value_or(0), options.student.value_or(0)};
  choice.starts = named_numbers(options.starts_at, "start");
  return chosen_filter(std::move(model), choice);
}

void require_sane(const Options& options) {
  if (options.method == "als" && options.student)
    refuse("--student",
           "--student cannot be combined with --method als, because autocovariances require normal "
           "errors");
  if (!options.report.empty() && !options.report.ends_with(".html"))
    refuse("--report", "--report is '{}', expected a name that ends in .html",
           internal::printable(options.report));
  if (!options.report.empty() && options.report == options.file)
    refuse("--report", "--report and -o name the same file, expected two files");
  if (options.logs.empty()) refuse("--log", "--log is missing, expected a log of the sensors");
  if (!(options.holdout >= 0 && options.holdout <= 0.9))
    refuse("--holdout", "--holdout is {}, expected 0 to 0.9", options.holdout);
  for (const std::string& path : options.logs)
    if (path == "-")
      refuse("--log", "--log is -, expected a file, because it is read twice, once for its hash");
}

NoiseLogs read_logs(FilterModel model, const Options& options, const Context& context) {
  NoiseLogOptions logs{options.logs};
  logs.channels = named_words(options.maps, "map", "NAME", "CHANNEL");
  logs.reading = log_options(options.log);
  logs.truths = named_words(options.truths, "truth", "STATE", "CHANNEL");
  logs.note = notes_of(context);
  return read_noise_logs(std::move(model), logs);
}

TunedNoise tuned(NoiseLogs logs, NoiseMethod method, const Options& options,
                 const Context& context) {
  Progress progress(context, std::chrono::milliseconds(100));
  NoiseTuningOptions settings;
  settings.method = method;
  settings.holdout = options.holdout;
  if (options.budget) settings.seconds = *options.budget;
  settings.progress = [&](int round, int evaluations, double best) {
    progress.show(
        fmt::format("tune kalman: fit {}, {} evaluations, best log-likelihood {:.8g}, {:.0f} s",
                    round, evaluations, best, progress.seconds()));
  };
  settings.fit.starts = static_cast<int>(std::min<std::uint64_t>(options.starts, 1000));
  settings.fit.seed = context.seed;
  settings.fit.profile = options.profile;
  settings.fit.threads = context.threads;
  settings.fit.interrupted = interrupted;
  settings.keep_records = !options.report.empty();
  return tune_noise(std::move(logs), settings);
}

void run_tune_kalman(const Options& options, Context& context) {
  FilterModel model = model_of(options);
  const NoiseMethod method = noise_method(options.method);
  require_sane(options);
  NoiseLogs logs = read_logs(std::move(model), options, context);
  std::optional<KeepsTheBest> keeps_the_best(std::in_place);
  const TunedNoise noise = tuned(std::move(logs), method, options, context);
  const NoiseTuning& tuning = noise.tuning;
  if (tuning.fit.status == NoiseFitStatus::not_computed)
    throw NoSolution("tune kalman: " + tuning.fit.culprit, options.model);
  const bool passed = tuning.verdict == CheckVerdict::pass;
  // After an interrupt the best result is still printed and written, which takes little time.
  const bool ended = tuning.fit.status == NoiseFitStatus::interrupted || interrupted();
  const std::function<bool()> stop = ended ? nullptr : std::function<bool()>(interrupted);
  // Printed before files are written, so that a failing write does not lose the result of a long
  // search.
  context.print([&] { return to_json(noise); }, [&] { return to_text(noise); });
  context.out << std::flush;
  context.answered = true;
  if (!options.file.empty() && (passed || options.force))
    context.write(options.file, tuned_model_file(noise, context.command), stop);
  keeps_the_best.reset();  // the result is printed: the page may be abandoned at any time
  if (!options.report.empty() && !ended) {
    const NoiseEvidence evidence =
        noise_evidence(noise, options.holdout, context.threads, interrupted);
    context.write(options.report, html(page_of(noise, evidence, context.seed, context.command)));
  }
  if (ended) throw Interrupted();
  if (!passed)
    throw AnswerIsNo(tuning.reasons.front() + so_not_written(options.file, options.force));
}

void add_options(CommandLine& line, Options& options) {
  line.add_option("--model NAME|FILE", options.model, "a built-in filter model, or a file");
  line.add_list("--log FILE", options.logs, "log of the sensors; repeat the option for several");
  line.add_list("--map NAME=CHANNEL", options.maps,
                "channel of an input or measurement that has another name in the log; CHANNEL@FILE "
                "for another log of the same flight");
  line.add_list("--truth STATE=CHANNEL", options.truths,
                "channel of the true value of a state, or of the attitude as qw qx qy qz; the "
                "errors of the filter are computed from it and reported in its units");
  line.add_option("--method ml|als", options.method,
                  "ml (default): maximum likelihood; als: least squares of the autocovariances of "
                  "the innovations");
  line.add_list("--fix NAME", options.fixed, "keep a parameter fixed");
  line.add_list("--start NAME=NUMBER", options.starts_at, "variance at which the search starts");
  add_log_options(line, options.log);
  line.add_number("--holdout SHARE", options.holdout,
                  "fraction at the end of each log that is held out for the verdict; default 0.2");
  line.add_positive("--gate LIMIT", options.gate,
                    "reject measurements whose squared innovation exceeds this many variances");
  line.add_positive("--student NU", options.student,
                    "degrees of freedom of a Student distribution of the measurement errors");
  line.add_count("--starts N", options.starts, 1,
                 "number of searches from different starts; default 3");
  line.add_positive(
      "--budget S", options.budget,
      "maximum time of the search [s], which then returns the best result; default: unlimited");
  line.add_flag("--profile", options.profile,
                "compute intervals from the profile of the likelihood, not from its curvature");
  line.add_option("-o FILE", options.file,
                  "file for the tuned model, written if the verdict is pass");
  line.add_option("--report FILE", options.report, "write a web page: a .html file");
  line.add_flag("--force", options.force,
                "write the model whatever the verdict; the file states it");
}

}  // namespace

Verb tune_kalman_verb() {
  return {"tune kalman", "--model NAME|FILE --log FILE... [--map NAME=CHANNEL]...",
          "estimate a filter's noise covariances from logs, with a verdict",
          "quadtune tune kalman --model altitude --log docs/examples/bobbing.csv",
          with_options(add_options, run_tune_kalman)};
}

}  // namespace quadtune::cli
