// SPDX-License-Identifier: Apache-2.0
/// LQR weights that give a known gain.
#include "quadtune/workbench/design/gain_match.hpp"

#include <fmt/format.h>

#include "plants.hpp"
#include "quadtune/convention_file.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/convert.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "report/gains/gains.hpp"
#include "support/arguments.hpp"
#include "support/interrupts.hpp"
#include "support/results.hpp"
#include "support/topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using Matrix = Eigen::MatrixXd;

/// A match with what its report refers to.
struct MatchedGain {
  Vehicle vehicle;
  std::string vehicle_word;
  FlightCondition flight;
  std::string file;
  GivenGainMatch found;
  double tolerance = 0;

  [[nodiscard]] const GainMatch& match() const { return found.match; }
  [[nodiscard]] report::GainMatchReport report() const {
    return {vehicle,       vehicle_word,      flight,      file,
            found.gains.K, found.gains.K_int, found.match, tolerance};
  }
};

/// The arguments of the problem; those that did not come are taken from the gains.
struct MatchArguments {
  std::optional<Numbers> Q, R;
  std::optional<Names> integral;
  std::optional<std::string> method;
  std::optional<double> dt;
  std::optional<std::string> at, convention, inputs;
  std::optional<double> speed, climb, radius, yaw_rate, yaw;
  std::optional<Names> states;

  [[nodiscard]] bool has_flight() const { return at || speed || climb || radius || yaw_rate; }
};

PlantWords plant_of(const MatchArguments& words, const GivenGains& given, const Gains& turned,
                    const std::string& vehicle) {
  PlantWords plant;
  plant.vehicle = vehicle;
  plant.convention = words.convention.value_or(given.gains.convention);
  plant.inputs = words.inputs.value_or(to_string(given.gains.input_kind));
  plant.states =
      words.states ? words.states->joined() : internal::joined(names_of(turned.states), ",");
  plant.at = words.at.value_or(plant.at);
  plant.speed = words.speed.value_or(0);
  plant.climb = words.climb.value_or(0);
  plant.radius = words.radius.value_or(0);
  plant.yaw_rate = words.yaw_rate.value_or(0);
  plant.yaw = words.yaw.value_or(0);
  if (!given.design) return plant;
  const FlightCondition& flight = given.design->condition;
  if (!words.yaw) plant.yaw = flight.yaw;
  if (words.has_flight()) return plant;
  plant.at = to_string(flight.kind);
  plant.speed = flight.speed;
  plant.climb = flight.climb;
  plant.radius = flight.radius;
  plant.yaw_rate = flight.yaw_rate;
  return plant;
}

LqrWords problem_of(const MatchArguments& words, const GivenGains& given, const Gains& turned) {
  LqrWords problem;
  problem.Q = words.Q;
  problem.R = words.R;
  problem.integrals = words.integral ? listed(words.integral) : names_of(turned.integrals);
  problem.method = words.method.value_or(problem.method);
  if (!words.method && given.design && given.design->lqr)
    problem.method = to_string(given.design->lqr->method);
  problem.dt = words.dt;
  if (!words.dt && given.gains.dt > 0) problem.dt = given.gains.dt;
  return problem;
}

MatchedGain match(const VehicleWord& vehicle, const Path& file, const MatchArguments& words,
                  GainMatchOptions options) {
  if (!(options.tolerance > 0))
    throw OptionError(
        "tolerance", fmt::format("tolerance is {}, expected a positive number", options.tolerance));
  if (options.starts < 1 || options.starts > 1000)
    throw OptionError("starts", fmt::format("starts is {}, expected 1 to 1000", options.starts));
  return long_call([&](const Stop& stop) -> MatchedGain {
    options.interrupted = stop;
    const GivenGains given = read_given_gains(file.text);
    if (given.gains.memory)
      throw InvalidInput(file.text,
                         "the law feeds back its past commands, expected a matrix on the states "
                         "and their integrals, because the weights are computed on the ideal "
                         "plant");
    const Convention& convention =
        named_convention(words.convention.value_or(given.gains.convention), "convention");
    const Gains turned = in_convention(given.gains, convention);
    PlantWords plant_words = plant_of(words, given, turned, vehicle.text);
    plant_words.convention = convention.name;
    const LinearVehicle plant = make_plant(plant_words);
    const ContinuousLti& model = plant.model.plant;
    require_states(given.gains, model.states, convention, file.text);
    const LqrDesign design =
        lqr_design(problem_of(words, given, turned), plant_words, model.states, model.inputs);
    GivenGainMatch found = match_given_gains(given.gains, plant, design, options, file.text);
    if (found.match.status == GainMatchStatus::interrupted) throw Interrupted();
    if (!found.match.has_weights())
      throw NoSolution(fmt::format("tune: {}: {}", file.text, found.match.culprit), file.text);
    return {plant.vehicle, vehicle.text,     flight_condition(plant_words),
            file.text,     std::move(found), options.tolerance};
  });
}

void add_weight(py::module_& module) {
  py::class_<MatchedWeight>(module, "MatchedWeight", "A weight that was computed for a gain.")
      .def_readonly("name", &MatchedWeight::name, "\"Q(x)\", \"Q_integral(theta)\", \"R(w1)\", ...")
      .def_readonly("before", &MatchedWeight::before, "At the start of the first search.")
      .def_readonly("value", &MatchedWeight::value, "The result.")
      .def_readonly("low", &MatchedWeight::low, "Lower end of the interval; 0 if not determined.")
      .def_readonly("high", &MatchedWeight::high,
                    "Upper end of the interval; infinite if not determined.")
      .def_property_readonly(
          "verdict", [](const MatchedWeight& self) { return to_string(self.verdict); },
          "How well the gain determines it: empty, \"poorly determined\", \"in\n"
          "combination\", \"not determined\", \"at zero\" or \"fixed\".")
      .def("__repr__", [](const MatchedWeight& self) {
        return fmt::format("<MatchedWeight {} = {}>", self.name, self.value);
      });
}

void add_result(py::module_& module) {
  py::class_<MatchedGain> type(module, "GainMatch",
                               "Diagonal LQR weights whose gain is closest to a given one.");
  const auto matrix = [&](const char* name, auto member, const char* doc) {
    type.def_property_readonly(name, member, py::return_value_policy::reference_internal, doc);
  };
  type.def_property_readonly(
          "status", [](const MatchedGain& self) { return to_string(self.match().status); },
          "\"matched\" or \"not matched\".")
      .def_property_readonly(
          "matched",
          [](const MatchedGain& self) { return self.match().status == GainMatchStatus::matched; },
          "Whether the weights give the gain within the tolerance.")
      .def_property_readonly(
          "weights", [](const MatchedGain& self) { return self.match().weights; },
          "MatchedWeight of states, integrals and inputs.")
      .def_property_readonly(
          "unseen", [](const MatchedGain& self) { return self.match().unseen; },
          "Directions of the weights that the gain does not determine.")
      .def_property_readonly(
          "states", [](const MatchedGain& self) { return self.match().design.states; },
          "Names of the states.")
      .def_property_readonly(
          "integrals", [](const MatchedGain& self) { return self.match().design.integrals; },
          "Names of the integrated states.")
      .def_property_readonly(
          "inputs", [](const MatchedGain& self) { return self.match().design.inputs; },
          "Names of the inputs.");
  matrix(
      "Q", [](const MatchedGain& self) -> const Matrix& { return self.match().design.Q; },
      "(nx, nx) weights of the states.");
  matrix(
      "Q_integral",
      [](const MatchedGain& self) -> const Matrix& { return self.match().design.Q_integral; },
      "(ni, ni) weights of the integrals.");
  matrix(
      "R", [](const MatchedGain& self) -> const Matrix& { return self.match().design.R; },
      "(nu, nu) weights of the inputs.");
  matrix(
      "K", [](const MatchedGain& self) -> const Matrix& { return self.match().feedback.K; },
      "(nu, nx) gain of these weights.");
  matrix(
      "K_int", [](const MatchedGain& self) -> const Matrix& { return self.match().feedback.K_int; },
      "(nu, ni) gain of the integrals of these weights.");
  matrix(
      "K_given", [](const MatchedGain& self) -> const Matrix& { return self.found.gains.K; },
      "(nu, nx) given gain, in the same order.");
  matrix(
      "K_int_given",
      [](const MatchedGain& self) -> const Matrix& { return self.found.gains.K_int; },
      "(nu, ni) given gain of the integrals, in the same order.");
  type.def_property_readonly(
          "difference",
          [](const MatchedGain& self) {
            return std::pair(self.match().before, self.match().after);
          },
          "(before, after): largest difference of an entry, relative to the largest of its row\n"
          "or column.")
      .def_property_readonly(
          "worst", [](const MatchedGain& self) { return self.match().worst; },
          "The entry with that difference, e.g. \"K_int(w1, theta)\".")
      .def_readonly("tolerance", &MatchedGain::tolerance, "On the difference.")
      .def_property_readonly(
          "weighted_sensitivity",
          [](const MatchedGain& self) { return self.match().weighted_sensitivity; },
          "At most 1 of every LQR gain with this R, with weights of the states of any kind.")
      .def_property_readonly(
          "excess_cost", [](const MatchedGain& self) { return self.match().excess_cost; },
          "Largest relative excess cost of the given gain; NaN if it is not known.")
      .def(
          "save_design",
          [](const MatchedGain& self, const std::filesystem::path& file) {
            save(file.string(),
                 report::design_file(self.report(), file.string(), "quadtune.tune_lqr()"));
          },
          "file"_a,
          "Write a design file (TOML) with the weights, and with the given gain as the published\n"
          "one. Raises FileError if it cannot be written.");
  add_report(
      type, "quadtune tune lqr V --match-gains FILE",
      [](const MatchedGain& self) { return report::to_json(self.report()); },
      [](const MatchedGain& self) { return report::to_text(self.report()); });
}

}  // namespace

void add_gain_match(py::module_& module) {
  add_weight(module);
  add_result(module);
  using Text = std::optional<std::string>;
  using Number = std::optional<double>;
  const GainMatchOptions usual;
  module.def(
      "tune_lqr",
      [](const VehicleWord& vehicle, const Path& gains, std::optional<Numbers> Q,
         std::optional<Numbers> R, std::optional<Names> integral, Text method, Number dt, Text at,
         Number speed, Number climb, Number radius, Number yaw_rate, Number yaw, Text convention,
         Text inputs, std::optional<Names> states, const std::vector<Names>& tie, double tolerance,
         int starts, std::uint64_t seed) {
        GainMatchOptions options;
        options.tolerance = tolerance;
        options.starts = starts;
        options.seed = seed;
        for (const Names& names : tie) options.ties.push_back(names.list);
        const MatchArguments words{std::move(Q),
                                   std::move(R),
                                   std::move(integral),
                                   method,
                                   dt,
                                   at,
                                   convention,
                                   inputs,
                                   speed,
                                   climb,
                                   radius,
                                   yaw_rate,
                                   yaw,
                                   std::move(states)};
        return match(vehicle, gains, words, options);
      },
      "vehicle"_a, py::kw_only(), "match_gains"_a, "Q"_a = py::none(), "R"_a = py::none(),
      "integral"_a = py::none(), "method"_a = py::none(), "dt"_a = py::none(), "at"_a = py::none(),
      "speed"_a = py::none(), "climb"_a = py::none(), "radius"_a = py::none(),
      "yaw_rate"_a = py::none(), "yaw"_a = py::none(), "convention"_a = py::none(),
      "inputs"_a = py::none(), "states"_a = py::none(), "tie"_a = std::vector<std::string>(),
      "tolerance"_a = usual.tolerance, "starts"_a = usual.starts, "seed"_a = usual.seed,
      "Compute diagonal LQR weights that give a known gain.\n\n"
      "match_gains: an export, a file of gains, or a design file with [published] gains, from\n"
      "which absent arguments take their values. Q, R: where the search starts, as for\n"
      "missions; the geometric mean of R is kept, because a gain determines the weights only\n"
      "up to a factor. method: \"continuous\", \"discrete\" or \"sampled\". at to states as\n"
      "linearize(). tie: lists of states, integrals (as int_x) or inputs that share one\n"
      "weight. tolerance > 0: largest difference of an entry that counts as matched, relative\n"
      "to the largest of its row or column. starts: 1 to 1000 searches. A gain that no weights\n"
      "give is a result whose status is \"not matched\". Raises NoSolution if the gain does\n"
      "not stabilize the plant, InvalidInput for a wrong argument or file, and FileError.");
}

}  // namespace quadtune::python
