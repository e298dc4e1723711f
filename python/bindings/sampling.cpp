// SPDX-License-Identifier: Apache-2.0
/// Discretization of one system, or the comparison of the methods on a vehicle's loops.
#include <fmt/format.h>

#include <type_traits>
#include <variant>

#include "quadtune/discretize/delay.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/flown/plant_word.hpp"
#include "quadtune/workbench/sampling/method_comparison.hpp"
#include "quadtune/workbench/sampling/sampled_plant.hpp"
#include "report/loops/loops.hpp"
#include "support/arguments.hpp"
#include "support/interrupts.hpp"
#include "support/real.hpp"
#include "support/results.hpp"
#include "support/topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

SamplingOptions sampling(const std::string& method, double dt, std::optional<double> prewarp,
                         bool inverse) {
  require_positive(dt, "dt", "seconds");
  const SamplingOptions by{discretization_method(method, "method"), dt, prewarp};
  if (inverse && by.method != DiscretizationMethod::zoh &&
      by.method != DiscretizationMethod::tustin)
    throw OptionError("inverse",
                      fmt::format("inverse came with method '{}', expected zoh or tustin", method));
  require_prewarp(by);
  return by;
}

template <class Lti>
Lti plant_of(Matrix A, Matrix B, std::optional<Matrix> C, std::optional<Matrix> D) {
  Lti plant;
  plant.C = C ? std::move(*C) : Matrix::Identity(A.rows(), A.rows()).eval();
  plant.D = D ? std::move(*D) : Matrix::Zero(plant.C.rows(), B.cols()).eval();
  plant.A = std::move(A);
  plant.B = std::move(B);
  return plant;
}

SampledPlant of_matrices(Matrix A, Matrix B, std::optional<Matrix> C, std::optional<Matrix> D,
                         double dt, const std::string& method, std::optional<double> prewarp,
                         const std::optional<Numbers>& input_delay,
                         const std::optional<Numbers>& output_delay, bool inverse) {
  const SamplingOptions by = sampling(method, dt, prewarp, inverse);
  if (inverse) {
    if (input_delay || output_delay)
      throw OptionError(input_delay ? "input_delay" : "output_delay",
                        "a delay came with inverse, expected none because the delays of a discrete "
                        "plant are states of it");
    return continuous_plant(
        plant_of<DiscreteLti>(std::move(A), std::move(B), std::move(C), std::move(D)), by);
  }
  const auto plant =
      plant_of<ContinuousLti>(std::move(A), std::move(B), std::move(C), std::move(D));
  const auto values = [](const std::optional<Numbers>& delay) {
    return delay ? delay->values : Vector();
  };
  ChannelDelays delays;
  delays.input = channel_delays(values(input_delay), "input-delay", plant.B.cols(), "inputs");
  delays.output = channel_delays(values(output_delay), "output-delay", plant.C.rows(), "outputs");
  return sampled_plant(plant, delays, by);
}

SampledPlant of_fraction(const Numbers& num, const Numbers& den, Real dt, Real delay,
                         const std::string& method, std::optional<Real> prewarp, bool inverse) {
  const SamplingOptions by = sampling(method, dt, prewarp, inverse);
  if (inverse) {
    DiscreteTransferFunction plant;
    plant.num = num.values;
    plant.den = den.values;
    return continuous_plant(std::move(plant), delay, by);
  }
  return sampled_plant(ContinuousTransferFunction{num.values, den.values, delay}, by);
}

template <class Plant>
constexpr bool kIsLti = std::is_same_v<Plant, DiscreteLti> || std::is_same_v<Plant, ContinuousLti>;

template <class Value>
std::optional<py::array> view_in(const Value& value, py::handle owner) {
  const py::object array = py::cast(value, py::return_value_policy::reference_internal, owner);
  return py::reinterpret_borrow<py::array>(array);
}

/// A matrix of the plant; None of a transfer function.
template <class Pick>
auto matrix(Pick pick) {
  return [pick](py::object self) -> std::optional<py::array> {
    return std::visit(
        [&](const auto& plant) -> std::optional<py::array> {
          if constexpr (kIsLti<std::decay_t<decltype(plant)>>)
            return view_in(pick(plant), self);
          else
            return std::nullopt;
        },
        self.cast<const SampledPlant&>().plant);
  };
}

/// A polynomial of a transfer function; None of matrices.
template <class Pick>
auto polynomial_of(Pick pick) {
  return [pick](py::object self) -> std::optional<py::array> {
    return std::visit(
        [&](const auto& plant) -> std::optional<py::array> {
          if constexpr (kIsLti<std::decay_t<decltype(plant)>>)
            return std::nullopt;
          else
            return view_in(pick(plant), self);
        },
        self.cast<const SampledPlant&>().plant);
  };
}

std::optional<double> delay_of(const SampledPlant& sampled) {
  return std::visit(
      [](const auto& plant) -> std::optional<double> {
        if constexpr (kIsLti<std::decay_t<decltype(plant)>>)
          return std::nullopt;
        else
          return plant.delay;
      },
      sampled.plant);
}

void add_discretize(py::module_& module) {
  py::class_<SampledPlant> type(module, "SampledPlant",
                                "A plant that was sampled, or taken back to continuous time.");
  type.def_property_readonly("A",
                             matrix([](const auto& plant) -> const Matrix& { return plant.A; }),
                             "(nx, nx); None of a transfer function.")
      .def_property_readonly("B",
                             matrix([](const auto& plant) -> const Matrix& { return plant.B; }),
                             "(nx, nu); None of a transfer function.")
      .def_property_readonly("C",
                             matrix([](const auto& plant) -> const Matrix& { return plant.C; }),
                             "(ny, nx); None of a transfer function.")
      .def_property_readonly("D",
                             matrix([](const auto& plant) -> const Matrix& { return plant.D; }),
                             "(ny, nu); None of a transfer function.")
      .def_property_readonly(
          "num", polynomial_of([](const auto& plant) -> const Vector& { return plant.num; }),
          "Descending powers; None of matrices.")
      .def_property_readonly(
          "den", polynomial_of([](const auto& plant) -> const Vector& { return plant.den; }),
          "Descending powers; None of matrices.")
      .def_property_readonly(
          "delay", &delay_of,
          "Of a transfer function: whole samples of a discrete one, seconds of a continuous one.")
      .def_property_readonly(
          "dt", [](const SampledPlant& plant) { return plant.by.dt; }, "Sample period [s].")
      .def_property_readonly(
          "method", [](const SampledPlant& plant) { return to_string(plant.by.method); },
          "\"zoh\", \"tustin\", ...")
      .def_readonly("warnings", &SampledPlant::warnings,
                    "For example of a period that is too long.");
  add_report(
      type, "quadtune discretize", [](const SampledPlant& plant) { return report::to_json(plant); },
      [](const SampledPlant& plant) { return report::to_text(plant); });
  module.def(
      "discretize", &of_matrices, "A"_a, "B"_a, "C"_a = py::none(), "D"_a = py::none(),
      py::kw_only(), "dt"_a, "method"_a = "zoh", "prewarp"_a = py::none(),
      "input_delay"_a = py::none(), "output_delay"_a = py::none(), "inverse"_a = false,
      "Sample a continuous system of matrices, or with inverse=True take a discrete one back.\n\n"
      "A (nx, nx), B (nx, nu), C (ny, nx) or None for the states, D (ny, nu) or None for zero.\n"
      "dt > 0: sample period [s]. method: \"zoh\", \"foh\", \"impulse\", \"euler\",\n"
      "\"backward-euler\", \"tustin\" or \"matched\". prewarp > 0: frequency at which tustin\n"
      "is exact [rad/s]. input_delay, output_delay >= 0 [s]: of all channels, or of each (nu),\n"
      "(ny). Raises InvalidInput for wrong shapes, entries that are not finite, numbers out of\n"
      "range, and a method that cannot be taken back.");
  module.def("discretize", &of_fraction, py::kw_only(), "num"_a, "den"_a, "dt"_a, "delay"_a = 0.0,
             "method"_a = "zoh", "prewarp"_a = py::none(), "inverse"_a = false,
             "The same of a transfer function.\n\n"
             "num, den: coefficients in descending powers of s, or with inverse=True of z.\n"
             "delay >= 0 [s]. The other arguments, and the exceptions, as for matrices.");
}

void add_comparison(py::module_& module) {
  py::class_<MethodComparison> type(module, "MethodComparison",
                                    "What each sampling method makes of a vehicle's loops.");
  type.def_readonly("vehicle", &MethodComparison::vehicle, "Name of the vehicle.")
      .def_readonly("dt", &MethodComparison::dt, "Sample period [s].")
      .def_readonly("periods", &MethodComparison::periods, "dt/2, dt and 2 dt [s].");
  add_report(
      type, "quadtune discretize V --compare",
      [](const MethodComparison& comparison) { return report::to_json(comparison); },
      [](const MethodComparison& comparison) { return report::to_text(comparison); });
  module.def(
      "compare_methods",
      [](const VehicleWord& vehicle, double dt, const std::string& plant) {
        require_positive(dt, "dt", "seconds");
        const bool flown = asks_for_flown_plant(plant);
        return long_call(
            [&](const Stop&) { return compare_sampling_methods(vehicle.text, dt, flown); });
      },
      "vehicle"_a, "dt"_a, py::kw_only(), "plant"_a = "flown",
      "Compare every sampling method on the LQR and PID loops of a vehicle.\n\n"
      "dt > 0 [s]: the methods are compared at dt/2, dt and 2 dt. plant: \"flown\" or\n"
      "\"ideal\". Raises InvalidInput for a wrong argument, NoSolution if the vehicle has no\n"
      "loops to compare, FileError if its file cannot be read.");
}

}  // namespace

void add_sampling(py::module_& module) {
  add_discretize(module);
  add_comparison(module);
}

}  // namespace quadtune::python
