// SPDX-License-Identifier: Apache-2.0
#include "results.hpp"

#include "quadtune/errors.hpp"
#include "quadtune/exports/file_set.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;

template <class Value>
py::array_t<Value> view_of(const std::vector<Value>& values, py::handle owner) {
  py::array_t<Value> array({values.size()}, {sizeof(Value)}, values.data(), owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

}  // namespace

std::string json_of(const internal::Json& json) { return internal::readable(json); }

void save(const std::string& file, const std::string& text) {
  std::filesystem::path path = std::filesystem::absolute(file);
  std::error_code ignored;  // what cannot be inspected, write_files() names with its reason
  if (std::filesystem::is_directory(path, ignored))
    throw FileError(file, "is a directory, expected the name of a file to write");
  // What a link points to is replaced, not the link.
  if (std::filesystem::exists(path, ignored)) path = std::filesystem::canonical(path, ignored);
  write_files(path.parent_path(), {{path.filename().string(), text}});
}

py::object dict_of(const std::string& json) {
  return py::module_::import("json").attr("loads")(json);
}

py::array_t<double> view(const std::vector<double>& values, py::handle owner) {
  return view_of(values, owner);
}

py::array_t<std::complex<double>> view(const std::vector<std::complex<double>>& values,
                                       py::handle owner) {
  return view_of(values, owner);
}

std::vector<std::string> names_of(const std::vector<Signal>& signals) {
  std::vector<std::string> names;
  names.reserve(signals.size());
  for (const Signal& signal : signals) names.push_back(signal.name);
  return names;
}

std::vector<std::string> units_of(const std::vector<Signal>& signals) {
  std::vector<std::string> units;
  units.reserve(signals.size());
  for (const Signal& signal : signals) units.push_back(signal.unit);
  return units;
}

}  // namespace quadtune::python
