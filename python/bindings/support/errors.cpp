// SPDX-License-Identifier: Apache-2.0
#include "errors.hpp"

#include <algorithm>
#include <exception>
#include <string>

#include "quadtune/errors.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;

// Python objects that live until the process ends, because exceptions may be thrown until then.
PyObject* invalid_input = nullptr;
PyObject* no_solution = nullptr;
PyObject* file_error = nullptr;

PyObject* new_exception(py::module_& module, const char* name, PyObject* base, const char* doc) {
  py::dict members;
  members["where"] = "";
  const std::string full = std::string("quadtune.") + name;
  PyObject* type = PyErr_NewExceptionWithDoc(full.c_str(), doc, base, members.ptr());
  if (type == nullptr) throw py::error_already_set();
  module.attr(name) = py::reinterpret_borrow<py::object>(type);
  return type;
}

void raise(PyObject* type, const std::string& message, const std::string& where) {
  const py::object error = py::reinterpret_borrow<py::object>(type)(message);
  error.attr("where") = where;
  PyErr_SetObject(type, error.ptr());
}

/// An option of the command line as the keyword argument of the same name: "input_delay".
std::string keyword(std::string option) {
  if (option == "for") return "for_firmware";  // "for" is a word of the language
  std::replace(option.begin(), option.end(), '-', '_');
  return option;
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const OptionError& error) {
    raise(invalid_input, error.what(), keyword(error.option()));
  } catch (const InvalidInput& error) {
    raise(invalid_input, error.what(), error.where());
  } catch (const NoSolution& error) {
    raise(no_solution, error.what(), error.where());
  } catch (const FileError& error) {
    raise(file_error, error.what(), error.path());
  } catch (const Interrupted&) {
    PyErr_SetNone(PyExc_KeyboardInterrupt);
  }
}

}  // namespace

void add_errors(py::module_& module) {
  invalid_input = new_exception(module, "InvalidInput", PyExc_ValueError,
                                "An argument or a file is wrong. `where` is the argument, or "
                                "\"file:line\"; the message also states what was expected.");
  no_solution =
      new_exception(module, "NoSolution", PyExc_ArithmeticError,
                    "A problem of several steps has no solution, for example a vehicle "
                    "that cannot hover. The message names the cause, `where` the argument, "
                    "file or vehicle.");
  file_error = new_exception(module, "FileError", PyExc_OSError,
                             "A file could not be read or written. `where` is its path.");
  py::register_exception_translator(translate);
}

}  // namespace quadtune::python
