// SPDX-License-Identifier: Apache-2.0
/// quadtune tune kalman: noise covariances from logs, with a verdict.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <ostream>
#include <utility>

#include "arguments/log_arguments.hpp"
#include "arguments/read_number.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/logs/filter_choice.hpp"
#include "quadtune/workbench/logs/noise_evidence.hpp"
#include "report/logs/noise_tuning_page.hpp"
#include "report/logs/noise_tuning_report.hpp"

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

[[noreturn]] void refuse(const char* option, const std::string& why) {
  throw UsageError(fmt::format("quadtune {}: {}", kVerb, why), option);
}

NoiseMethod noise_method(const std::string& name) {
  if (name == "ml") return NoiseMethod::likelihood;
  if (name == "als") return NoiseMethod::autocovariances;
  refuse("--method",
         fmt::format("--method: '{}' came, expected ml or als", internal::printable(name)));
}

/// NAME=WORD.
std::pair<std::string, std::string> named_word(const std::string& text, const char* option,
                                               const char* name, const char* word) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    refuse(option, fmt::format("{}: '{}' came, expected {}={}", option, internal::printable(text),
                               name, word));
  return {text.substr(0, equals), text.substr(equals + 1)};
}

std::vector<NamedChannel> named_channels(const std::vector<std::string>& texts, const char* option,
                                         const char* name) {
  std::vector<NamedChannel> result;
  result.reserve(texts.size());
  for (const std::string& text : texts) result.push_back(named_word(text, option, name, "CHANNEL"));
  return result;
}

FilterChoice choice_of(const Options& options) {
  FilterChoice choice{options.fixed, {}, options.gate, options.student};
  for (const std::string& text : options.starts_at) {
    const auto [name, word] = named_word(text, "--start", "NAME", "NUMBER");
    double value = 0;
    if (!read_number(word, value))
      refuse("--start", fmt::format("--start: '{}' came for {}, expected a number",
                                    internal::printable(word), name));
    choice.starts.emplace_back(name, value);
  }
  return choice;
}

FilterModel model_of(const Options& options) {
  if (options.model.empty())
    refuse("--model", "--model is missing, expected a filter model's name or file");
  FilterModel model = load_filter_model(options.model);
  return chosen_filter(std::move(model), choice_of(options));
}

void require_sane(const Options& options) {
  if (!options.report.empty() && !options.report.ends_with(".html"))
    refuse("--report", fmt::format("--report is '{}', expected a name that ends in .html",
                                   internal::printable(options.report)));
  if (!options.report.empty() && options.report == options.file)
    refuse("--report", "--report and -o are one file, expected two");
  if (options.logs.empty()) refuse("--log", "--log is missing, expected a log of the sensors");
  if (!(options.holdout >= 0 && options.holdout <= 0.9))
    refuse("--holdout", fmt::format("--holdout is {}, expected 0 to 0.9", options.holdout));
  for (const std::string& path : options.logs)
    if (path == "-")
      refuse("--log", "--log is -, expected a file because it is read twice, once for its hash");
}

NoiseLogs read_logs(FilterModel model, const Options& options, const Context& context) {
  NoiseLogOptions logs{options.logs};
  logs.channels = named_channels(options.maps, "--map", "NAME");
  logs.reading = log_options(options.log, kVerb);
  logs.truths = named_channels(options.truths, "--truth", "STATE");
  logs.note = notes_of(kVerb, context);
  return read_noise_logs(std::move(model), logs);
}

/// One line that is written over while the search goes on; on a terminal only.
class Progress {
 public:
  explicit Progress(const Context& context)
      : shown_(!context.quiet && !context.json && isatty(STDERR_FILENO) != 0),
        err_(context.err),
        begin_(Clock::now()),
        next_(begin_) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() {
    if (drawn_) err_ << "\r\033[K" << std::flush;
  }

  void show(int round, int evaluations, double best) {
    const Clock::time_point now = Clock::now();
    if (!shown_ || now < next_) return;
    next_ = now + std::chrono::milliseconds(100);
    err_ << fmt::format(
                "\r\033[Ktune: fit {}, {} evaluations, best log-likelihood {:.8g}, {:.0f} s", round,
                evaluations, best, std::chrono::duration<double>(now - begin_).count())
         << std::flush;
    drawn_ = true;
  }

 private:
  using Clock = std::chrono::steady_clock;
  bool shown_, drawn_ = false;
  std::ostream& err_;
  Clock::time_point begin_, next_;
};

NoiseTuningOptions tuning_of(const Options& options, const Context& context, Progress& progress) {
  NoiseTuningOptions settings;
  settings.method = noise_method(options.method);
  settings.holdout = options.holdout;
  if (options.budget) settings.seconds = *options.budget;
  settings.progress = [&](int round, int evaluations, double best) {
    progress.show(round, evaluations, best);
  };
  settings.fit.starts = static_cast<int>(std::min<std::uint64_t>(options.starts, 1000));
  settings.fit.seed = context.seed;
  settings.fit.profile = options.profile;
  settings.fit.threads = context.threads;
  settings.fit.interrupted = interrupted;
  settings.keep_records = !options.report.empty();
  return settings;
}

TunedNoise tuned(NoiseLogs logs, const Options& options, const Context& context) {
  Progress progress(context);
  return tune_noise(std::move(logs), tuning_of(options, context, progress));
}

void run(const Options& options, Context& context) {
  FilterModel model = model_of(options);
  (void)noise_method(options.method);  // refused before a long log is read
  require_sane(options);
  NoiseLogs logs = read_logs(std::move(model), options, context);
  std::optional<KeepsTheBest> keeps_the_best(std::in_place);
  const TunedNoise noise = tuned(std::move(logs), options, context);
  const NoiseTuning& tuning = noise.tuning;
  if (tuning.fit.status == NoiseFitStatus::not_computed)
    throw NoSolution("tune: " + tuning.fit.culprit, options.model);
  const bool passed = tuning.verdict == CheckVerdict::pass;
  // After an interrupt what was found is still told and written: that is little work.
  const bool ended = tuning.fit.status == NoiseFitStatus::interrupted || interrupted();
  const std::function<bool()> stop = ended ? nullptr : std::function<bool()>(interrupted);
  // First, so that a file that cannot be written does not take a long search with it.
  context.out << (context.json ? internal::readable(to_json(noise)) + "\n" : to_text(noise))
              << std::flush;
  context.answered = true;
  if (!options.file.empty() && (passed || options.force)) {
    write_file(options.file, tuned_model_file(noise, context.command), stop);
    context.written.push_back(options.file);
  }
  keeps_the_best.reset();  // what was found is told: the page may be given up at any time
  if (!options.report.empty() && !ended) {
    const NoiseEvidence evidence =
        noise_evidence(noise, options.holdout, context.threads, interrupted);
    write_file(options.report, html(page_of(noise, evidence, context.seed, context.command)));
    context.written.push_back(options.report);
  }
  if (ended) throw Interrupted();
  if (!passed) throw AnswerIsNo("tune: " + tuning.reasons.front());
}

void add_options(CommandLine& line, Options& options) {
  line.add_option("--model", options.model, "a built-in filter model, or a file")
      ->type_name("NAME|FILE");
  const auto many = [&line](const char* name, std::vector<std::string>& into,
                            const char* description, const char* type) {
    line.add_list(name, into, description)->type_name(type);
  };
  many("--log", options.logs, "a log; several: repeat the option", "FILE");
  many("--map", options.maps,
       "the channel of an input or measurement that is called otherwise, of another log of "
       "the same flight as CHANNEL@FILE",
       "NAME=CHANNEL");
  many("--truth", options.truths,
       "the channel of what a state truly was, or of the attitude as qw qx qy qz: the filter's "
       "errors are judged by it and told in its units",
       "STATE=CHANNEL");
  line.add_option("--method", options.method,
                  "ml: most likely; als: least squares of the innovations' autocovariances; ml")
      ->type_name("ml|als");
  many("--fix", options.fixed, "leave a parameter as it is", "NAME");
  many("--start", options.starts_at, "the variance that the search begins with", "NAME=NUMBER");
  add_log_options(line, options.log);
  line.add_number("--holdout", options.holdout,
                  "share of each log, its end, that is kept for the verdict; 0.2")
      ->type_name("SHARE");
  line.add_number("--gate", options.gate,
                  "refuse measurements whose squared innovation is more variances than this")
      ->type_name("LIMIT");
  line.add_number("--student", options.student,
                  "degrees of freedom of measurement errors with long tails")
      ->type_name("NU");
  line.add_count("--starts", options.starts, 1, "searches from different starts; 3")
      ->type_name("N");
  line.add_positive("--budget", options.budget,
                    "seconds after which the search ends with the best it has; no end")
      ->type_name("S");
  line.add_flag("--profile", options.profile,
                "intervals by the likelihood's profile, not by its curvature");
  line.add_option("-o", options.file, "the tuned model, where the verdict is pass")
      ->type_name("FILE");
  line.add_option("--report", options.report, "write a page to look at: a .html file")
      ->type_name("FILE");
  line.add_flag("--force", options.force, "write it whatever the verdict; it says so");
}

}  // namespace

Verb tune_kalman_verb() {
  return {"tune kalman", "--model NAME|FILE --log FILE... [--map NAME=CHANNEL]...",
          "find a filter's noise covariances from logs, with a verdict",
          "quadtune tune kalman --model altitude --log docs/examples/bobbing.csv",
          [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            add_options(line, *options);
            return [options](Context& context) { run(*options, context); };
          }};
}

}  // namespace quadtune::cli
