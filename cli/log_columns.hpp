// SPDX-License-Identifier: Apache-2.0
/// Columns of a numeric text log, chosen by name or number: what the verbs about sensors read.
#pragma once

#include <Eigen/Core>
#include <iosfwd>
#include <string>
#include <vector>

namespace quadtune::cli {

/// A column that was asked for.
struct LogColumnValues {
  std::string name;  ///< of the header; "column 7" without one
  std::string unit;  ///< of the header, e.g. "rad/s"; empty where it says none
  Eigen::VectorXd values;
};

/// A text log: one row a line, fields separated by commas, semicolons, tabs or blanks. A first line
/// without numbers, or a comment just before the rows with as many fields as they have, names the
/// columns, the unit in brackets: "wx[rad/s]", "timestamp [ns]".
class LogColumns {
 public:
  /// @param path  "-" is `in`
  /// @throws FileError, InvalidInput  if the file cannot be read, or has no rows.
  LogColumns(const std::string& path, std::istream& in);

  [[nodiscard]] const std::string& file() const { return file_; }
  /// Of the header; empty without one.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] bool has(const std::string& name) const;

  /// @param column  a name of the header or a number from 1
  /// @param option  that named it, for the message
  /// @throws InvalidInput  "--column: no column 'wx' in FILE (…); did you mean …", or "FILE:LINE:
  /// …"
  ///                       for a row that is too short, a word, or a number that is not finite.
  [[nodiscard]] LogColumnValues column(const std::string& column, const std::string& option) const;

  /// "FILE:LINE" of a row, from 0.
  [[nodiscard]] std::string place(Eigen::Index row) const;

 private:
  struct Row {
    std::size_t start, length;  ///< in the text
    int line;
  };

  void read_header(const std::string& comment);
  [[nodiscard]] std::size_t index_of(const std::string& column, const std::string& option) const;

  std::string file_, text_;
  std::vector<Row> rows_;
  std::vector<std::string> names_, units_;
};

/// The time of each row [s] from a column of times or a rate.
struct LogTime {
  std::string column;  ///< of times; empty for a rate
  std::string unit;    ///< of the column: s, ms, us or ns; empty: of the header, else s
  double rate = 0;     ///< [Hz]; 0 for a column
};

/// @throws UsageError    for neither or both, or an unknown unit
/// @throws InvalidInput  naming the line at which time does not increase
[[nodiscard]] Eigen::VectorXd read_time(const LogColumns& log, const LogTime& time,
                                        Eigen::Index rows, const std::string& verb);

/// The sample period of evenly spaced times [s].
/// @throws InvalidInput  naming the line of a gap: a step half as long again as the median or more
[[nodiscard]] double even_period(const LogColumns& log, const Eigen::VectorXd& t);

}  // namespace quadtune::cli
