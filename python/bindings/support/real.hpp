// SPDX-License-Identifier: Apache-2.0
/// A number as an argument of overloads whose arguments are all named. pybind11 (2.10) tries
/// conversions of positional arguments alone, so that a double there does not accept an int.
#pragma once

#include <pybind11/pybind11.h>

namespace quadtune::python {

struct Real {
  double value = 0;

  Real() = default;
  Real(double number) : value(number) {}
  operator double() const { return value; }
};

}  // namespace quadtune::python

namespace pybind11::detail {

template <>
struct type_caster<quadtune::python::Real> {
  PYBIND11_TYPE_CASTER(quadtune::python::Real, const_name("float"));
  bool load(handle from, bool) {
    if (PyNumber_Check(from.ptr()) == 0 || PySequence_Check(from.ptr()) != 0) return false;
    value = PyFloat_AsDouble(from.ptr());
    if (PyErr_Occurred() == nullptr) return true;
    PyErr_Clear();
    return false;
  }
};

}  // namespace pybind11::detail
