// SPDX-License-Identifier: Apache-2.0
/// LQG controllers of matrices.
#include <fmt/format.h>

#include "controllers.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/systems/matrix_lqr.hpp"
#include "report/loops/matrix_loops.hpp"
#include "support/arguments.hpp"
#include "support/interrupts.hpp"
#include "support/results.hpp"
#include "support/topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using Matrix = Eigen::MatrixXd;
using Report = MatrixLqgReport;

LqgEstimate estimate_of(const std::optional<std::string>& word, MatrixTime time) {
  if (!word) return LqgEstimate::current;
  if (*word != "current" && *word != "delayed")
    throw OptionError("estimate",
                      fmt::format("estimate is '{}', expected current or delayed", *word));
  if (time == MatrixTime::continuous)
    throw OptionError("estimate",
                      "estimate came with a continuous problem, expected discrete or sampled");
  return *word == "delayed" ? LqgEstimate::delayed : LqgEstimate::current;
}

Report lqg(Matrix A, Matrix B, Matrix C, Matrix Q, Matrix R, Matrix noise_Q, Matrix noise_R,
           std::optional<Matrix> D, std::optional<Matrix> N, std::optional<Matrix> G,
           std::optional<Matrix> noise_N, bool discrete, std::optional<double> sampled,
           std::optional<double> dt, const std::optional<std::string>& estimate) {
  if (discrete && sampled)
    throw OptionError("sampled", "sampled came with discrete, expected one of them");
  if (sampled) require_positive(*sampled, "sampled", "seconds");
  if (dt && !discrete) throw OptionError("dt", "dt came without discrete=True, expected both");
  if (dt) require_positive(*dt, "dt", "seconds");
  const auto or_empty = [](std::optional<Matrix>& matrix) {
    return std::move(matrix).value_or(Matrix());
  };
  MatrixLqgProblem problem;
  problem.A = std::move(A);
  problem.B = std::move(B);
  problem.C = std::move(C);
  problem.D = or_empty(D);
  problem.weights = {std::move(Q), std::move(R), or_empty(N)};
  problem.noise = {or_empty(G), std::move(noise_Q), std::move(noise_R), or_empty(noise_N)};
  problem.time = sampled    ? MatrixTime::sampled
                 : discrete ? MatrixTime::discrete
                            : MatrixTime::continuous;
  problem.dt = sampled.value_or(dt.value_or(1));
  problem.estimate = estimate_of(estimate, problem.time);
  return long_call([&](const Stop&) { return matrix_lqg(problem); });
}

/// Empty if both equations are solved.
std::string culprit_of(const Report& self) {
  if (!self.lqr.solved())
    return fmt::format("{}: {}", to_string(self.lqr.status), self.lqr.culprit);
  if (!self.filter.solved())
    return fmt::format("filter: {}: {}", to_string(self.filter.status), self.filter.culprit);
  return "";
}

/// @throws NoSolution  as the command, which prints solutions alone
const Report& solved(const Report& self) {
  if (!self.solved()) throw NoSolution("lqg: " + culprit_of(self), "A");
  return self;
}

}  // namespace

void add_regulators(py::module_& module) {
  py::class_<Report> type(module, "MatrixLqg",
                          "LQR and Kalman filter of matrices as one controller.");
  const auto matrix = [&](const char* name, auto member, const char* doc) {
    type.def_property_readonly(name, member, py::return_value_policy::reference_internal, doc);
  };
  type.def_property_readonly("solved", &Report::solved, "Whether both equations are solved.")
      .def_property_readonly("culprit", &culprit_of,
                             "The equation and the mode that prevents a solution; empty when "
                             "solved.")
      .def_readonly("riccati", &Report::lqr, "The solution of the Riccati equation of the LQR.");
  matrix(
      "K", [](const Report& self) -> const Matrix& { return self.lqr.K; },
      "(nu, nx) gain of u = -K x; NaN unless solved.");
  matrix(
      "S", [](const Report& self) -> const Matrix& { return self.lqr.X; },
      "(nx, nx) cost matrix of the LQR; NaN unless solved.");
  matrix(
      "L", [](const Report& self) -> const Matrix& { return self.filter.L; },
      "(nx, ny) predictor gain, or the gain of a continuous filter; NaN unless solved.");
  matrix(
      "M", [](const Report& self) -> const Matrix& { return self.filter.M; },
      "(nx, ny) filter gain; empty of a continuous filter.");
  matrix(
      "P", [](const Report& self) -> const Matrix& { return self.filter.P; },
      "(nx, nx) error covariance before the measurement; NaN unless solved.");
  type.def_property_readonly(
          "controller",
          [](const Report& self) { return controller_of(self.A, self.B, self.C, self.D); },
          "Controller from y to -u, whose states are the estimates; empty unless solved.")
      .def_readonly("dt", &Report::dt, "Sample period [s]; 0 of a continuous controller.")
      .def_readonly("poles", &Report::poles, "(2 nx) of the closed loop; empty unless solved.")
      .def_readonly("cost", &Report::cost, "Mean cost, per step if discrete; NaN unless solved.")
      .def_readonly("state_rms", &Report::state_rms,
                    "(nx) standard deviations in the closed loop; empty unless solved.")
      .def_readonly("input_rms", &Report::input_rms,
                    "(nu) standard deviations of u; empty unless solved.")
      .def_readonly("margins", &Report::margins, "At the inputs u1, u2, ...")
      .def_readonly("messages", &Report::messages, "\"warning: ...\" and \"note: ...\".");
  add_report(
      type, "quadtune lqg", [](const Report& self) { return report::to_json(solved(self)); },
      [](const Report& self) { return report::to_text(solved(self)); });
  module.def(
      "lqg", &lqg, "A"_a, "B"_a, "C"_a, "Q"_a, "R"_a, "noise_Q"_a, "noise_R"_a, py::kw_only(),
      "D"_a = py::none(), "N"_a = py::none(), "G"_a = py::none(), "noise_N"_a = py::none(),
      "discrete"_a = false, "sampled"_a = py::none(), "dt"_a = py::none(),
      "estimate"_a = py::none(),
      "LQR and Kalman filter of matrices as one controller.\n\n"
      "A (nx, nx), B (nx, nu), C (ny, nx), D (ny, nu) or None for zero. Weights Q (nx, nx) >=\n"
      "0, R (nu, nu) > 0 and N (nx, nu) as lqr(); noise_Q (nw, nw) >= 0, noise_R (ny, ny) > 0,\n"
      "noise_N (nw, ny) and G (nx, nw) as Q, R, N and G of kalman(). Continuous by default;\n"
      "discrete=True for a sampled plant, dt > 0 [s] (1 by default) its period; sampled > 0\n"
      "[s] for a continuous problem whose input is held for so long. estimate, unless\n"
      "continuous: \"current\" (default), the command uses the measurement of its sample, or\n"
      "\"delayed\", it does not. A problem without solution is a result with solved == False\n"
      "and its culprit. Raises InvalidInput for wrong shapes, entries that are not finite, and\n"
      "weights and covariances out of range.");
}

}  // namespace quadtune::python
