// SPDX-License-Identifier: Apache-2.0
/// PID gains and LQR weights over missions.
#include <fmt/format.h>

#include <variant>

#include "plants.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"
#include "quadtune/workbench/missions/lqr_tuning.hpp"
#include "quadtune/workbench/missions/mission_tuning.hpp"
#include "quadtune/workbench/missions/pid_tuning.hpp"
#include "report/missions/mission_tuning_report.hpp"
#include "support/arguments.hpp"
#include "support/interrupts.hpp"
#include "support/results.hpp"
#include "support/topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;

struct FlightWords {
  const std::string &measure, &estimator, &sensors, &wind;
};

MissionWords words_of(const std::vector<Path>& missions, const std::optional<Path>& requirements,
                      const FlightWords& flights, const std::optional<double>& duration) {
  MissionWords words;
  for (const Path& mission : missions) words.missions.push_back(mission.text);
  if (requirements) words.requirements = requirements->text;
  words.measure = flights.measure;
  words.estimator = flights.estimator;
  words.sensors = flights.sensors;
  words.wind = flights.wind;
  words.duration = duration;
  return words;
}

MissionTuningOptions options_of(double budget, std::uint64_t evaluations, std::uint32_t draws,
                                std::uint32_t proof, std::uint64_t seed, std::size_t threads) {
  MissionTuningOptions options;
  options.seconds = budget;
  options.evaluations = evaluations;
  options.draws = draws;
  options.proof = proof;
  options.seed = seed;
  options.threads = threads;
  return options;
}

/// @throws InvalidInput  before anything is designed
void require_sane(const MissionWords& words, const MissionTuningOptions& options) {
  require_flight_words(words);
  require_positive(options.seconds, "budget", "seconds");
  if (words.duration) require_positive(*words.duration, "duration", "seconds");
  if (options.evaluations < 1)
    throw OptionError("evaluations", "evaluations is 0, expected at least 1");
}

/// The library calls a mission what its option is called on a command line.
MissionRequirements requirements_of(const MissionWords& words) {
  try {
    return mission_requirements(words);
  } catch (const OptionError& error) {
    if (error.option() != "mission") throw;
    throw OptionError("missions", "missions" + std::string(error.what()).substr(7));
  }
}

MissionTuningResult search(const MissionTuning& tuning, const MissionRequirements& requirements,
                           MissionTuningOptions options, const Stop& stop, const char* who) {
  options.stop = stop;
  MissionTuningPlan plan = plan_mission_tuning(tuning, requirements, options, who);
  return tune_missions(tuning, requirements, std::move(plan), options);
}

// --- tune_pid ---

MissionTuningResult tune_cascade(const VehicleWord& vehicle, const std::string& gains,
                                 bool separate, const MissionWords& words,
                                 const MissionTuningOptions& options) {
  require_sane(words, options);
  return long_call([&](const Stop& stop) {
    const MissionRequirements requirements = requirements_of(words);
    return search(pid_tuning(vehicle.text, gains, separate), requirements, options, stop,
                  "tune_pid");
  });
}

std::vector<PidLoop> loops_at(const MissionTuningResult& result, const Eigen::VectorXd& point) {
  return std::get<CascadeGains>(result.tuning.gains(point)).loops;
}

/// What the results of both searches have.
template <class Type, class ResultOf>
void add_search(Type& type, ResultOf result_of) {
  using Self = typename Type::type;
  type.def_property_readonly(
          "accepted", [=](const Self& self) { return result_of(self).search.accepted; },
          "Whether fresh draws prove that the candidate is better than the start.")
      .def_property_readonly(
          "reason", [=](const Self& self) { return result_of(self).search.reason; },
          "Why, in words.")
      .def_property_readonly(
          "costs",
          [=](const Self& self) {
            const auto& steps = result_of(self).search.steps;
            Eigen::VectorXd costs(static_cast<Eigen::Index>(steps.size()));
            for (std::size_t i = 0; i < steps.size(); ++i)
              costs(static_cast<Eigen::Index>(i)) = steps[i].cost;
            return costs;
          },
          "Cost of each point, in the order in which they were tried; NaN of an unstable one.")
      .def_property_readonly(
          "evaluations", [=](const Self& self) { return result_of(self).search.evaluations; },
          "Number of points that were tried.")
      .def(
          "save_design",
          [=](const Self& self, const std::filesystem::path& file) {
            const MissionTuningResult& result = result_of(self);
            save(file.string(), result.tuning.file(result.search.candidate, result.search.reason));
          },
          "file"_a,
          "Write the candidate as a design file (TOML), which states the reason.\n\n"
          "Raises FileError if it cannot be written.");
}

void add_pid_tuning(py::module_& module) {
  py::class_<MissionTuningResult> type(module, "TunedPid",
                                       "PID gains that were searched over missions.");
  add_search(
      type, [](const MissionTuningResult& result) -> auto& { return result; });
  type.def_property_readonly(
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
          "PidLoop of the best point of the search, accepted or not.");
  add_report(
      type, "quadtune tune pid V",
      [](const MissionTuningResult& result) { return report::to_json(result); },
      [](const MissionTuningResult& result) { return report::to_text(result); });
  const MissionTuningOptions usual;
  module.def(
      "tune_pid",
      [](const VehicleWord& vehicle, std::vector<Path> missions, std::optional<Path> requirements,
         const std::string& gains, bool separate, double budget, std::uint64_t evaluations,
         std::uint32_t draws, std::uint32_t proof, std::string measure, std::string estimator,
         std::string sensors, std::string wind, std::optional<double> duration, std::uint64_t seed,
         std::size_t threads) {
        return tune_cascade(
            vehicle, gains, separate,
            words_of(missions, requirements, {measure, estimator, sensors, wind}, duration),
            options_of(budget, evaluations, draws, proof, seed, threads));
      },
      "vehicle"_a, "missions"_a = std::vector<std::string>(), py::kw_only(),
      "requirements"_a = py::none(), "gains"_a = "designed", "separate"_a = false,
      "budget"_a = usual.seconds, "evaluations"_a = usual.evaluations, "draws"_a = 0, "proof"_a = 0,
      "measure"_a = "", "estimator"_a = "", "sensors"_a = "", "wind"_a = "",
      "duration"_a = py::none(), "seed"_a = 1, "threads"_a = 0,
      "Search the gains of a PID cascade over missions, and prove them on fresh draws.\n\n"
      "missions: built-in names or files; or requirements: a file with cost and limits. gains:\n"
      "where the search starts: \"designed\", \"published\" or a file. separate: x and y, and\n"
      "roll and pitch, have gains of their own. budget > 0: time of the search [s];\n"
      "evaluations >= 1: the most points it tries. draws of each mission for one evaluation, 0\n"
      "for those of the requirements or 4; proof: fresh draws, 0 for 24 or as many as a\n"
      "quantile needs. measure of the draws: \"mean\" (default), \"quantile\" or \"worst\".\n"
      "estimator, sensors and wind as fly(); duration > 0 of each flight [s]. threads: 0 for\n"
      "one of each processor. Raises InvalidInput for a wrong argument or file, FileError, and\n"
      "NoSolution if the start is unstable.");
}

// --- tune_lqr ---

/// Weights that were searched over missions.
struct TunedLqr {
  MissionTuningResult result;
};

TunedWeights weights_at(const TunedLqr& self, const Eigen::VectorXd& point) {
  return std::get<TunedWeights>(self.result.tuning.gains(point));
}

/// The LQR problem at which the search starts.
struct StartArguments {
  PlantWords plant;
  LqrWords lqr;
  bool separate = false;

  /// Whether the weights are those of Bryson's rule.
  [[nodiscard]] bool standard() const { return !lqr.Q && !lqr.R; }
};

TunedLqr tune_weights(const StartArguments& start, const MissionWords& words,
                      const MissionTuningOptions& options) {
  require_sane(words, options);
  if (start.standard() && (start.plant.convention != "ned" || start.plant.states != "full"))
    throw OptionError("Q",
                      "convention and states require Q and R, because Bryson's rule gives "
                      "weights for all states in ned only");
  if (lqr_method(start.lqr.method, "method") == LqrMethod::continuous)
    throw OptionError("method",
                      "method is continuous, expected discrete or sampled, because the gains run "
                      "on a computer");
  return long_call([&](const Stop& stop) -> TunedLqr {
    const MissionRequirements requirements = requirements_of(words);
    LinearVehicle plant = make_plant(start.plant);
    const ContinuousLti& model = plant.model.plant;
    const LqrDesign design = lqr_design(start.lqr, start.plant, model.states, model.inputs);
    return {search(lqr_tuning(std::move(plant), design, start.standard(), start.separate),
                   requirements, options, stop, "tune_lqr")};
  });
}

void add_lqr_tuning(py::module_& module) {
  py::class_<TunedWeights>(module, "TunedWeights", "Diagonal weights of an LQR with their gains.")
      .def_readonly("names", &TunedWeights::names, "Of states, integrals and inputs.")
      .def_readonly("weights", &TunedWeights::weights, "In the order of names.")
      .def_readonly("gains", &TunedWeights::gains, "Gains, or None without a solution.");
  py::class_<TunedLqr> type(module, "TunedLqr", "LQR weights that were searched over missions.");
  add_search(
      type, [](const TunedLqr& self) -> auto& { return self.result; });
  type.def_property_readonly(
          "weights", [](const TunedLqr& self) { return weights_at(self, self.result.search.best); },
          "TunedWeights that count: those of the start where nothing better was accepted.")
      .def_property_readonly(
          "start", [](const TunedLqr& self) { return weights_at(self, self.result.tuning.start); },
          "TunedWeights of the start.")
      .def_property_readonly(
          "candidate",
          [](const TunedLqr& self) { return weights_at(self, self.result.search.candidate); },
          "TunedWeights of the best point of the search, accepted or not.");
  add_report(
      type, "quadtune tune lqr V",
      [](const TunedLqr& self) { return report::to_json(self.result); },
      [](const TunedLqr& self) { return report::to_text(self.result); });
  const MissionTuningOptions usual;
  module.def(
      "tune_lqr",
      [](const VehicleWord& vehicle, std::vector<Path> missions, std::optional<Path> requirements,
         std::optional<Numbers> Q, std::optional<Numbers> R, const std::optional<Names>& integral,
         const std::string& method, std::optional<double> dt, double yaw,
         const std::string& convention, const std::optional<std::string>& inputs,
         const std::optional<Names>& states, bool separate, double budget,
         std::uint64_t evaluations, std::uint32_t draws, std::uint32_t proof, std::string measure,
         std::string estimator, std::string sensors, std::string wind,
         std::optional<double> duration, std::uint64_t seed, std::size_t threads) {
        StartArguments start;
        start.plant.vehicle = vehicle.text;
        start.plant.yaw = yaw;
        start.plant.convention = convention;
        if (states) start.plant.states = states->joined();
        start.lqr = {std::move(Q), std::move(R), listed(integral), method,
                     dt.value_or(kUsualPeriod)};
        start.separate = separate;
        if (start.standard() && inputs && *inputs != "wrench")
          throw OptionError("inputs",
                            "inputs other than wrench require Q and R, because Bryson's rule gives "
                            "weights for the wrench only");
        start.plant.inputs = inputs.value_or(start.standard() ? "wrench" : start.plant.inputs);
        return tune_weights(
            start, words_of(missions, requirements, {measure, estimator, sensors, wind}, duration),
            options_of(budget, evaluations, draws, proof, seed, threads));
      },
      "vehicle"_a, "missions"_a = std::vector<std::string>(), py::kw_only(),
      "requirements"_a = py::none(), "Q"_a = py::none(), "R"_a = py::none(),
      "integral"_a = py::none(), "method"_a = "sampled", "dt"_a = py::none(), "yaw"_a = 0.0,
      "convention"_a = "ned", "inputs"_a = py::none(), "states"_a = py::none(),
      "separate"_a = false, "budget"_a = usual.seconds, "evaluations"_a = usual.evaluations,
      "draws"_a = 0, "proof"_a = 0, "measure"_a = "", "estimator"_a = "", "sensors"_a = "",
      "wind"_a = "", "duration"_a = py::none(), "seed"_a = 1, "threads"_a = 0,
      "Search LQR weights over missions, and prove the gains on fresh draws.\n\n"
      "Q: where the search starts: weights >= 0 of the states, then of the integrals; R > 0:\n"
      "of the inputs; one number stands for all, 1 by default; a weight of 0 stays 0. Without\n"
      "Q and R: Bryson's rule, for all states in ned and the wrench. integral: states to\n"
      "integrate. method: \"sampled\" (exact cost) or \"discrete\" (weights per step). dt > 0:\n"
      "sample period [s], by default 0.005. yaw: heading of the hover [rad]. convention,\n"
      "inputs and states as linearize(). separate: the weights of x and y, and of roll and\n"
      "pitch, are searched separately. The other arguments, and the exceptions, as tune_pid().");
}

}  // namespace

void add_missions(py::module_& module) {
  add_pid_tuning(module);
  add_lqr_tuning(module);
}

}  // namespace quadtune::python
