// SPDX-License-Identifier: Apache-2.0
#include "flight_code/source_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "quadtune/internal/built_in.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::internal {
/// The files of exports/flight_code/source, embedded by lib/embed_files.cmake.
[[nodiscard]] const std::vector<BuiltInFile>& built_in_flight_code_files();
}  // namespace quadtune::internal

namespace quadtune::exports {
namespace {

constexpr char kFeature[] = "QT_WITH_";

std::string upper_case(std::string name) {
  for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return name;
}

/// A preprocessor condition that is open while lines are read.
struct Open {
  bool resolved = false;  ///< condition on a feature: its directives are not written
  bool taken = true;      ///< whether the lines within are written
};

std::string without_doubled_blank_lines(const std::string& text) {
  return std::regex_replace(text, std::regex("\n{3,}"), "\n\n");
}

/// Converts a source to double precision; the default is `float`, with numbers that end in f.
std::string in_double(const std::string& text) {
  static const std::regex number(R"(\b(\d+\.\d*(?:[eE][+-]?\d+)?|\d+[eE][+-]?\d+)f\b)");
  std::string result = std::regex_replace(text, number, "$1");
  result = replaced(result, "sqrtf(", "sqrt(");
  return replaced(result, "typedef float ", "typedef double ");
}

}  // namespace

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

std::string in_comment(const std::string& name) {
  std::string text = internal::printable(name);
  for (const char* mark : {"*/", "/*"})
    for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos;)
      text.insert(at + 1, " ");
  return text;
}

std::string with_features(const std::string& text, const std::set<std::string>& features) {
  std::istringstream lines(text);
  std::string result;
  std::vector<Open> open;
  const auto taken = [&] {
    return std::all_of(open.begin(), open.end(), [](const Open& o) { return o.taken; });
  };
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("#if")) {
      const bool negated = line.starts_with(std::string("#if !") + kFeature);
      const std::string start = std::string(negated ? "#if !" : "#if ") + kFeature;
      const bool resolved = line.starts_with(start);
      const bool has = resolved && features.contains(line.substr(start.size()));
      open.push_back({resolved, !resolved || has != negated});
      if (resolved) continue;
    } else if (line == "#else" && open.back().resolved) {
      open.back().taken = !open.back().taken;
      continue;
    } else if (line.starts_with("#endif")) {
      const bool resolved = open.back().resolved;
      open.pop_back();
      if (resolved) continue;
    }
    if (taken()) result += line + "\n";
  }
  return without_doubled_blank_lines(result);
}

std::string program_source(const std::string& text, const SourceChoices& choices) {
  std::string result = with_features(text, choices.features);
  for (const auto& [size, value] : choices.sizes)
    result = std::regex_replace(result, std::regex(fmt::format("(#define QT_{} )\\d+", size)),
                                fmt::format("$01{}", value));
  result = replaced(result, "#define QT_DT 0.005f", "#define QT_DT @PERIOD@");
  if (choices.double_precision) result = in_double(result);
  // The program's own names are replaced last, because they may look like those of the sources.
  result = std::regex_replace(result,
                              std::regex("\"(state|internal|maths|arithmetic|table|kalman)\\.h\""),
                              "\"@NAME@_$1.h\"");
  result = replaced(result, "\"program.h\"", "\"@NAME@.h\"");
  result = std::regex_replace(result, std::regex("\\bqt(_|`)"), "@NAME@$1");
  result = std::regex_replace(result, std::regex("\\bQT_"), "@UPPER_NAME@_");
  for (const auto& [word, with] : choices.words)
    result = replaced(result, fmt::format("@{}@", word), with);
  result = replaced(result, "@PERIOD@", choices.period);
  result = replaced(result, "@UPPER_NAME@", upper_case(choices.name));
  return replaced(result, "@NAME@", choices.name);
}

std::string with_own_names(std::string text, const std::string& name) {
  text = replaced(std::move(text), "qt_", name + "_");
  text = replaced(std::move(text), "QT_", upper_case(name) + "_");
  return replaced(std::move(text), "\"table.h\"", "\"" + name + "_table.h\"");
}

const std::string& source_text(const std::string& name) {
  for (const internal::BuiltInFile& file : internal::built_in_flight_code_files())
    if (file.name == name) return file.text;
  throw std::logic_error("no source " + name);
}

}  // namespace quadtune::exports
