// SPDX-License-Identifier: Apache-2.0
/// LQR, LQI and Kalman filters of matrices.
#include <fmt/format.h>

#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/synthesis/kalman.hpp"
#include "quadtune/workbench/systems/matrix_lqr.hpp"
#include "report/gains/gains.hpp"
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

/// The noise of a model that is measured every dt seconds.
struct NoisePerStep {
  Matrix A, Q, R;
};

/// A filter with the period that its JSON and its text need.
struct SteadyFilter {
  KalmanResult result;
  double dt = 0;  ///< [s]; 1 of a discrete model, 0 of a continuous filter
  std::optional<NoisePerStep> sampled = {};
};

Matrix or_empty(std::optional<Matrix> matrix) { return std::move(matrix).value_or(Matrix()); }

/// @throws NoSolution  as the commands do, which print solutions alone
template <class Result>
const Result& solved(const Result& result, const char* verb) {
  if (!result.solved())
    throw NoSolution(fmt::format("{}: {}: {}", verb, to_string(result.status), result.culprit),
                     "A");
  return result;
}

void require_one_time(bool discrete, const std::optional<double>& sampled) {
  if (discrete && sampled)
    throw OptionError("sampled", "sampled came with discrete, expected one of them");
  if (sampled) require_positive(*sampled, "sampled", "seconds");
}

MatrixLqrReport lqr_of_matrices(Matrix A, Matrix B, Matrix Q, Matrix R, std::optional<Matrix> N,
                                std::optional<Matrix> C, std::optional<Matrix> D, int delay,
                                bool discrete, std::optional<double> sampled,
                                std::optional<double> dt,
                                const std::optional<std::string>& evidence) {
  require_one_time(discrete, sampled);
  if (dt && !discrete) throw OptionError("dt", "dt came without discrete=True, expected both");
  if (dt) require_positive(*dt, "dt", "seconds");
  constexpr int kMaxDelay = 2000;
  if (delay < 0 || delay > kMaxDelay)
    throw OptionError("delay",
                      fmt::format("delay is {} samples, expected 0 to {}", delay, kMaxDelay));
  if (delay > 0 && !discrete && !sampled)
    throw OptionError("delay", "delay is in samples, expected discrete or sampled with it");
  if (D && !C) throw OptionError("D", "D came without C, the outputs that are integrated");
  std::optional<MarginsEvidence> margins;
  if (evidence) margins = margins_evidence(*evidence);
  MatrixLqrProblem problem;
  problem.lqr = {std::move(A),
                 std::move(B),
                 {std::move(Q), std::move(R), or_empty(std::move(N))},
                 discrete,
                 sampled};
  problem.C = or_empty(std::move(C));
  problem.D = or_empty(std::move(D));
  problem.dt = dt.value_or(problem.dt);
  problem.delay = delay;
  return long_call([&](const Stop&) { return matrix_lqr(problem, margins); });
}

SteadyFilter filter_of_matrices(Matrix A, Matrix C, Matrix Q, Matrix R, std::optional<Matrix> G,
                                std::optional<Matrix> N, bool discrete,
                                std::optional<double> sampled) {
  require_one_time(discrete, sampled);
  const KalmanNoise noise{or_empty(std::move(G)), std::move(Q), std::move(R),
                          or_empty(std::move(N))};
  return long_call([&](const Stop&) -> SteadyFilter {
    if (discrete) {
      DiscreteLti model;
      model.A = std::move(A);
      model.C = std::move(C);
      return {kalman(model, noise), 1};
    }
    ContinuousLti model;
    model.A = std::move(A);
    model.C = std::move(C);
    if (!sampled) return {kalman(model, noise), 0};
    SampledKalman problem = sampled_kalman(model, noise, *sampled);
    SteadyFilter filter{kalman(problem.model, problem.noise), *sampled};
    filter.sampled = {std::move(problem.model.A), std::move(problem.noise.Q),
                      std::move(problem.noise.R)};
    return filter;
  });
}

void add_sampled(py::module_& module) {
  py::class_<SampledLqr> cost(module, "SampledCost",
                              "A continuous LQR problem whose input is held, per step.");
  cost.def_property_readonly(
          "A", [](const SampledLqr& self) -> const Matrix& { return self.plant.A; },
          py::return_value_policy::reference_internal, "(nx, nx) of the sampled plant.")
      .def_property_readonly(
          "B", [](const SampledLqr& self) -> const Matrix& { return self.plant.B; },
          py::return_value_policy::reference_internal, "(nx, nu) of the sampled plant.")
      .def_property_readonly(
          "Q", [](const SampledLqr& self) -> const Matrix& { return self.weights.Q; },
          py::return_value_policy::reference_internal, "(nx, nx) weights of the states per step.")
      .def_property_readonly(
          "R", [](const SampledLqr& self) -> const Matrix& { return self.weights.R; },
          py::return_value_policy::reference_internal, "(nu, nu) weights of the inputs per step.")
      .def_property_readonly(
          "N", [](const SampledLqr& self) -> const Matrix& { return self.weights.N; },
          py::return_value_policy::reference_internal, "(nx, nu) cross weights per step.");
  py::class_<NoisePerStep>(module, "SampledNoise",
                           "A continuous model with noise that is measured at samples, per step.")
      .def_readonly("A", &NoisePerStep::A, "(nx, nx) of the sampled model.")
      .def_readonly("Q", &NoisePerStep::Q, "(nx, nx) covariance of the process noise per step.")
      .def_readonly("R", &NoisePerStep::R, "(ny, ny) covariance of a measurement.");
}

void add_lqr(py::module_& module) {
  py::class_<MatrixLqrReport> type(module, "Lqr",
                                   "The LQR gain of matrices, with its evidence: u = -K x +\n"
                                   "K_int integral(r - y) - K_past (u[k-1], u[k-2], ...).");
  const auto riccati = [](const MatrixLqrReport& self) -> const RiccatiResult& {
    return self.lqr.riccati;
  };
  const auto matrix = [&](const char* name, auto member, const char* doc) {
    type.def_property_readonly(name, member, py::return_value_policy::reference_internal, doc);
  };
  type.def_property_readonly(
          "riccati", riccati, py::return_value_policy::reference_internal,
          "The solution of the Riccati equation of all states: those of the plant, then the\n"
          "integrals, then past inputs.")
      .def_property_readonly(
          "status", [=](const MatrixLqrReport& self) { return to_string(riccati(self).status); },
          "\"solved\", \"not stabilizable\", \"not detectable\", ...")
      .def_property_readonly(
          "solved", [=](const MatrixLqrReport& self) { return riccati(self).solved(); },
          "Whether status is \"solved\".");
  matrix(
      "K",
      [=](const MatrixLqrReport& self) -> const Matrix& {
        return riccati(self).solved() ? self.K : riccati(self).K;
      },
      "(nu, nx); NaN unless solved.");
  matrix(
      "K_int", [](const MatrixLqrReport& self) -> const Matrix& { return self.K_int; },
      "(nu, ny) gain of the integrals of r - y; empty without integrals.");
  matrix(
      "K_past", [](const MatrixLqrReport& self) -> const Matrix& { return self.K_past; },
      "(nu, nu delay) gain of u[k-1], u[k-2], ...; empty without delay.");
  matrix(
      "S", [=](const MatrixLqrReport& self) -> const Matrix& { return riccati(self).X; },
      "Cost matrix of all states: x'Sx is the cost from x; NaN unless solved.");
  matrix(
      "poles",
      [=](const MatrixLqrReport& self) -> const Eigen::VectorXcd& { return riccati(self).poles; },
      "Of the closed loop of all states.");
  matrix(
      "margins",
      [](const MatrixLqrReport& self) -> const MarginsReport& { return self.lqr.margins; },
      "At the inputs u1, u2, ...");
  type.def_property_readonly(
          "dt", [](const MatrixLqrReport& self) { return self.lqr.dt; },
          "Sample period [s]; 0 of a continuous loop.")
      .def_readonly("sampled", &MatrixLqrReport::sampled,
                    "SampledCost of a problem with sampled, otherwise None.")
      .def_property_readonly(
          "messages", [](const MatrixLqrReport& self) { return self.lqr.messages; },
          "\"warning: ...\" and \"note: ...\".");
  add_report(
      type, "quadtune lqr",
      [](const MatrixLqrReport& self) {
        solved(self.lqr.riccati, "lqr");
        return report::to_json(self);
      },
      [](const MatrixLqrReport& self) {
        solved(self.lqr.riccati, "lqr");
        return report::to_text(self, false);
      });
  module.def(
      "lqr", &lqr_of_matrices, "A"_a, "B"_a, "Q"_a, "R"_a, "N"_a = py::none(), py::kw_only(),
      "C"_a = py::none(), "D"_a = py::none(), "delay"_a = 0, "discrete"_a = false,
      "sampled"_a = py::none(), "dt"_a = py::none(), "evidence"_a = py::none(),
      "The LQR gain of matrices.\n\n"
      "A (nx, nx), B (nx, nu), Q (nx, nx) symmetric and >= 0, R (nu, nu) symmetric and > 0, N\n"
      "(nx, nu) or None for zero. Continuous by default; discrete=True for a sampled plant\n"
      "with weights per step, dt > 0 [s] (1 by default) its period; sampled > 0 [s] for the\n"
      "continuous problem with the input held for so long. C (ny, nx) and D (ny, nu): outputs\n"
      "whose integrals are fed back; Q and N then have ny more rows, those of the integrals.\n"
      "delay: 0 to 2000 samples by which the input acts late, unless continuous. evidence:\n"
      "\"none\", \"essential\" (each loop) or \"full\" (and all loops at once); None for as\n"
      "much as takes about a second. A problem without solution is a result whose status is\n"
      "not \"solved\" and whose riccati.culprit names the mode. Raises InvalidInput for wrong\n"
      "shapes, entries that are not finite and weights out of range.");
}

void add_kalman(py::module_& module) {
  py::class_<SteadyFilter> type(module, "Kalman",
                                "A steady-state Kalman filter with its evidence.");
  const auto matrix = [&](const char* name, Matrix KalmanResult::*member, const char* doc) {
    type.def_property_readonly(
        name,
        [member](const SteadyFilter& filter) -> const Matrix& { return filter.result.*member; },
        py::return_value_policy::reference_internal, doc);
  };
  matrix("M", &KalmanResult::M, "Filter gain (nx, ny); empty of a continuous filter.");
  matrix("L", &KalmanResult::L, "Predictor gain (nx, ny), or the gain of a continuous filter.");
  matrix("P", &KalmanResult::P, "Error covariance before the measurement (nx, nx).");
  matrix("Z", &KalmanResult::Z, "Error covariance after it; empty of a continuous filter.");
  type.def_property_readonly(
          "status", [](const SteadyFilter& filter) { return to_string(filter.result.status); },
          "\"solved\", \"not detectable\", ...")
      .def_property_readonly(
          "solved", [](const SteadyFilter& filter) { return filter.result.solved(); },
          "Whether status is \"solved\".")
      .def_property_readonly(
          "poles",
          [](const SteadyFilter& filter) -> const Eigen::VectorXcd& { return filter.result.poles; },
          py::return_value_policy::reference_internal, "Eigenvalues of A - L C.")
      .def_property_readonly(
          "residual", [](const SteadyFilter& filter) { return filter.result.residual; },
          "Relative residual of the Riccati equation.")
      .def_property_readonly(
          "rcond", [](const SteadyFilter& filter) { return filter.result.rcond; },
          "Reciprocal condition number of the equation.")
      .def_property_readonly(
          "culprit", [](const SteadyFilter& filter) { return filter.result.culprit; },
          "The mode that prevents a solution; empty when solved.")
      .def_property_readonly(
          "warning", [](const SteadyFilter& filter) { return filter.result.warning; },
          "What is doubtful; empty for nothing.")
      .def_readonly("dt", &SteadyFilter::dt,
                    "Sample period [s]; 1 of a discrete model, 0 of a continuous filter.")
      .def_readonly("sampled", &SteadyFilter::sampled,
                    "SampledNoise of a model with sampled, otherwise None.");
  add_report(
      type, "quadtune kalman",
      [](const SteadyFilter& filter) {
        internal::Json json = report::to_json(solved(filter.result, "kalman"), filter.dt);
        if (filter.sampled)
          json["sampled"] = {{"A", internal::matrix_to_json(filter.sampled->A, "A")},
                             {"Q", internal::matrix_to_json(filter.sampled->Q, "Q")},
                             {"R", internal::matrix_to_json(filter.sampled->R, "R")}};
        return json;
      },
      [](const SteadyFilter& filter) {
        return report::to_text(solved(filter.result, "kalman"), filter.dt);
      });
  module.def(
      "kalman", &filter_of_matrices, "A"_a, "C"_a, "Q"_a, "R"_a, py::kw_only(), "G"_a = py::none(),
      "N"_a = py::none(), "discrete"_a = false, "sampled"_a = py::none(),
      "The steady-state Kalman filter of matrices.\n\n"
      "A (nx, nx), C (ny, nx), Q (nw, nw) symmetric and >= 0, R (ny, ny) symmetric and > 0, G\n"
      "(nx, nw) or None for the identity, N (nw, ny) or None for zero: x' = A x + G w, y = C x\n"
      "+ v. Continuous by default, Q and R are spectral densities; discrete=True: they are\n"
      "covariances per step; sampled > 0 [s]: the continuous model is measured every so many\n"
      "seconds. A problem without solution is a result whose status is not \"solved\" and\n"
      "whose culprit names the mode. Raises InvalidInput for wrong shapes, entries that are\n"
      "not finite and covariances out of range.");
}

}  // namespace

void add_matrices(py::module_& module) {
  add_sampled(module);
  add_lqr(module);
  add_kalman(module);
}

}  // namespace quadtune::python
