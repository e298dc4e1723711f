// SPDX-License-Identifier: Apache-2.0
/// What all results have: the JSON and the text of the command that makes the same.
#pragma once

#include <pybind11/complex.h>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <string>
#include <utility>
#include <vector>

#include "quadtune/lti.hpp"

namespace quadtune::internal {
class Json;
}

namespace quadtune::python {

/// The text that `quadtune VERB --json` prints, without its last line feed.
[[nodiscard]] std::string json_of(const internal::Json& json);

/// The same as Python objects.
[[nodiscard]] pybind11::object dict_of(const std::string& json);

/// Writes a text as the program writes with -o: whole or not at all.
void save(const std::string& file, const std::string& text);

/// The values as an array that cannot be written to, in the memory of `owner`.
[[nodiscard]] pybind11::array_t<double> view(const std::vector<double>& values,
                                             pybind11::handle owner);
[[nodiscard]] pybind11::array_t<std::complex<double>> view(
    const std::vector<std::complex<double>>& values, pybind11::handle owner);

[[nodiscard]] std::vector<std::string> names_of(const std::vector<Signal>& signals);
[[nodiscard]] std::vector<std::string> units_of(const std::vector<Signal>& signals);

/// Adds to_json(), to_dict(), save() and str().
/// @param json  result -> internal::Json
/// @param text  result -> std::string
template <class Result, class... Extra, class Json, class Text>
void add_report(pybind11::class_<Result, Extra...>& type, const std::string& verb, Json json,
                Text text) {
  const std::string to_json_doc = "The text that `" + verb + " --json` prints.";
  const std::string to_dict_doc =
      "The object that `" + verb + " --json` prints, as Python objects.";
  const std::string save_doc = "Write the object that `" + verb + " --json -o FILE` writes.";
  type.def(
      "to_json", [json](const Result& result) { return json_of(json(result)); },
      to_json_doc.c_str());
  type.def(
      "to_dict",
      [json](const Result& result) { return pybind11::dict(dict_of(json_of(json(result)))); },
      to_dict_doc.c_str());
  type.def(
      "save",
      [json](const Result& result, const std::filesystem::path& file) {
        save(file.string(), json_of(json(result)) + "\n");
      },
      pybind11::arg("file"), save_doc.c_str());
  type.def(
      "__str__", [text](const Result& result) { return text(result); },
      "The text that the command prints.");
}

}  // namespace quadtune::python
