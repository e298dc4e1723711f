// SPDX-License-Identifier: Apache-2.0
/// quadtune allan: the noises of a still sensor.
#include <fmt/format.h>

#include <memory>
#include <ostream>

#include "arguments/log_arguments.hpp"
#include "arguments/plot_argument.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/workbench/logs/allan_of_log.hpp"
#include "report/logs/allan_report.hpp"
#include "report/plots/allan_figure.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string log, column, unit;
  std::string taus = "octaves";
  SensorLogArguments sensors;
  bool simulate = false, phase = false;
  PlotArgument plot;
};

[[noreturn]] void refuse(const char* option, const std::string& why) {
  throw UsageError(fmt::format("quadtune allan: {}", why), option);
}

AllanTaus taus_of(const std::string& name) {
  if (name == "octaves") return AllanTaus::octaves;
  if (name == "decades") return AllanTaus::decades;
  if (name == "all") return AllanTaus::all;
  refuse("--taus", fmt::format("--taus is '{}', expected octaves, decades or all{}", name,
                               internal::did_you_mean(name, {"octaves", "decades", "all"})));
}

SensorAllan analysed(const Options& options, AllanTaus taus, const Context& context) {
  if (options.simulate) {
    if (!options.log.empty() || !options.column.empty() || options.sensors.given() || options.phase)
      refuse("--simulate",
             "--simulate came with a log or its options, expected it alone, because it makes the "
             "record up");
    return allan_of_made_up(context.seed, options.unit, taus);
  }
  if (options.log.empty()) refuse("--log", "--log is missing, expected the log of a still sensor");
  if (options.column.empty())
    refuse("--column", "--column is missing, expected the name or number of a column");
  const AllanOptions allan{options.log,
                           options.column,
                           options.unit,
                           options.phase,
                           taus,
                           sensor_log_options(options.sensors, "allan"),
                           notes_of("allan", context)};
  return option_of_logs("allan", [&] { return allan_of_log(allan); });
}

}  // namespace

Verb allan_verb() {
  return {"allan", "--log FILE --column NAME|N (--rate HZ | --time COLUMN) [--unit U] [--phase]",
          "read a still sensor's noises off its Allan deviation",
          "quadtune allan --simulate --taus decades", [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            line.add_option("--log", options->log,
                            "log of a still sensor, of any format that quadtune log reads")
                ->type_name("FILE");
            line.add_option("--column", options->column,
                            "its channel, by name, or by number from 1 of a text")
                ->type_name("NAME|N");
            add_sensor_log_options(line, options->sensors);
            line.add_option("--unit", options->unit,
                            "of the column, e.g. rad/s, deg/s, m/s^2; the header's")
                ->type_name("U");
            line.add_flag("--phase", options->phase,
                          "the column is a phase, the rate's integral: an angle, a clock's error");
            line.add_option("--taus", options->taus, "octaves (default), decades or all")
                ->type_name("WHICH");
            line.add_flag("--simulate", options->simulate,
                          "a made-up gyroscope of 1e-4 rad/s/sqrt(Hz) and 2e-5 rad/s^2/sqrt(Hz) "
                          "instead of a log");
            add_plot_option(line, options->plot);
            return [options](Context& context) {
              require_picture(options->plot, "allan");
              const AllanTaus taus = taus_of(options->taus);
              const SensorAllan allan = analysed(*options, taus, context);
              draw(
                  options->plot, [&] { return allan_figure(allan); }, context);
              context.out << (context.json ? internal::readable(to_json(allan)) + "\n"
                                           : to_text(allan));
            };
          }};
}

}  // namespace quadtune::cli
