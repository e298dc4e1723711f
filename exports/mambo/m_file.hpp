// SPDX-License-Identifier: Apache-2.0
/// Writes assignments that MATLAB and Octave run.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "quadtune/lti.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune::exports {

/// Whether a word is a valid variable name: a letter, then letters, digits and underscores.
[[nodiscard]] inline bool is_m_name(std::string_view word) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return !word.empty() && letter(word[0]) && std::all_of(word.begin(), word.end(), [&](char c) {
    return letter(c) || (c >= '0' && c <= '9') || c == '_';
  });
}

/// Builds a parameter file. Numbers read back to the same double; numbers that are not finite are
/// rejected.
class MFile {
 public:
  /// Writes "% text".
  void comment(const std::string& text) {
    text_ += text.empty() ? "\n" : "% " + one_line(text) + "\n";
  }

  /// Writes "name = 0.063;  % kg".
  void number(const std::string& name, double value, const std::string& unit = "") {
    require_finite(Eigen::Matrix<double, 1, 1>(value), "mambo", name);
    expression(name, fmt::format("{}", value), unit);
  }

  /// Writes rows on separate lines, with entries separated by commas.
  void matrix(const std::string& name, const Eigen::MatrixXd& M, const std::string& about = "") {
    require_finite(M, "mambo", name);
    if (M.size() == 0) return expression(name, fmt::format("zeros({}, {})", M.rows(), M.cols()));
    std::string value = "[";
    for (Eigen::Index i = 0; i < M.rows(); ++i) {
      value += M.rows() > 1 ? "\n " : "";
      for (Eigen::Index j = 0; j < M.cols(); ++j)
        value += fmt::format("{}{}", j > 0 ? ", " : (M.rows() > 1 ? " " : ""), M(i, j));
    }
    expression(name, value + (M.rows() > 1 ? "\n]" : "]"), about);
  }

  /// Writes names as a cell array of strings.
  void words(const std::string& name, const std::vector<Signal>& signals) {
    std::string value;
    for (const Signal& signal : signals)
      value += fmt::format("{}'{}'", value.empty() ? "" : ", ", signal.name);
    expression(name, "{" + value + "}");
  }

  /// Writes "name = value;  % about", where value is any Octave expression.
  void expression(const std::string& name, const std::string& value,
                  const std::string& about = "") {
    text_ +=
        fmt::format("{} = {};{}{}\n", name, value, about.empty() ? "" : "  % ", one_line(about));
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  // A name from a vehicle file must not end the comment and become code.
  static std::string one_line(std::string text) {
    for (char& c : text)
      if (static_cast<unsigned char>(c) < ' ') c = ' ';
    return text;
  }

  std::string text_;
};

}  // namespace quadtune::exports
