// SPDX-License-Identifier: Apache-2.0
#include "controllers.hpp"

#include <fmt/format.h>

#include "quadtune/errors.hpp"
#include "support/arguments.hpp"
#include "support/results.hpp"
#include "support/topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using Matrix = Eigen::MatrixXd;

LoopController make_controller(const std::optional<Matrix>& A, const std::optional<Matrix>& B,
                               const std::optional<Matrix>& C, const std::optional<Matrix>& D,
                               const std::optional<Numbers>& num, const std::optional<Numbers>& den,
                               const std::optional<Numbers>& pid, const std::string& integrator) {
  const bool fraction = num || den;
  const bool dynamic = A || B || C;
  if (int{fraction} + int{dynamic || D} + int{pid.has_value()} != 1)
    throw OptionError("num", "expected one of num with den, A, B, C and D, D alone, or pid");
  const PidMethod method = integrator_method(integrator);
  if (pid) return controller_of(pid_gains_of(*pid, "pid"), method);
  LoopController controller;
  if (fraction) {
    if (!num || !den)
      throw OptionError(num ? "den" : "num", "num and den belong together, expected both");
    controller.num = num->values;
    controller.den = den->values;
    return controller;
  }
  if (dynamic && !(A && B && C))
    throw OptionError(!A ? "A" : !B ? "B" : "C", "A, B and C belong together, expected all three");
  const Matrix none;
  return controller_of(A.value_or(none), B.value_or(none), C.value_or(none), D.value_or(none));
}

std::string kind_of(const LoopController& controller) {
  if (controller.pid) return "PID";
  if (controller.den.size()) return "transfer function";
  return controller.A.size() ? "matrices" : "gain";
}

}  // namespace

LoopController controller_of(const Matrix& A, const Matrix& B, const Matrix& C, const Matrix& D) {
  LoopController controller;
  controller.A = A;
  controller.B = B;
  controller.C = C;
  controller.D = D;
  return controller;
}

LoopController controller_of(const PidGains& gains, PidMethod method) {
  LoopController controller;
  controller.pid = gains;
  controller.method = method;
  return controller;
}

PidGains pid_gains_of(const Numbers& numbers, const char* name) {
  const Eigen::VectorXd& given = numbers.values;
  if (given.size() < 1 || given.size() > 4)
    throw OptionError(name, fmt::format("{} has {} numbers, expected Kp, Ki, Kd and Tf, of which "
                                        "the last may be omitted",
                                        name, given.size()));
  const auto at = [&](Eigen::Index i) { return i < given.size() ? given(i) : 0.0; };
  if (!(at(3) >= 0))
    throw OptionError(name, fmt::format("{} has a Tf of {} s, expected 0 or more", name, at(3)));
  return {at(0), at(1), at(2), at(3)};
}

PidMethod integrator_method(const std::string& word) {
  try {
    return pid_method(word, "integrator");
  } catch (const InvalidInput& error) {
    throw OptionError("integrator", error.what());
  }
}

void add_controllers(py::module_& module) {
  py::class_<LoopController> type(
      module, "Controller",
      "A controller from the output y of a plant to -u, for margins().\n\n"
      "One of: a transfer function; matrices; a constant gain; a PID controller. In a\n"
      "continuous loop it is continuous, in a discrete loop discrete with the sample period of\n"
      "the loop.");
  type.def(
      py::init(&make_controller), "A"_a = py::none(), "B"_a = py::none(), "C"_a = py::none(),
      "D"_a = py::none(), py::kw_only(), "num"_a = py::none(), "den"_a = py::none(),
      "pid"_a = py::none(), "integrator"_a = "tustin",
      "Define a controller in one of four ways.\n\n"
      "A (nc, nc), B (nc, ny), C (nu, nc) and D (nu, ny) or None for zero, where ny and nu are\n"
      "the numbers of outputs and inputs of the plant. D alone: a constant gain. num, den:\n"
      "coefficients in descending powers of s, or of z in a discrete loop, for ny = nu = 1.\n"
      "pid: the gains Kp, Ki [1/s], Kd [s] and the time constant Tf >= 0 [s] of the filter of\n"
      "the derivative, the last of which may be omitted. integrator: \"euler\",\n"
      "\"backward-euler\" or \"tustin\", by which a discrete loop discretizes pid. Raises\n"
      "InvalidInput unless one of the ways is complete; margins() checks the shapes.");
  const auto matrix = [&](const char* name, Matrix LoopController::*member, const char* doc) {
    type.def_readonly(name, member, doc);
  };
  matrix("A", &LoopController::A, "(nc, nc); empty unless the controller has matrices.");
  matrix("B", &LoopController::B, "(nc, ny); empty unless the controller has matrices.");
  matrix("C", &LoopController::C, "(nu, nc); empty unless the controller has matrices.");
  matrix("D", &LoopController::D, "(nu, ny); empty for zero.");
  type.def_readonly("num", &LoopController::num, "Numerator; empty unless a transfer function.")
      .def_readonly("den", &LoopController::den, "Denominator; empty unless a transfer function.")
      .def_property_readonly(
          "pid",
          [](const LoopController& self) -> std::optional<std::vector<double>> {
            if (!self.pid) return std::nullopt;
            return std::vector<double>{self.pid->Kp, self.pid->Ki, self.pid->Kd, self.pid->Tf};
          },
          "Kp, Ki [1/s], Kd [s] and Tf [s], or None unless a PID controller.")
      .def("__repr__", [](const LoopController& self) {
        return fmt::format("<Controller: {}>", kind_of(self));
      });
}

}  // namespace quadtune::python
