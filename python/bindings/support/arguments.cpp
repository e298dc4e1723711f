// SPDX-License-Identifier: Apache-2.0
#include "arguments.hpp"

#include <fmt/format.h>
#include <pybind11/complex.h>

#include <cmath>
#include <filesystem>

#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/words.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;

/// A number in Python's shortest decimal form, which reads back to the same double.
std::string digits(py::handle number) {
  return py::repr(py::float_(py::reinterpret_borrow<py::object>(number))).cast<std::string>();
}

bool is_number(py::handle from) {
  return PyNumber_Check(from.ptr()) != 0 && !PySequence_Check(from.ptr());
}

}  // namespace

std::string Names::joined() const { return internal::joined(list, ","); }

bool read(py::handle from, Path& to) {
  const py::object path =
      py::reinterpret_steal<py::object>(PyOS_FSPath(from.ptr()));  // str, bytes or os.PathLike
  if (!path) {
    PyErr_Clear();
    return false;
  }
  if (!py::isinstance<py::str>(path)) return false;
  to.text = path.cast<std::string>();
  return true;
}

bool read(py::handle from, VehicleWord& to) {
  if (py::isinstance<Vehicle>(from)) {
    const auto& vehicle = from.cast<const Vehicle&>();
    std::error_code ignored;
    const bool is_file = std::filesystem::is_regular_file(vehicle.file, ignored);
    to.text = is_file ? vehicle.file.string() : vehicle.name;
    return true;
  }
  Path path;
  if (!read(from, path)) return false;
  to.text = path.text;
  return true;
}

bool read(py::handle from, Numbers& to) {
  if (py::isinstance<py::str>(from)) return false;
  if (is_number(from)) {
    to.values = Eigen::VectorXd::Constant(1, from.cast<double>());
    return true;
  }
  py::detail::make_caster<Eigen::VectorXd> caster;
  if (!caster.load(from, true)) return false;
  to.values = py::detail::cast_op<Eigen::VectorXd&>(caster);
  return true;
}

bool read(py::handle from, ComplexNumbers& to) {
  if (py::isinstance<py::str>(from)) return false;
  py::detail::make_caster<std::complex<double>> number;
  if (PySequence_Check(from.ptr()) == 0 && number.load(from, true)) {
    to.values = Eigen::VectorXcd::Constant(1, py::detail::cast_op<std::complex<double>>(number));
    return true;
  }
  py::detail::make_caster<Eigen::VectorXcd> caster;
  if (!caster.load(from, true)) return false;
  to.values = py::detail::cast_op<Eigen::VectorXcd&>(caster);
  return true;
}

bool read(py::handle from, Grid& to) {
  if (py::isinstance<py::str>(from)) {
    to.text = from.cast<std::string>();
    return true;
  }
  if (!py::isinstance<py::dict>(from)) return false;
  to.axes.clear();
  for (const auto& [quantity, given] : from.cast<py::dict>()) {
    Numbers numbers;
    if (!py::isinstance<py::str>(quantity) || !read(given, numbers)) return false;
    to.axes.emplace_back(quantity.cast<std::string>(), numbers.values);
  }
  return true;
}

bool read(py::handle from, Names& to) {
  if (py::isinstance<py::str>(from)) {
    to.list = internal::comma_separated(from.cast<std::string>());
    return true;
  }
  if (!PySequence_Check(from.ptr())) return false;
  to.list.clear();
  for (const py::handle name : py::reinterpret_borrow<py::sequence>(from)) {
    if (!py::isinstance<py::str>(name)) return false;
    to.list.push_back(name.cast<std::string>());
  }
  return true;
}

bool read(py::handle from, ByLoop& to) {
  if (py::isinstance<py::str>(from)) {
    to.text = from.cast<std::string>();
    return true;
  }
  if (is_number(from)) {
    to.text = digits(from);
    return true;
  }
  if (!py::isinstance<py::dict>(from)) return false;
  std::vector<std::string> loops;
  for (const auto& [loop, number] : from.cast<py::dict>())
    loops.push_back(py::str(loop).cast<std::string>() + "=" + digits(number));
  to.text = internal::joined(loops, ",");
  return true;
}

void require_positive(double value, const char* name, const char* unit) {
  if (!(value > 0) || !std::isfinite(value))
    throw OptionError(name,
                      fmt::format("{} is {}, expected a positive number of {}", name, value, unit));
}

void require_not_negative(double value, const char* name) {
  if (!(value >= 0))
    throw OptionError(name, fmt::format("{} is {}, expected 0 or more", name, value));
}

Eigen::VectorXd weights(const Numbers& numbers, std::size_t count, const char* name,
                        const std::string& of) {
  const Eigen::VectorXd& given = numbers.values;
  const auto size = static_cast<Eigen::Index>(count);
  if (given.size() != 1 && given.size() != size)
    throw OptionError(name, fmt::format("{} has {} entries, expected {} or one for all ({})", name,
                                        given.size(), count, of));
  for (const double weight : given)
    if (!(weight >= 0) || !std::isfinite(weight))
      throw OptionError(
          name,
          fmt::format("{} has a weight of {}, expected finite weights of 0 or more", name, weight));
  return given.size() == 1 ? Eigen::VectorXd::Constant(size, given(0)) : given;
}

}  // namespace quadtune::python
