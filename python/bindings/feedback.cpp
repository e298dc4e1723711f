// SPDX-License-Identifier: Apache-2.0
/// State feedback of a vehicle: lqr on the flown and on the ideal plant, and lqg.
#include <fmt/format.h>

#include <variant>

#include "plants.hpp"
#include "quadtune/convention_file.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/design/lqg_report.hpp"
#include "quadtune/workbench/design/lqi_report.hpp"
#include "quadtune/workbench/design/lqr_report.hpp"
#include "quadtune/workbench/design/matrix_report.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"
#include "quadtune/workbench/flown/plant_word.hpp"
#include "report/gains/gains.hpp"
#include "support/arguments.hpp"
#include "support/interrupts.hpp"
#include "support/results.hpp"
#include "support/topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;

/// Results whose JSON needs their vehicle.
struct FlownLqr {
  LqiReport report;
  Vehicle vehicle;
};
struct FlownMatrix {
  MatrixReport report;
  Vehicle vehicle;
};
struct FlownLqg {
  LqgReport report;
  Vehicle vehicle;
};

/// What lqr and lqg share on the flown plant.
struct FlownArguments {
  std::optional<Numbers> Q, R, change;
  std::optional<Names> integral;
  std::optional<double> dt;
  std::optional<int> past;
  std::string estimator, sensors;
  double height = FlownLoopOptions().height;
};

std::string words(const std::vector<std::string>& names) { return internal::joined(names, " "); }

LqiDesign lqi_design(const FlownArguments& given) {
  LqiDesign design;
  if (given.dt) require_positive(*given.dt, "dt", "seconds");
  design.dt = given.dt.value_or(design.dt);
  const std::vector<std::string> states = names_of(ned_convention().states);
  const std::vector<std::string> inputs = names_of(ned_convention().wrench);
  if (given.integral) design.integrals = listed(given.integral);
  if (given.past) {
    if (*given.past < 0 || *given.past > kMaxPastCommands)
      throw OptionError("past",
                        fmt::format("past is {}, expected 0 to {}", *given.past, kMaxPastCommands));
    design.past = *given.past;
  }
  if (given.Q) {
    const std::vector<std::string> weighted = with_integrals(states, design.integrals);
    const Eigen::VectorXd Q = weights(*given.Q, weighted.size(), "Q", "states: " + words(weighted));
    design.Q = Q.head(12);
    design.Q_integral = Q.tail(Q.size() - 12);
  }
  if (given.R) {
    design.R = weights(*given.R, inputs.size(), "R", "inputs: " + words(inputs));
    if (!(design.R->minCoeff() > 0))
      throw OptionError("R", "R has a weight of 0, expected weights of more than 0");
  }
  if (given.change) {
    if (design.past && *design.past < 1)
      throw OptionError("change", "change came with past=0, expected past of at least 1");
    design.R_change = weights(*given.change, inputs.size(), "change", "inputs: " + words(inputs));
  }
  return design;
}

FlightOptions hover_options(const VehicleWord& vehicle, const FlownArguments& given) {
  FlightOptions flight;
  flight.vehicle = vehicle.text;
  flight.estimator = given.estimator;
  flight.sensors = given.sensors;
  require_flight_words(flight);
  return flight;
}

FlownLoopOptions hover_at(const FlownArguments& given) {
  require_positive(given.height, "height", "metres");
  FlownLoopOptions at;
  at.height = given.height;
  return at;
}

FlownLqr flown_lqr(const VehicleWord& word, const FlownArguments& given) {
  const LqiDesign design = lqi_design(given);
  const FlownLoopOptions at = hover_at(given);
  const FlightOptions flight = hover_options(word, given);
  return long_call([&](const Stop&) -> FlownLqr {
    Vehicle vehicle = load_vehicle(word.text);
    LqiReport report = lqi_report(vehicle, flown_lqi_options(vehicle, design), flight, at);
    return {std::move(report), std::move(vehicle)};
  });
}

FlownMatrix flown_matrix(const VehicleWord& word, const FlownArguments& given,
                         const PlantWords& plant, bool asks_for_inputs) {
  LqiDesign design = lqi_design(given);
  MatrixConvention matrix;
  matrix.convention = named_convention(plant.convention, "convention").name;
  if (asks_for_inputs) matrix.input_kind = input_kind(plant.inputs, "inputs");
  design.matrix = matrix;
  const FlownLoopOptions at = hover_at(given);
  const FlightOptions flight = hover_options(word, given);
  return long_call([&](const Stop&) -> FlownMatrix {
    Vehicle vehicle = load_vehicle(word.text);
    MatrixReport report = matrix_report(vehicle, design, flight, at);
    return {std::move(report), std::move(vehicle)};
  });
}

VehicleLqrReport ideal_lqr(const PlantWords& words_of_plant, const FlownArguments& given,
                           const std::string& method, const std::string& evidence) {
  const MarginsEvidence margins =
      evidence.empty() ? MarginsEvidence::full : margins_evidence(evidence);
  // Refused before the model is computed.
  if (lqr_method(method, "method") != LqrMethod::continuous && !given.dt)
    throw OptionError(
        "dt", fmt::format("dt is missing, expected a sample period with method '{}'", method));
  if (given.dt) require_positive(*given.dt, "dt", "seconds");
  return long_call([&](const Stop&) {
    LinearVehicle plant = make_plant(words_of_plant);
    const ContinuousLti& model = plant.model.plant;
    const LqrDesign design =
        lqr_design({given.Q, given.R, listed(given.integral), method, given.dt}, words_of_plant,
                   model.states, model.inputs);
    return lqr_report(std::move(plant), design, margins);
  });
}

/// The arguments that the ideal plant alone has, where they came.
struct IdealArguments {
  std::optional<std::string> at, convention, inputs, method, evidence;
  std::optional<double> speed, climb, radius, yaw_rate, yaw;
  std::optional<Names> states;

  /// The first that came; empty for none.
  [[nodiscard]] std::string first(bool matrix) const {
    const std::pair<const char*, bool> came[] = {{"at", at.has_value()},
                                                 {"speed", speed.has_value()},
                                                 {"climb", climb.has_value()},
                                                 {"radius", radius.has_value()},
                                                 {"yaw_rate", yaw_rate.has_value()},
                                                 {"yaw", yaw.has_value()},
                                                 {"convention", convention.has_value() && !matrix},
                                                 {"inputs", inputs.has_value() && !matrix},
                                                 {"states", states.has_value()},
                                                 {"method", method.has_value()},
                                                 {"evidence", evidence.has_value()}};
    for (const auto& [name, given] : came)
      if (given) return name;
    return "";
  }

  [[nodiscard]] PlantWords plant(const std::string& vehicle) const {
    PlantWords usual;
    return {vehicle,
            at.value_or(usual.at),
            speed.value_or(0),
            climb.value_or(0),
            radius.value_or(0),
            yaw_rate.value_or(0),
            yaw.value_or(0),
            convention.value_or(usual.convention),
            inputs.value_or(usual.inputs),
            states ? states->joined() : usual.states};
  }
};

/// What `lqr` of a vehicle gives, by plant and structure.
using VehicleLqr = std::variant<FlownLqr, FlownMatrix, VehicleLqrReport>;

VehicleLqr lqr_of_vehicle(const VehicleWord& vehicle, const FlownArguments& given,
                          const IdealArguments& ideal, const std::optional<std::string>& plant,
                          const std::optional<std::string>& structure) {
  if (structure && *structure != "dynamic" && *structure != "matrix")
    throw OptionError("structure",
                      fmt::format("structure is '{}', expected dynamic or matrix", *structure));
  const bool matrix = structure && *structure == "matrix";
  const std::string of_ideal = ideal.first(matrix);
  const bool flown = plant ? asks_for_flown_plant(*plant) : of_ideal.empty();
  if (flown && !of_ideal.empty())
    throw OptionError(of_ideal, of_ideal +
                                    " belongs to plant='ideal', expected none with "
                                    "plant='flown'");
  const bool of_flown =
      structure || given.change || given.past || !given.estimator.empty() || !given.sensors.empty();
  if (!flown && of_flown)
    throw OptionError("plant",
                      "change, past, estimator, sensors and structure belong to the flown plant, "
                      "expected none with plant='ideal'");
  if (matrix && (given.change || given.past || given.integral))
    throw OptionError(
        "structure",
        "change, past and integral came with structure='matrix', expected none "
        "because that law integrates px,py,pz,yaw and does not remember its commands");
  if (flown && matrix)
    return flown_matrix(vehicle, given, ideal.plant(vehicle.text), ideal.inputs.has_value());
  if (flown) return flown_lqr(vehicle, given);
  return ideal_lqr(ideal.plant(vehicle.text), given, ideal.method.value_or("continuous"),
                   ideal.evidence.value_or(""));
}

FlownLqg lqg_of_vehicle(const VehicleWord& word, const FlownArguments& given, double time,
                        bool recover, std::optional<double> noise_budget) {
  if (!recover && noise_budget)
    throw OptionError("noise_budget", "noise_budget came without recover, expected both");
  require_positive(time, "time", "seconds");
  if (time > 1e6) throw OptionError("time", "time is more than 1e6 s, expected at most that");
  const LqiDesign design = lqi_design(given);
  const FlownLoopOptions at = hover_at(given);
  const FlightOptions flight = hover_options(word, given);
  LqgOptions options;
  options.time = time;
  options.recover = recover;
  options.noise_budget = noise_budget.value_or(options.noise_budget);
  return long_call([&](const Stop&) -> FlownLqg {
    Vehicle vehicle = load_vehicle(word.text);
    options.design = flown_lqi_options(vehicle, design);
    LqgReport report = lqg_report(vehicle, options, flight, at);
    return {std::move(report), std::move(vehicle)};
  });
}

/// gains, flown, ideal and messages of a result that has an LqiReport or a MatrixReport.
template <class Type, class Report, class GainsOf>
void add_parts(Type& type, Report report, GainsOf gains) {
  using Result = typename Type::type;
  type.def_property_readonly(
          "gains", [=](const Result& result) -> const Gains& { return gains(result); },
          py::return_value_policy::reference_internal, "The gains with their names.")
      .def_property_readonly(
          "K", [=](const Result& result) -> const Eigen::MatrixXd& { return gains(result).K; },
          py::return_value_policy::reference_internal, "(nu, nx) of u = u0 + K (x_sp - x) + ...")
      .def_property_readonly(
          "K_int",
          [=](const Result& result) -> const Eigen::MatrixXd& { return gains(result).K_int; },
          py::return_value_policy::reference_internal, "(nu, ni) gain of the integrals.")
      .def_property_readonly(
          "flown", [=](const Result& result) -> const FlownLoop& { return report(result).flown; },
          py::return_value_policy::reference_internal, "The loop as it flies about a hover.")
      .def_property_readonly(
          "ideal",
          [=](const Result& result) -> const MarginsReport& { return report(result).ideal; },
          py::return_value_policy::reference_internal,
          "Margins with true states, rotors without lag and no delays.")
      .def_property_readonly(
          "messages", [=](const Result& result) { return report(result).messages; },
          "\"note: ...\" and \"warning: ...\".");
}

void add_results(py::module_& module) {
  py::class_<FlownLqr> lqi(module, "FlownLqr",
                           "State feedback with integrals, designed on the flown plant.");
  add_parts(
      lqi, [](const FlownLqr& self) -> const LqiReport& { return self.report; },
      [](const FlownLqr& self) -> const Gains& { return self.report.design.lqi.gains; });
  lqi.def_property_readonly(
         "riccati",
         [](const FlownLqr& self) -> const RiccatiResult& {
           return self.report.design.lqi.riccati;
         },
         py::return_value_policy::reference_internal, "The solution of the Riccati equation.")
      .def_property_readonly(
          "met", [](const FlownLqr& self) { return self.report.design.met; },
          "Whether every channel has the margins that are asked for.");
  add_report(
      lqi, "quadtune lqr V",
      [](const FlownLqr& self) { return report::to_json(self.report, self.vehicle); },
      [](const FlownLqr& self) { return report::to_text(self.report); });

  py::class_<FlownMatrix> matrix(module, "MatrixLqr",
                                 "Gains for programs that hold matrices alone, designed on the "
                                 "flown plants.");
  add_parts(
      matrix, [](const FlownMatrix& self) -> const MatrixReport& { return self.report; },
      [](const FlownMatrix& self) -> const Gains& { return self.report.gains; });
  add_report(
      matrix, "quadtune lqr V --structure matrix",
      [](const FlownMatrix& self) { return report::to_json(self.report, self.vehicle); },
      [](const FlownMatrix& self) { return report::to_text(self.report); });

  py::class_<VehicleLqrReport> ideal(module, "IdealLqr",
                                     "State feedback on the textbook plant of a vehicle.");
  ideal
      .def_property_readonly(
          "riccati",
          [](const VehicleLqrReport& self) -> const RiccatiResult& {
            return self.feedback.riccati;
          },
          py::return_value_policy::reference_internal, "The solution of the Riccati equation.")
      .def_property_readonly(
          "solved", [](const VehicleLqrReport& self) { return self.feedback.solved(); },
          "Whether there is a solution; otherwise riccati.culprit names the mode.")
      .def_property_readonly(
          "K",
          [](const VehicleLqrReport& self) -> const Eigen::MatrixXd& { return self.feedback.K; },
          py::return_value_policy::reference_internal, "(nu, nx); NaN unless solved.")
      .def_property_readonly(
          "K_int",
          [](const VehicleLqrReport& self) -> const Eigen::MatrixXd& {
            return self.feedback.K_int;
          },
          py::return_value_policy::reference_internal, "(nu, ni); NaN unless solved.")
      .def_readonly("gains", &VehicleLqrReport::gains, "The gains with their names.")
      .def_readonly("poles", &VehicleLqrReport::poles, "(n) of the loop as it is sampled.")
      .def_readonly("margins", &VehicleLqrReport::margins, "At the inputs.")
      .def_readonly("flown", &VehicleLqrReport::flown, "FlownLoop, or None.")
      .def_property_readonly(
          "model",
          [](const VehicleLqrReport& self) -> const Linearization& { return self.plant.model; },
          py::return_value_policy::reference_internal, "The linear model.")
      .def_readonly("messages", &VehicleLqrReport::messages, "\"note: ...\" and \"warning: ...\".");
  const auto solved = [](const VehicleLqrReport& self) -> const VehicleLqrReport& {
    const RiccatiResult& riccati = self.feedback.riccati;
    if (!riccati.solved())
      throw NoSolution(fmt::format("lqr: {}: {}", to_string(riccati.status), riccati.culprit),
                       self.plant.vehicle.name);
    return self;
  };
  add_report(
      ideal, "quadtune lqr V --plant ideal",
      [=](const VehicleLqrReport& self) { return report::to_json(solved(self)); },
      [=](const VehicleLqrReport& self) { return report::to_text(solved(self)); });
}

void add_lqg_results(py::module_& module) {
  py::class_<PredictedRms>(module, "PredictedRms",
                           "Standard deviations that the noise of the sensors causes in calm air.")
      .def_readonly("time", &PredictedRms::time, "Since the vehicle was at rest [s].")
      .def_readonly("state", &PredictedRms::state, "(12) of the true states, in SI units.")
      .def_readonly("error", &PredictedRms::error,
                    "(12) of the errors of the estimates, in SI units.")
      .def_readonly("command", &PredictedRms::command, "(nu) of the commands, in SI units.")
      .def_readonly("turned", &PredictedRms::turned,
                    "(12) the part by which the heading turns; contained in state.");
  py::class_<FlownLqg> type(module, "Lqg", "State feedback together with its filter.");
  add_parts(
      type, [](const FlownLqg& self) -> const LqiReport& { return self.report.lqi; },
      [](const FlownLqg& self) -> const Gains& { return self.report.lqi.design.lqi.gains; });
  type.def_property_readonly(
          "at_estimates",
          [](const FlownLqg& self) -> const MarginsReport& { return self.report.at_estimates; },
          py::return_value_policy::reference_internal,
          "Margins of the loop cut where the law reads its estimates.")
      .def_property_readonly(
          "rms", [](const FlownLqg& self) -> const PredictedRms& { return self.report.rms; },
          py::return_value_policy::reference_internal, "Predicted deviations.")
      .def_property_readonly(
          "recovery", [](const FlownLqg& self) { return self.report.recovery; },
          "The factor on the noise of the filter that was chosen.");
  add_report(
      type, "quadtune lqg V",
      [](const FlownLqg& self) { return report::to_json(self.report, self.vehicle); },
      [](const FlownLqg& self) { return report::to_text(self.report); });
}

}  // namespace

void add_feedback(py::module_& module) {
  add_results(module);
  add_lqg_results(module);
  const double height = FlownLoopOptions().height;
  using Text = std::optional<std::string>;
  using Number = std::optional<double>;
  module.def(
      "lqr",
      [](const VehicleWord& vehicle, std::optional<Numbers> Q, std::optional<Numbers> R,
         std::optional<Names> integral, Number dt, Text plant, Text structure,
         std::optional<Numbers> change, std::optional<int> past, std::string estimator,
         std::string sensors, double at_height, Text at, Number speed, Number climb, Number radius,
         Number yaw_rate, Number yaw, Text convention, Text inputs, std::optional<Names> states,
         Text method, Text evidence) {
        const FlownArguments given{
            std::move(Q), std::move(R), std::move(change),    std::move(integral),
            dt,           past,         std::move(estimator), std::move(sensors),
            at_height};
        const IdealArguments ideal{at,    convention, inputs,   method, evidence,         speed,
                                   climb, radius,     yaw_rate, yaw,    std::move(states)};
        return lqr_of_vehicle(vehicle, given, ideal, plant, structure);
      },
      "vehicle"_a, py::kw_only(), "Q"_a = py::none(), "R"_a = py::none(), "integral"_a = py::none(),
      "dt"_a = py::none(), "plant"_a = py::none(), "structure"_a = py::none(),
      "change"_a = py::none(), "past"_a = py::none(), "estimator"_a = "", "sensors"_a = "",
      "height"_a = height, "at"_a = py::none(), "speed"_a = py::none(), "climb"_a = py::none(),
      "radius"_a = py::none(), "yaw_rate"_a = py::none(), "yaw"_a = py::none(),
      "convention"_a = py::none(), "inputs"_a = py::none(), "states"_a = py::none(),
      "method"_a = py::none(), "evidence"_a = py::none(), py::prepend(),
      "State feedback of a vehicle about a trim.\n\n"
      "plant: \"flown\" (default) includes motor lag, delays of sensors and the estimator and\n"
      "returns FlownLqr, with structure=\"matrix\" MatrixLqr; \"ideal\", which the arguments\n"
      "from `at` on imply, is the textbook plant and returns IdealLqr. Q: weights >= 0 of the\n"
      "states, then of the integrals; R > 0: of the inputs; one number stands for all.\n"
      "Default: Bryson's rule, on the ideal plant 1. integral: states to integrate. dt > 0:\n"
      "sample period [s], by default 0.005. change >= 0: weights of the changes of the\n"
      "commands. past >= 0: control periods by which the law predicts. estimator, sensors as\n"
      "fly(); height > 0 of the hover [m]. at to states as linearize(); method:\n"
      "\"continuous\", \"discrete\" (weights per step) or \"sampled\" (exact cost); evidence:\n"
      "\"none\", \"essential\" or \"full\" margins. An ideal problem without solution is a\n"
      "result with solved == False. Raises NoSolution if there is no trim or no law on the\n"
      "flown plant, InvalidInput for a wrong argument, FileError if a file cannot be read.");
  module.def(
      "lqg",
      [](const VehicleWord& vehicle, std::optional<Numbers> Q, std::optional<Numbers> R,
         std::optional<Names> integral, Number dt, std::optional<Numbers> change,
         std::optional<int> past, std::string estimator, std::string sensors, double at_height,
         double time, bool recover, Number noise_budget) {
        const FlownArguments given{
            std::move(Q), std::move(R), std::move(change),    std::move(integral),
            dt,           past,         std::move(estimator), std::move(sensors),
            at_height};
        return lqg_of_vehicle(vehicle, given, time, recover, noise_budget);
      },
      "vehicle"_a, py::kw_only(), "Q"_a = py::none(), "R"_a = py::none(), "integral"_a = py::none(),
      "dt"_a = py::none(), "change"_a = py::none(), "past"_a = py::none(), "estimator"_a = "",
      "sensors"_a = "", "height"_a = height, "time"_a = LqgOptions().time, "recover"_a = false,
      "noise_budget"_a = py::none(),
      "State feedback and filter of a vehicle together: predicted deviations and margins.\n"
      "\n"
      "Arguments and exceptions as lqr() on the flown plant. time > 0 and at most 1e6: of the\n"
      "prediction [s]. recover: raise the noise that the filter assumes where that gives larger\n"
      "margins; noise_budget > 1: largest factor on the rms of a command.");
}

}  // namespace quadtune::python
