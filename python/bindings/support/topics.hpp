// SPDX-License-Identifier: Apache-2.0
/// What each topic adds to the module. The order of module.cpp makes signatures know their types.
#pragma once

#include <pybind11/pybind11.h>

namespace quadtune::python {

void add_evidence(pybind11::module_& module);     ///< Riccati results, margins, gains
void add_models(pybind11::module_& module);       ///< vehicles, linearize
void add_controllers(pybind11::module_& module);  ///< controllers in a loop
void add_matrices(pybind11::module_& module);     ///< lqr of matrices, kalman
void add_regulators(pybind11::module_& module);   ///< lqg of matrices
void add_systems(pybind11::module_& module);      ///< place, analyze
void add_sampling(pybind11::module_& module);     ///< discretize
void add_loops(pybind11::module_& module);        ///< margins, step, Bode and Nyquist curves
void add_measured(pybind11::module_& module);     ///< margins of frequency responses
void add_pid(pybind11::module_& module);          ///< pid
void add_feedback(pybind11::module_& module);     ///< lqr of a vehicle, lqg
void add_schedules(pybind11::module_& module);    ///< schedule, load_schedule
void add_flights(pybind11::module_& module);      ///< fly
void add_designs(pybind11::module_& module);      ///< design, export, verify
void add_campaigns(pybind11::module_& module);    ///< campaign
void add_certify(pybind11::module_& module);      ///< certify
void add_tuning(pybind11::module_& module);       ///< tune_kalman
void add_missions(pybind11::module_& module);     ///< tune_pid, tune_lqr
void add_gain_match(pybind11::module_& module);   ///< tune_lqr of a given gain

}  // namespace quadtune::python
