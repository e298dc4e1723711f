// SPDX-License-Identifier: Apache-2.0
/// quadtune log: what is in a log, and what is odd about it.
#include <memory>
#include <ostream>

#include "arguments/log_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/estimation/model_needs.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/logs/log_survey.hpp"
#include "quadtune/workbench/logs/log_notes.hpp"
#include "report/logs/log_report.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string file;
  LogArguments log;
};

void run(const Options& options, Context& context) {
  if (options.file.empty())
    throw UsageError("quadtune log: FILE is missing, expected a log, or - for standard input",
                     "FILE");
  const std::unique_ptr<LogReader> reader = open_log(options.file, log_options(options.log, "log"));
  const LogSurvey survey = survey_log(*reader);
  std::vector<ModelNeeds> models;
  for (const ModelSignals& model : signals_of_built_in_models())
    models.push_back(needs_of_model(model, survey));
  context.out << (context.json ? internal::readable(to_json(survey, models, options.file)) + "\n"
                               : to_text(survey, models, options.file));
  for (const std::string& warning : log_warnings(survey.condition))
    context.note("log: warning: " + warning);
}

}  // namespace

Verb log_verb() {
  return {"log", "FILE [--format NAME] [--columns LIST] [--rate HZ]",
          "what is in a log, what is odd about it, and which filter models it feeds",
          "quadtune log docs/examples/flight.csv", [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            line.add_option("FILE", options->file, "a log; - is standard input");
            add_log_options(line, options->log);
            return [options](Context& context) { run(*options, context); };
          }};
}

}  // namespace quadtune::cli
