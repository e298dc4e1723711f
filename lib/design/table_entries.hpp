// SPDX-License-Identifier: Apache-2.0
/// Entries that several tables of a design file share: lists of names, weights and matrices.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/internal/toml_reader.hpp"

namespace quadtune::internal {

/// Names with a blank between them, for messages.
[[nodiscard]] std::string spaced(const std::vector<std::string>& words);

/// The name of a key in messages, such as "lqr.Q".
[[nodiscard]] std::string dotted(const TomlTable& table, const std::string& key);

/// Reads weights, one number for each of `size` names.
/// @param names  the names in messages: "inputs: w1 w2 w3 w4"
/// @throws InvalidInput  if the entry is a matrix, or has another number of entries
[[nodiscard]] Eigen::VectorXd read_weights_of_each(const TomlTable& table, const std::string& key,
                                                   Eigen::Index size, const std::string& names,
                                                   const Range& range);

/// Reads a symmetric matrix, size x size: a list gives its diagonal, a list of lists the whole
/// matrix.
/// @param names  as above
/// @param range  of the numbers of a list
/// @throws InvalidInput  if the shape is another one or the matrix is not symmetric
[[nodiscard]] Eigen::MatrixXd read_weight(const TomlTable& table, const std::string& key,
                                          Eigen::Index size, const std::string& names,
                                          const Range& range);

/// Reads a matrix.
/// @param why  what its rows and columns are, in messages
/// @throws InvalidInput  unless it is rows x cols
[[nodiscard]] Eigen::MatrixXd read_shaped(const TomlTable& table, const std::string& key,
                                          Eigen::Index rows, Eigen::Index cols,
                                          const std::string& why);

/// Reads a list of names.
/// @throws InvalidInput  if a name is not in `known` or is listed twice
[[nodiscard]] std::vector<std::string> read_names(const TomlTable& table, const std::string& key,
                                                  const std::vector<std::string>& known);

}  // namespace quadtune::internal
