// SPDX-License-Identifier: Apache-2.0
/// Options whose value is a matrix file or a list of numbers.
#pragma once

#include <Eigen/Core>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace quadtune::cli {

struct Context;

/// Reads the matrix file of an option; `-` reads `in`. Returns an empty matrix if the option was
/// not given.
[[nodiscard]] Eigen::MatrixXd read_matrix(const std::string& path, std::istream& in,
                                          const std::string& option);

/// As read_matrix(), for a required option.
/// @throws UsageError  "quadtune lqr: --B is missing, expected a matrix file".
[[nodiscard]] Eigen::MatrixXd require_matrix(const std::string& path, std::istream& in,
                                             const std::string& option);

/// Parses "1,1,1e3" as numbers.
/// @throws UsageError  naming the option and the word that is not a finite number.
[[nodiscard]] std::vector<double> number_list(const std::string& text, const std::string& option);

/// Parses "1,6,11,6" as the coefficients of a polynomial in descending powers.
/// @throws UsageError  as number_list(), or "quadtune pid: --num is missing, expected …".
[[nodiscard]] Eigen::VectorXd coefficients(const std::string& text, const std::string& option);

/// A diagonal matrix of `count` weights from a list; a single number applies to all.
/// @param what  what the entries belong to, e.g. "states: x y z".
/// @throws UsageError  naming the option, its number of entries and the expected number, or the
///                     negative weight.
[[nodiscard]] Eigen::MatrixXd diagonal_weights(const std::string& text, std::size_t count,
                                               const std::string& what, const std::string& option);

/// Splits "x,y,z" into words; an empty text gives no words.
[[nodiscard]] std::vector<std::string> word_list(const std::string& text);

/// Whether the matrices of a plant are continuous or discrete, as the user states; at most one of
/// the options may be given.
struct TimeArguments {
  bool continuous = false, discrete = false;
  std::optional<double> sampled = {};  ///< continuous, with the input held for this time [s]

  /// Number of options that were given.
  [[nodiscard]] int count() const {
    return int{continuous} + int{discrete} + int{sampled.has_value()};
  }
};

/// Notes that the times in the output of a discrete problem are for a period of 1 s, if no other was
/// given.
void note_period(const TimeArguments& time, const std::optional<double>& dt,
                 const Context& context);

/// @throws UsageError  unless the time was given: the matrices do not show whether a system is discrete
void require_time(const TimeArguments& time);

/// @throws UsageError  if more than one was given
void require_one_time(const TimeArguments& time);

/// @throws UsageError  unless value [s] ≥ 0
void require_not_negative(double value, const std::string& option);

/// @throws UsageError  unless 0 < value < ∞.
void require_positive(double value, const std::string& option, const std::string& unit = "seconds");

}  // namespace quadtune::cli
