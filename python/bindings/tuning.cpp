// SPDX-License-Identifier: Apache-2.0
/// Noise covariances from logs, and PID gains over missions.
#include <fmt/format.h>

#include <map>
#include <variant>

#include "arguments.hpp"
#include "interrupts.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"
#include "quadtune/workbench/logs/filter_choice.hpp"
#include "quadtune/workbench/logs/tuned_noise.hpp"
#include "quadtune/workbench/missions/mission_tuning.hpp"
#include "quadtune/workbench/missions/pid_tuning.hpp"
#include "report/logs/logs.hpp"
#include "report/missions/mission_tuning_report.hpp"
#include "results.hpp"
#include "topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using Texts = std::map<std::string, std::string>;
using Values = std::map<std::string, double>;

// --- tune_kalman ---

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
          "\"seen\", \"at zero\", \"not seen\", ...")
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
      "states truly were. method: \"ml\" or \"als\". fix: parameters that stay; start:\n"
      "variances at which the search starts. holdout: share of each log that is kept for the\n"
      "verdict. budget: time of the search [s], which then ends with the best it has.");
}

// --- tune_pid ---

struct MissionArguments {
  std::vector<std::string> missions;
  std::optional<std::string> requirements;
  std::string estimator, sensors, wind, measure;
  std::optional<double> duration;
};

MissionRequirements requirements_of(const MissionArguments& given) {
  MissionRequirements requirements;
  if (given.requirements) requirements = read_requirements(*given.requirements);
  const bool of_file = !requirements.missions.empty();
  const std::pair<const char*, bool> came[] = {{"missions", !given.missions.empty()},
                                               {"estimator", !given.estimator.empty()},
                                               {"sensors", !given.sensors.empty()},
                                               {"wind", !given.wind.empty()},
                                               {"duration", given.duration.has_value()}};
  for (const auto& [name, is_there] : came)
    if (is_there && of_file)
      throw OptionError(name,
                        fmt::format("{} came with requirements that have [[mission]], expected "
                                    "it there",
                                    name));
  for (const std::string& name : given.missions) {
    CampaignMission mission;
    mission.mission = load_mission(name);
    mission.where = "missions";
    mission.arguments.estimator = given.estimator;
    mission.arguments.sensors = given.sensors;
    if (!given.wind.empty()) mission.arguments.wind = given.wind;
    mission.arguments.duration = given.duration;
    requirements.limits.push_back(mission.mission.limits);
    requirements.missions.push_back(std::move(mission));
  }
  if (requirements.missions.empty())
    throw OptionError("missions", "expected missions, or requirements with [[mission]]");
  if (!given.measure.empty()) requirements.measure = robust_measure(given.measure, "measure");
  return requirements;
}

MissionTuningResult tune_cascade(const VehicleWord& vehicle, const std::vector<Path>& missions,
                                 const std::optional<Path>& requirements_file,
                                 const std::string& gains, bool separate, double budget,
                                 std::uint64_t evaluations, std::uint32_t draws,
                                 std::uint32_t proof, const std::string& measure,
                                 const std::string& estimator, const std::string& sensors,
                                 const std::string& wind, std::optional<double> duration,
                                 std::uint64_t seed, std::size_t threads) {
  FlightOptions flight;
  flight.estimator = estimator;
  flight.sensors = sensors;
  if (!wind.empty()) flight.wind = wind;
  require_flight_words(flight);
  require_positive(budget, "budget", "seconds");
  if (duration) require_positive(*duration, "duration", "seconds");
  if (evaluations < 1) throw OptionError("evaluations", "evaluations is 0, expected at least 1");
  MissionArguments given;
  for (const Path& mission : missions) given.missions.push_back(mission.text);
  if (requirements_file) given.requirements = requirements_file->text;
  given.estimator = estimator;
  given.sensors = sensors;
  given.wind = wind;
  given.measure = measure;
  given.duration = duration;
  MissionTuningOptions options;
  options.seconds = budget;
  options.evaluations = evaluations;
  options.draws = draws;
  options.proof = proof;
  options.seed = seed;
  options.threads = threads;
  return long_call([&](const Stop& stop) {
    options.stop = stop;
    const MissionRequirements requirements = requirements_of(given);
    const MissionTuning tuning = pid_tuning(vehicle.text, gains, separate);
    MissionTuningPlan plan = plan_mission_tuning(tuning, requirements, options, "tune_pid");
    return tune_missions(tuning, requirements, std::move(plan), options);
  });
}

std::vector<PidLoop> loops_at(const MissionTuningResult& result, const Eigen::VectorXd& point) {
  return std::get<CascadeGains>(result.tuning.gains(point)).loops;
}

void add_pid_tuning(py::module_& module) {
  py::class_<MissionTuningResult> type(module, "TunedPid",
                                       "PID gains that were searched over missions.");
  type.def_property_readonly(
          "accepted", [](const MissionTuningResult& result) { return result.search.accepted; },
          "Whether fresh draws prove that the gains found are better.")
      .def_property_readonly(
          "reason", [](const MissionTuningResult& result) { return result.search.reason; },
          "Why, in words.")
      .def_property_readonly(
          "loops",
          [](const MissionTuningResult& result) { return loops_at(result, result.search.best); },
          "PidLoop of the gains that count: the start where nothing better was accepted.")
      .def_property_readonly(
          "start",
          [](const MissionTuningResult& result) { return loops_at(result, result.tuning.start); },
          "PidLoop of the start.")
      .def_property_readonly(
          "candidate",
          [](const MissionTuningResult& result) {
            return loops_at(result, result.search.candidate);
          },
          "PidLoop of the best point of the search, accepted or not.")
      .def_property_readonly(
          "costs",
          [](const MissionTuningResult& result) {
            Eigen::VectorXd costs(static_cast<Eigen::Index>(result.search.steps.size()));
            for (Eigen::Index i = 0; i < costs.size(); ++i)
              costs(i) = result.search.steps[static_cast<std::size_t>(i)].cost;
            return costs;
          },
          "Cost of each point, in the order in which they were tried; NaN of an unstable one.")
      .def_property_readonly(
          "evaluations",
          [](const MissionTuningResult& result) { return result.search.evaluations; },
          "Points that were tried.")
      .def(
          "save_design",
          [](const MissionTuningResult& result, const std::filesystem::path& file) {
            save(file.string(), result.tuning.file(result.search.candidate, result.search.reason));
          },
          "file"_a, "Write the candidate as a design file, which states the reason.");
  add_report(
      type, "quadtune tune pid V",
      [](const MissionTuningResult& result) { return report::to_json(result); },
      [](const MissionTuningResult& result) { return report::to_text(result); });
  const MissionTuningOptions usual;
  module.def(
      "tune_pid", &tune_cascade, "vehicle"_a, "missions"_a = std::vector<std::string>(),
      py::kw_only(), "requirements"_a = py::none(), "gains"_a = "designed", "separate"_a = false,
      "budget"_a = usual.seconds, "evaluations"_a = usual.evaluations, "draws"_a = 0, "proof"_a = 0,
      "measure"_a = "", "estimator"_a = "", "sensors"_a = "", "wind"_a = "",
      "duration"_a = py::none(), "seed"_a = 1, "threads"_a = 0,
      "Search the gains of a PID cascade over missions, and prove them on fresh draws.\n\n"
      "missions: built-in names or files; or requirements: a file with cost and limits.\n"
      "gains: where the search starts: \"designed\", \"published\" or a file. budget: time of\n"
      "the search [s]. draws of each mission for one evaluation; proof: fresh draws.\n"
      "measure of the draws: \"mean\", \"quantile\" or \"worst\".");
}

}  // namespace

void add_tuning(py::module_& module) {
  add_kalman(module);
  add_pid_tuning(module);
}

}  // namespace quadtune::python
