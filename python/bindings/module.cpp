// SPDX-License-Identifier: Apache-2.0
/// The module quadtune._quadtune: what the commands of quadtune compute, as Python functions.
#include <pybind11/pybind11.h>

#include <string>

#include "quadtune/version.hpp"
#include "support/errors.hpp"
#include "support/topics.hpp"

PYBIND11_MODULE(_quadtune, module) {
  module.doc() = "Control gains for small multirotors: the commands of quadtune as functions.";
  module.attr("__version__") = std::string(quadtune::kVersion);
  quadtune::python::add_errors(module);
  quadtune::python::add_evidence(module);
  quadtune::python::add_models(module);
  quadtune::python::add_controllers(module);
  quadtune::python::add_matrices(module);
  quadtune::python::add_regulators(module);
  quadtune::python::add_systems(module);
  quadtune::python::add_sampling(module);
  quadtune::python::add_loops(module);
  quadtune::python::add_measured(module);
  quadtune::python::add_pid(module);
  quadtune::python::add_feedback(module);
  quadtune::python::add_schedules(module);
  quadtune::python::add_flights(module);
  quadtune::python::add_designs(module);
  quadtune::python::add_campaigns(module);
  quadtune::python::add_certify(module);
  quadtune::python::add_tuning(module);
  quadtune::python::add_missions(module);
  quadtune::python::add_gain_match(module);
}
