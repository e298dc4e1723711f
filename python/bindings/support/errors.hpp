// SPDX-License-Identifier: Apache-2.0
/// The C++ exceptions of quadtune as Python exceptions.
#pragma once

#include <pybind11/pybind11.h>

namespace quadtune::python {

/// Adds InvalidInput, NoSolution and FileError to the module, each with an attribute `where`.
void add_errors(pybind11::module_& module);

}  // namespace quadtune::python
