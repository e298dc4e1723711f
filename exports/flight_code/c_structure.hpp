// SPDX-License-Identifier: Apache-2.0
/// Formats numbers as C initializers.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "flight_code/parameters.hpp"
#include "quadtune/errors.hpp"

namespace quadtune::exports {

using Numbers = std::vector<double>;

Numbers of(const auto& entries) { return Numbers(entries.begin(), entries.end()); }

/// Writes the initializer of a structure, member by member.
class Structure {
 public:
  Structure(bool double_precision, double dt) : double_(double_precision), dt_(dt) {}

  void open(const std::string& name) {
    line(name.empty() ? "{" : fmt::format(".{} = {{", name));
    path_.push_back(name);
  }
  void close() {
    path_.pop_back();
    line(path_.empty() ? "};" : "},");
  }
  void number(const std::string& name, double x) { member(name, text(x, name)); }
  /// A control period; by its name in C if it is that of the program.
  void period(const std::string& name, double dt) {
    member(name, dt == dt_ ? "QT_DT" : text(dt, name));
  }
  void integer(const std::string& name, int x) { member(name, fmt::format("{}", x)); }
  void boolean(const std::string& name, bool x) { member(name, x ? "true" : "false"); }
  void numbers(const std::string& name, const Numbers& x) {
    member(name, list(x, name, (path_.size() + 1) * 2));
  }
  void integers(const std::string& name, const std::vector<int>& x) {
    member(name, fmt::format("{{{}}}", fmt::join(x, ", ")));
  }
  /// A matrix, row by row.
  void matrix(const std::string& name, const Eigen::MatrixXd& M) {
    std::string rows;
    for (Eigen::Index i = 0; i < M.rows(); ++i) {
      const std::string indent((path_.size() + 1) * 2, ' ');
      rows += (i > 0 ? ",\n" : "\n") + indent +
              list(Numbers(M.row(i).begin(), M.row(i).end()), name, indent.size() + 1);
    }
    member(name, "{" + rows + "}");
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  [[nodiscard]] std::string text(double x, const std::string& name) const {
    std::string where;
    for (const std::string& part : path_)
      if (!part.empty()) where += part + ".";
    // A gain may vanish; a variance of 0 would make the estimator trust a sensor completely.
    if (path_.size() > 1 && path_[1] == "estimator" && !double_ && x != 0 &&
        static_cast<float>(x) == 0)
      throw InvalidInput(where + name,
                         fmt::format("is {}, expected 0 or at least 1.2e-38 in magnitude because "
                                     "the program computes in float; use double precision",
                                     x));
    return c_number(x, double_, where + name);
  }
  /// Numbers in braces, wrapped at 100 columns.
  [[nodiscard]] std::string list(const Numbers& x, const std::string& name,
                                 std::size_t indent) const {
    constexpr std::size_t kWidth = 98;
    std::string all = "{";
    std::size_t column = indent + name.size() + 6;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const std::string one = text(x[i], name) + (i + 1 < x.size() ? ", " : "");
      if (column + one.size() > kWidth) {
        while (all.ends_with(' ')) all.pop_back();
        all += "\n" + std::string(indent + 2, ' ');
        column = indent + 2;
      }
      all += one;
      column += one.size();
    }
    return all + "}";
  }
  void member(const std::string& name, const std::string& value) {
    line(fmt::format(".{} = {},", name, value));
  }
  void line(const std::string& text) { text_ += std::string(path_.size() * 2, ' ') + text + "\n"; }

  bool double_;
  double dt_;  ///< of the program [s]
  std::vector<std::string> path_;
  std::string text_;
};

}  // namespace quadtune::exports
