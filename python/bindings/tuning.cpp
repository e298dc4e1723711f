// SPDX-License-Identifier: Apache-2.0
/// Noise covariances from logs.
#include <fmt/format.h>

#include <map>

#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/logs/filter_choice.hpp"
#include "quadtune/workbench/logs/tuned_noise.hpp"
#include "report/logs/logs.hpp"
#include "support/arguments.hpp"
#include "support/interrupts.hpp"
#include "support/results.hpp"
#include "support/topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using Texts = std::map<std::string, std::string>;
using Values = std::map<std::string, double>;

TunedNoise tune_filter(const Path& model, const std::vector<Path>& logs, const Texts& map,
                       const Texts& truth, const std::string& method, const Names& fix,
                       const Values& start, double holdout, double gate, double student,
                       std::uint32_t starts, std::optional<double> budget, bool profile,
                       const std::string& format, const std::string& columns,
                       std::optional<double> rate, std::uint64_t seed, std::size_t threads) {
  if (logs.empty()) throw OptionError("logs", "logs is empty, expected a log of the sensors");
  if (!(holdout >= 0 && holdout <= 0.9))
    throw OptionError("holdout", fmt::format("holdout is {}, expected 0 to 0.9", holdout));
  if (starts < 1 || starts > 1000)
    throw OptionError("starts", fmt::format("starts is {}, expected 1 to 1000", starts));
  if (budget) require_positive(*budget, "budget", "seconds");
  if (rate) require_positive(*rate, "rate", "Hz");
  NoiseTuningOptions options;
  options.method = noise_method(method);
  options.holdout = holdout;
  if (budget) options.seconds = *budget;
  options.fit.starts = static_cast<int>(starts);
  options.fit.seed = seed;
  options.fit.profile = profile;
  options.fit.threads = threads;
  NoiseLogOptions reading;
  for (const Path& log : logs) reading.logs.push_back(log.text);
  reading.channels = {map.begin(), map.end()};
  reading.truths = {truth.begin(), truth.end()};
  reading.reading.format = format;
  if (!columns.empty()) reading.reading.columns = parse_log_columns(columns, "columns");
  reading.reading.rate_hz = rate.value_or(0);
  const FilterChoice choice{fix.list, {start.begin(), start.end()}, gate, student};
  return long_call([&](const Stop& stop) {
    options.fit.interrupted = stop;
    FilterModel chosen = chosen_filter(load_filter_model(model.text), choice);
    return tune_noise(read_noise_logs(std::move(chosen), reading), options);
  });
}

/// @throws NoSolution  as the command, which prints fits alone
const TunedNoise& fitted(const TunedNoise& noise) {
  if (noise.tuning.fit.status == NoiseFitStatus::not_computed)
    throw NoSolution("tune: " + noise.tuning.fit.culprit, noise.model.name);
  return noise;
}

void add_kalman(py::module_& module) {
  py::class_<FittedParameter>(module, "FittedParameter", "A noise parameter with its interval.")
      .def_readonly("name", &FittedParameter::name, "Its name in the filter model.")
      .def_readonly("unit", &FittedParameter::unit, "Of the variance.")
      .def_readonly("value", &FittedParameter::value, "The variance, or an entry of a matrix.")
      .def_readonly("low", &FittedParameter::low, "Lower end of the interval.")
      .def_readonly("high", &FittedParameter::high, "Upper end of the interval; may be NaN.")
      .def_property_readonly(
          "verdict", [](const FittedParameter& self) { return to_string(self.verdict); },
          "\"determined\", \"at zero\", \"not determined\", ...")
      .def("__repr__", [](const FittedParameter& self) {
        return fmt::format("<FittedParameter {} = {}>", self.name, self.value);
      });
  py::class_<TunedNoise> type(module, "TunedKalman",
                              "Noise covariances of a filter from logs, with a verdict.");
  type.def_property_readonly(
          "status", [](const TunedNoise& noise) { return to_string(noise.tuning.fit.status); },
          "\"converged\", \"not computed\", ...")
      .def_property_readonly(
          "culprit", [](const TunedNoise& noise) { return noise.tuning.fit.culprit; },
          "Why there is no fit; empty if there is.")
      .def_property_readonly(
          "passed",
          [](const TunedNoise& noise) { return noise.tuning.verdict == CheckVerdict::pass; },
          "Whether the covariances can be believed.")
      .def_property_readonly(
          "reasons", [](const TunedNoise& noise) { return noise.tuning.reasons; },
          "Of a verdict that is not pass.")
      .def_property_readonly(
          "parameters", [](const TunedNoise& noise) { return noise.tuning.fit.parameters; },
          "FittedParameter of each.")
      .def_property_readonly(
          "log_likelihood",
          [](const TunedNoise& noise) {
            return std::pair(noise.tuning.fit.before.value, noise.tuning.fit.after.value);
          },
          "(before, after).")
      .def_property_readonly(
          "warnings", [](const TunedNoise& noise) { return noise.tuning.warnings; },
          "What a user should know whatever the verdict.")
      .def(
          "save_model",
          [](const TunedNoise& noise, const std::filesystem::path& file) {
            save(file.string(), tuned_model_file(fitted(noise), ""));
          },
          "file"_a, "Write the tuned filter model, which states its verdict.");
  add_report(
      type, "quadtune tune kalman",
      [](const TunedNoise& noise) { return report::to_json(fitted(noise)); },
      [](const TunedNoise& noise) { return report::to_text(fitted(noise)); });
  module.def(
      "tune_kalman", &tune_filter, "model"_a, "logs"_a, py::kw_only(), "map"_a = Texts(),
      "truth"_a = Texts(), "method"_a = "ml", "fix"_a = std::vector<std::string>(),
      "start"_a = Values(), "holdout"_a = NoiseTuningOptions().holdout, "gate"_a = 0.0,
      "student"_a = 0.0, "starts"_a = 3, "budget"_a = py::none(), "profile"_a = false,
      "format"_a = "", "columns"_a = "", "rate"_a = py::none(), "seed"_a = 1, "threads"_a = 0,
      "Estimate the noise covariances of a filter from logs of its sensors.\n\n"
      "model: a built-in filter model or a file. logs: one file of each flight. map: channels\n"
      "of inputs and measurements that have other names in the log. truth: channels of what\n"
      "states truly were. method: \"ml\" (maximum likelihood) or \"als\" (autocovariances).\n"
      "fix: parameters that stay; start: variances > 0 at which the search starts. holdout:\n"
      "share of each log that is kept for the verdict, 0 to 0.9. gate > 0: measurements whose\n"
      "squared innovation exceeds it are left out; student > 0: degrees of freedom of the\n"
      "measurement errors; 0 for neither. starts: 1 to 1000 searches. budget > 0: time of the\n"
      "search [s], which then ends with the best it has. profile: intervals by the likelihood\n"
      "profile. format and columns of the logs, rate > 0 [Hz] of logs without times:\n"
      "docs/cli.md. threads: 0 for one of each processor. A problem without fit is a result\n"
      "whose status is \"not computed\". Raises InvalidInput for a wrong argument, model or\n"
      "log, FileError if a file cannot be read.");
}

}  // namespace

void add_tuning(py::module_& module) { add_kalman(module); }

}  // namespace quadtune::python
