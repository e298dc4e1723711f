// SPDX-License-Identifier: Apache-2.0
/// LQR and Kalman filters of matrices.
#include <fmt/format.h>

#include "arguments.hpp"
#include "interrupts.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/synthesis/kalman.hpp"
#include "quadtune/workbench/design/lqr_report.hpp"
#include "report/gains/gains.hpp"
#include "results.hpp"
#include "topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using Matrix = Eigen::MatrixXd;

/// A filter with the period that its JSON and its text need.
struct SteadyFilter {
  KalmanResult result;
  double dt = 0;  ///< [s]; 1 of a discrete model, 0 of a continuous filter
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

LqrReport lqr_of_matrices(Matrix A, Matrix B, Matrix Q, Matrix R, std::optional<Matrix> N,
                          bool discrete, std::optional<double> sampled,
                          const std::optional<std::string>& evidence) {
  require_one_time(discrete, sampled);
  std::optional<MarginsEvidence> margins;
  if (evidence) margins = margins_evidence(*evidence);
  const LqrProblem problem{std::move(A),
                           std::move(B),
                           {std::move(Q), std::move(R), or_empty(std::move(N))},
                           discrete,
                           sampled};
  return long_call([&](const Stop&) { return lqr_report(problem, margins); });
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
    if (sampled) return {kalman_sampled(model, noise, *sampled), *sampled};
    return {kalman(model, noise), 0};
  });
}

void add_lqr(py::module_& module) {
  py::class_<LqrReport> type(module, "Lqr",
                             "The LQR gain of u = -K x of matrices, with its evidence.");
  const auto riccati = [](const LqrReport& report) -> const RiccatiResult& {
    return report.riccati;
  };
  type.def_readonly("riccati", &LqrReport::riccati, "The solution of the Riccati equation.")
      .def_property_readonly(
          "status", [=](const LqrReport& report) { return to_string(riccati(report).status); },
          "\"solved\", \"not stabilizable\", ...")
      .def_property_readonly(
          "solved", [=](const LqrReport& report) { return riccati(report).solved(); },
          "Whether status is \"solved\".")
      .def_property_readonly(
          "K", [=](const LqrReport& report) -> const Matrix& { return riccati(report).K; },
          py::return_value_policy::reference_internal, "(nu, nx); NaN unless solved.")
      .def_property_readonly(
          "S", [=](const LqrReport& report) -> const Matrix& { return riccati(report).X; },
          py::return_value_policy::reference_internal, "Cost matrix: x'Sx is the cost from x.")
      .def_property_readonly(
          "poles",
          [=](const LqrReport& report) -> const Eigen::VectorXcd& { return riccati(report).poles; },
          py::return_value_policy::reference_internal, "Of the closed loop.")
      .def_readonly("margins", &LqrReport::margins, "At the inputs u1, u2, ...")
      .def_readonly("dt", &LqrReport::dt, "[s]; 0 of a continuous loop, 1 of a discrete problem.")
      .def_readonly("messages", &LqrReport::messages, "\"warning: ...\" and \"note: ...\".");
  add_report(
      type, "quadtune lqr",
      [](const LqrReport& report) {
        solved(report.riccati, "lqr");
        return report::to_json(report);
      },
      [](const LqrReport& report) {
        solved(report.riccati, "lqr");
        return report::to_text(report);
      });
  module.def(
      "lqr", &lqr_of_matrices, "A"_a, "B"_a, "Q"_a, "R"_a, "N"_a = py::none(), py::kw_only(),
      "discrete"_a = false, "sampled"_a = py::none(), "evidence"_a = py::none(),
      "The LQR gain of matrices, or of a vehicle.\n\n"
      "A (nx, nx), B (nx, nu), Q (nx, nx), R (nu, nu), N (nx, nu) or None. Continuous by\n"
      "default; discrete=True for a sampled plant with weights per step; sampled=DT for the\n"
      "continuous problem with the input held for DT seconds. evidence: \"none\",\n"
      "\"essential\" or \"full\" margins. A problem without solution is a result whose\n"
      "status is not \"solved\" and whose riccati.culprit names the mode.");
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
                    "[s]; 1 of a discrete model, 0 of a continuous filter.");
  add_report(
      type, "quadtune kalman",
      [](const SteadyFilter& filter) {
        return report::to_json(solved(filter.result, "kalman"), filter.dt);
      },
      [](const SteadyFilter& filter) {
        return report::to_text(solved(filter.result, "kalman"), filter.dt);
      });
  module.def(
      "kalman", &filter_of_matrices, "A"_a, "C"_a, "Q"_a, "R"_a, py::kw_only(), "G"_a = py::none(),
      "N"_a = py::none(), "discrete"_a = false, "sampled"_a = py::none(),
      "The steady-state Kalman filter of matrices.\n\n"
      "A (nx, nx), C (ny, nx), Q (nw, nw), R (ny, ny), G (nx, nw) or None for the identity,\n"
      "N (nw, ny) or None. Continuous by default, with spectral densities;\n"
      "discrete=True with covariances per step; sampled=DT for the continuous model measured\n"
      "every DT seconds. Status and culprit are in the result.");
}

}  // namespace

void add_matrices(py::module_& module) {
  add_lqr(module);
  add_kalman(module);
}

}  // namespace quadtune::python
