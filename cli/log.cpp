// SPDX-License-Identifier: Apache-2.0
/// quadtune log: the contents of a log, and anomalies in it.

#include "arguments/log_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/estimation/model_needs.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/logs/log_survey.hpp"
#include "quadtune/workbench/logs/log_notes.hpp"
#include "report/logs/logs.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string file;
  LogArguments log;
};

void run_log(const Options& options, Context& context) {
  if (options.file.empty())
    refuse("FILE", "FILE is missing, expected a log, or - for standard input");
  const std::unique_ptr<LogReader> reader = open_log(options.file, log_options(options.log));
  const LogSurvey survey = survey_log(*reader);
  std::vector<ModelNeeds> models;
  for (const ModelSignals& model : signals_of_built_in_models())
    models.push_back(model_needs(model, survey));
  context.print([&] { return to_json(survey, models, options.file); },
                [&] { return to_text(survey, models, options.file); });
  context.notes("warning: ", log_warnings(survey.condition));
}

void add_options(CommandLine& line, Options& options) {
  line.add_option("FILE", options.file, "a log; - is standard input");
  add_log_options(line, options.log);
}

}  // namespace

Verb log_verb() {
  return {"log", "FILE [--format NAME] [--columns LIST] [--rate HZ]",
          "list the contents of a log, its anomalies, and what each filter model needs of it",
          "quadtune log docs/examples/flight.csv", with_options(add_options, run_log)};
}

}  // namespace quadtune::cli
