// SPDX-License-Identifier: Apache-2.0
/// quadtune allan: noise of a stationary sensor.
#include "arguments/log_arguments.hpp"
#include "arguments/plot_argument.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/logs/allan_of_log.hpp"
#include "report/logs/logs.hpp"
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

SensorAllan analysed(const Options& options, AllanTaus taus, const Context& context) {
  if (options.simulate) {
    if (!options.log.empty() || !options.column.empty() || options.sensors.given() || options.phase)
      refuse(
          "--simulate",
          "--simulate cannot be combined with --log or its options, because it simulates the log");
    return allan_of_simulated(context.seed, options.unit, taus);
  }
  if (options.log.empty())
    refuse("--log", "--log is missing, expected the log of a stationary sensor");
  if (options.column.empty())
    refuse("--column", "--column is missing, expected the name or number of a column");
  const AllanOptions allan{options.log,      options.column, options.unit,
                           options.phase,    taus,           sensor_log_options(options.sensors),
                           notes_of(context)};
  return allan_of_log(allan);
}

void add_options(CommandLine& line, Options& options) {
  line.add_option("--log FILE", options.log,
                  "log of a stationary sensor, of any format that `quadtune log` reads");
  line.add_option("--column NAME|N", options.column,
                  "its channel, by name, or by number from 1 in a text");
  add_sensor_log_options(line, options.sensors);
  line.add_option("--unit U", options.unit,
                  "unit of the column, e.g. rad/s, deg/s, m/s^2; default: that of the header");
  line.add_flag("--phase", options.phase,
                "the column is a phase, the integral of the rate: an angle, the error of a clock");
  line.add_option("--taus WHICH", options.taus, "octaves (default), decades or all");
  line.add_flag(
      "--simulate", options.simulate,
      "simulate a gyroscope of 1e-4 rad/s/sqrt(Hz) and 2e-5 rad/s^2/sqrt(Hz) instead of a log");
  add_plot_option(line, options.plot);
}

void run_allan(const Options& options, Context& context) {
  require_picture(options.plot);
  const AllanTaus taus = allan_taus(options.taus);
  const SensorAllan allan = analysed(options, taus, context);
  draw(
      options.plot, [&] { return allan_figure(allan); }, context);
  context.print([&] { return to_json(allan); }, [&] { return to_text(allan); });
}

}  // namespace

Verb allan_verb() {
  return {"allan", "--log FILE --column NAME|N [--rate HZ | --time COLUMN] [--unit U] [--phase]",
          "estimate the noise of a stationary sensor from its Allan deviation",
          "quadtune allan --simulate --taus decades", with_options(add_options, run_allan)};
}

}  // namespace quadtune::cli
