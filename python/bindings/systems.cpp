// SPDX-License-Identifier: Apache-2.0
/// Pole placement, and properties of linear systems.
#include <fmt/format.h>

#include <cmath>
#include <variant>

#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/synthesis/pole_placement.hpp"
#include "quadtune/transfer_function.hpp"
#include "quadtune/workbench/systems/system_report.hpp"
#include "report/loops/matrix_loops.hpp"
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
using System = std::variant<ContinuousLti, DiscreteLti>;

/// A gain with the period that its text needs.
struct PlacedPoles {
  PolePlacement placement;
  double dt = 0;  ///< [s]; 0: continuous
};

PlacedPoles place(const Matrix& A, const Matrix& B, const ComplexNumbers& poles,
                  std::optional<double> dt) {
  if (dt) require_positive(*dt, "dt", "seconds");
  return long_call([&](const Stop&) -> PlacedPoles {
    return {place_poles(A, B, poles.values), dt.value_or(0)};
  });
}

/// @throws NoSolution  as the command, which prints solutions alone
const PlacedPoles& solved(const PlacedPoles& self) {
  const PolePlacement& placement = self.placement;
  if (!placement.solved())
    throw NoSolution(fmt::format("place: {}: {}", to_string(placement.status), placement.culprit),
                     "A");
  return self;
}

void add_place(py::module_& module) {
  py::class_<PlacedPoles> type(module, "PolePlacement",
                               "The gain of u = -K x with given poles, with its evidence.");
  type.def_property_readonly(
          "status", [](const PlacedPoles& self) { return to_string(self.placement.status); },
          "\"solved\", \"not controllable\" or \"inaccurate\".")
      .def_property_readonly(
          "solved", [](const PlacedPoles& self) { return self.placement.solved(); },
          "Whether status is \"solved\".")
      .def_property_readonly(
          "K", [](const PlacedPoles& self) -> const Matrix& { return self.placement.K; },
          py::return_value_policy::reference_internal, "(nu, nx); NaN unless solved.")
      .def_property_readonly(
          "poles",
          [](const PlacedPoles& self) -> const Eigen::VectorXcd& { return self.placement.poles; },
          py::return_value_policy::reference_internal,
          "(nx) computed eigenvalues of A - B K; empty unless solved.")
      .def_property_readonly(
          "error", [](const PlacedPoles& self) { return self.placement.error; },
          "Largest distance between a requested pole and the computed one; NaN unless computed.")
      .def_property_readonly(
          "culprit", [](const PlacedPoles& self) { return self.placement.culprit; },
          "The mode that cannot be moved; empty when solved.");
  add_report(
      type, "quadtune place",
      [](const PlacedPoles& self) { return report::to_json(solved(self).placement); },
      [](const PlacedPoles& self) { return report::to_text(solved(self).placement, self.dt); });
  module.def(
      "place", &place, "A"_a, "B"_a, "poles"_a, py::kw_only(), "dt"_a = py::none(),
      "State feedback u = -K x with given closed-loop poles.\n\n"
      "A (nx, nx), B (nx, nu), poles (nx): real or complex, complex ones in conjugate pairs,\n"
      "repeated ones allowed. dt > 0: the sample period [s] if A and B are discrete, for the\n"
      "printed table alone. With several inputs, each pole is moved by the smallest gain that\n"
      "moves it. A mode that cannot be moved is a result whose status is not \"solved\" and\n"
      "whose culprit names it. Raises InvalidInput for wrong shapes, entries that are not\n"
      "finite, and a complex pole without its conjugate.");
}

// --- analyze ---

SystemReport analyze_matrices(Matrix A, Matrix B, std::optional<Matrix> C, std::optional<Matrix> D,
                              std::optional<double> dt) {
  if (dt) require_positive(*dt, "dt", "seconds");
  const Matrix none;
  const ContinuousLti plant{
      std::move(A), std::move(B), C.value_or(none), D.value_or(none), {}, {}, {}};
  validate(plant, "A, B, C, D");
  const System system =
      dt ? System(DiscreteLti{plant.A, plant.B, plant.C, plant.D, *dt, {}, {}, {}}) : System(plant);
  return long_call([&](const Stop&) { return system_report(system); });
}

SystemReport analyze_fraction(const Numbers& num, const Numbers& den, std::optional<Real> dt) {
  if (dt) require_positive(*dt, "dt", "seconds");
  return long_call([&](const Stop&) {
    if (dt) {
      const DiscreteTransferFunction g{num.values, den.values, *dt, 0};
      validate(g, "num, den");
      return system_report(realize(g));
    }
    const ContinuousTransferFunction g{num.values, den.values, 0};
    validate(g, "num, den");
    return system_report(realize(g));
  });
}

void add_analyze(py::module_& module) {
  py::class_<SystemReport> type(module, "System", "Poles, zeros and norms of a linear system.");
  type.def_readonly("dt", &SystemReport::dt, "Sample period [s]; 0 of a continuous system.")
      .def_property_readonly(
          "stable", [](const SystemReport& self) { return self.peak.stable; },
          "Whether every pole is stable.")
      .def_readonly("poles", &SystemReport::poles, "(nx) eigenvalues of A.")
      .def_property_readonly(
          "zeros",
          [](const SystemReport& self) -> const Eigen::VectorXcd& { return self.zeros.zeros; },
          py::return_value_policy::reference_internal, "Finite invariant zeros; may be none.")
      .def_property_readonly(
          "rank", [](const SystemReport& self) { return self.zeros.rank; },
          "Rank of the transfer function matrix.")
      .def_property_readonly(
          "dc_gain",
          [](const SystemReport& self) -> std::optional<Matrix> {
            if (self.dc_gain.size() == 0) return std::nullopt;
            return self.dc_gain;
          },
          "(ny, nu) response to constant inputs; None with a pole there.")
      .def_property_readonly(
          "peak_gain", [](const SystemReport& self) { return self.peak.gain; },
          "Largest singular value over all frequencies; infinite with a pole on the boundary.")
      .def_property_readonly(
          "hinf_norm",
          [](const SystemReport& self) -> std::optional<double> {
            if (!self.peak.stable) return std::nullopt;
            return self.peak.gain;
          },
          "H-infinity norm: peak_gain of a stable system, otherwise None.")
      .def_property_readonly(
          "hinf_frequency", [](const SystemReport& self) { return self.peak.w; },
          "Frequency of the peak [rad/s]; infinite where the feed-through attains it.")
      .def_readonly("h2_norm", &SystemReport::h2,
                    "H2 norm; infinite if unstable, or if continuous with D other than 0.");
  add_report(
      type, "quadtune analyze", [](const SystemReport& self) { return report::to_json(self); },
      [](const SystemReport& self) { return report::to_text(self); });
  module.def(
      "analyze", &analyze_matrices, "A"_a, "B"_a, "C"_a = py::none(), "D"_a = py::none(),
      py::kw_only(), "dt"_a = py::none(),
      "Poles, zeros, gain at rest, H-infinity and H2 norm of matrices.\n\n"
      "A (nx, nx), B (nx, nu), C (ny, nx) or None for the states, D (ny, nu) or None for zero.\n"
      "dt > 0: the sample period [s] of a discrete system. Raises InvalidInput for wrong\n"
      "shapes and entries that are not finite.");
  module.def(
      "analyze", &analyze_fraction, py::kw_only(), "num"_a, "den"_a, "dt"_a = py::none(),
      "The same of a transfer function.\n\n"
      "num, den: coefficients in descending powers of s, or of z with dt > 0 [s], with at most\n"
      "as many zeros as poles. Raises InvalidInput for other coefficients.");
}

}  // namespace

void add_systems(py::module_& module) {
  add_place(module);
  add_analyze(module);
}

}  // namespace quadtune::python
