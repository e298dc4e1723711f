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

constexpr const char* kVerb = "tune";  ///< in messages

struct Options {
  std::string model, file, report, method = "ml";
  std::vector<std::string> logs, maps, truths, fixed, starts_at;
  LogArguments log;
  double holdout = 0.2;
  double gate = 0, student = 0;
  std::optional<double> budget;
  std::uint64_t starts = 3;
  bool profile = false, force = false;
};

FilterModel model_of(const Options& options) {
  if (options.model.empty())
    refuse(kVerb, "--model", "--model is missing, expected a filter model's name or file");
  FilterModel model = load_filter_model(options.model);
  FilterChoice choice{options.fixed, {}, options.gate, options.student};
  choice.starts =
      option_of_command(kVerb, [&] { return named_numbers(options.starts_at, "start"); });
  return chosen_filter(std::move(model), choice);
}

void require_sane(const Options& options) {
  if (!options.report.empty() && !options.report.ends_with(".html"))
    refuse(kVerb, "--report", "--report is '{}', expected a name that ends in .html",
           internal::printable(options.report));
  if (!options.report.empty() && options.report == options.file)
    refuse(kVerb, "--report", "--report and -o are one file, expected two");
  if (options.logs.empty())
    refuse(kVerb, "--log", "--log is missing, expected a log of the sensors");
  if (!(options.holdout >= 0 && options.holdout <= 0.9))
    refuse(kVerb, "--holdout", "--holdout is {}, expected 0 to 0.9", options.holdout);
  for (const std::string& path : options.logs)
    if (path == "-")
      refuse(kVerb, "--log",
             "--log is -, expected a file because it is read twice, once for its hash");
}

NoiseLogs read_logs(FilterModel model, const Options& options, const Context& context) {
  NoiseLogOptions logs{options.logs};
  option_of_command(kVerb,
                    [&] { logs.channels = named_words(options.maps, "map", "NAME", "CHANNEL"); });
  logs.reading = log_options(options.log, kVerb);
  option_of_command(
      kVerb, [&] { logs.truths = named_words(options.truths, "truth", "STATE", "CHANNEL"); });
  logs.note = notes_of(kVerb, context);
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
    progress.show(fmt::format("tune: fit {}, {} evaluations, best log-likelihood {:.8g}, {:.0f} s",
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
  const NoiseMethod method = option_of_command(kVerb, [&] { return noise_method(options.method); });
  require_sane(options);
  NoiseLogs logs = read_logs(std::move(model), options, context);
  std::optional<KeepsTheBest> keeps_the_best(std::in_place);
  const TunedNoise noise = tuned(std::move(logs), method, options, context);
  const NoiseTuning& tuning = noise.tuning;
  if (tuning.fit.status == NoiseFitStatus::not_computed)
    throw NoSolution("tune: " + tuning.fit.culprit, options.model);
  const bool passed = tuning.verdict == CheckVerdict::pass;
  // After an interrupt what was found is still told and written: that is little work.
  const bool ended = tuning.fit.status == NoiseFitStatus::interrupted || interrupted();
  const std::function<bool()> stop = ended ? nullptr : std::function<bool()>(interrupted);
  // First, so that a file that cannot be written does not take a long search with it.
  context.print([&] { return to_json(noise); }, [&] { return to_text(noise); });
  context.out << std::flush;
  context.answered = true;
  if (!options.file.empty() && (passed || options.force))
    context.write(options.file, tuned_model_file(noise, context.command), stop);
  keeps_the_best.reset();  // what was found is told: the page may be given up at any time
  if (!options.report.empty() && !ended) {
    const NoiseEvidence evidence =
        noise_evidence(noise, options.holdout, context.threads, interrupted);
    context.write(options.report, html(page_of(noise, evidence, context.seed, context.command)));
  }
  if (ended) throw Interrupted();
  if (!passed) throw AnswerIsNo("tune: " + tuning.reasons.front());
}

void add_options(CommandLine& line, Options& options) {
  line.add_option("--model NAME|FILE", options.model, "a built-in filter model, or a file");
  line.add_list("--log FILE", options.logs, "a log; several: repeat the option");
  line.add_list("--map NAME=CHANNEL", options.maps,
                "the channel of an input or measurement that is called otherwise, of another log "
                "of the same flight as CHANNEL@FILE");
  line.add_list("--truth STATE=CHANNEL", options.truths,
                "the channel of what a state truly was, or of the attitude as qw qx qy qz: the "
                "filter's errors are judged by it and told in its units");
  line.add_option("--method ml|als", options.method,
                  "ml: most likely; als: least squares of the innovations' autocovariances; ml");
  line.add_list("--fix NAME", options.fixed, "leave a parameter as it is");
  line.add_list("--start NAME=NUMBER", options.starts_at,
                "the variance that the search begins with");
  add_log_options(line, options.log);
  line.add_number("--holdout SHARE", options.holdout,
                  "share of each log, its end, that is kept for the verdict; 0.2");
  line.add_number("--gate LIMIT", options.gate,
                  "refuse measurements whose squared innovation is more variances than this");
  line.add_number("--student NU", options.student,
                  "degrees of freedom of measurement errors with long tails");
  line.add_count("--starts N", options.starts, 1, "searches from different starts; 3");
  line.add_positive("--budget S", options.budget,
                    "seconds after which the search ends with the best it has; no end");
  line.add_flag("--profile", options.profile,
                "intervals by the likelihood's profile, not by its curvature");
  line.add_option("-o FILE", options.file, "the tuned model, where the verdict is pass");
  line.add_option("--report FILE", options.report, "write a page to look at: a .html file");
  line.add_flag("--force", options.force, "write it whatever the verdict; it says so");
}

}  // namespace

Verb tune_kalman_verb() {
  return {"tune kalman", "--model NAME|FILE --log FILE... [--map NAME=CHANNEL]...",
          "find a filter's noise covariances from logs, with a verdict",
          "quadtune tune kalman --model altitude --log docs/examples/bobbing.csv",
          with_options(add_options, run_tune_kalman)};
}

}  // namespace quadtune::cli
