// SPDX-License-Identifier: Apache-2.0
/// Options that name a matrix file, or list numbers.
#pragma once

#include <Eigen/Core>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace quadtune::cli {

/// Reads the file of an option; `-` is `in`. An option that was not given is an empty
/// matrix.
[[nodiscard]] Eigen::MatrixXd read_matrix(const std::string& path, std::istream& in);

/// Like read_matrix, for an option that must be there.
/// @throws UsageError  "quadtune lqr: --B is missing, expected a matrix file".
[[nodiscard]] Eigen::MatrixXd require_matrix(const std::string& path, std::istream& in,
                                             const std::string& verb, const std::string& option);

/// "1,1,1e3" as numbers.
/// @throws UsageError  naming the option and the word that is not a finite number.
[[nodiscard]] std::vector<double> number_list(const std::string& text, const std::string& verb,
                                              const std::string& option);

/// "1,6,11,6" as the coefficients of a polynomial, descending powers.
/// @throws UsageError  as number_list(), or "quadtune pid: --num is missing, expected …".
[[nodiscard]] Eigen::VectorXd coefficients(const std::string& text, const std::string& verb,
                                           const std::string& option);

/// A diagonal of `count` weights from a list: one number stands for all.
/// @param what  what the entries belong to, e.g. "states: x y z".
/// @throws UsageError  naming the option, how many came and how many were expected, or
///                     the weight that is negative.
[[nodiscard]] Eigen::MatrixXd diagonal_weights(const std::string& text, std::size_t count,
                                               const std::string& what, const std::string& verb,
                                               const std::string& option);

/// "x,y,z" as words; an empty text has none.
[[nodiscard]] std::vector<std::string> word_list(const std::string& text);

/// What the matrices of a plant are, as the user says: at most one of these.
struct TimeArguments {
  bool continuous = false, discrete = false;
  std::optional<double> sampled = {};  ///< continuous, with the input held for that long [s]

  /// How many came.
  [[nodiscard]] int count() const {
    return int{continuous} + int{discrete} + int{sampled.has_value()};
  }
};

/// @throws UsageError  for more than one
void require_one_time(const TimeArguments& time, const std::string& verb);

/// @throws UsageError  unless value [s] ≥ 0
void require_not_negative(double value, const std::string& verb, const std::string& option);

/// @throws UsageError  unless 0 < value < ∞.
void require_positive(double value, const std::string& verb, const std::string& option,
                      const std::string& unit = "seconds");

}  // namespace quadtune::cli
