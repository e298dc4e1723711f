// SPDX-License-Identifier: Apache-2.0
/// Values of a MAT v5 file as bytes. Source: The MathWorks, "MAT-File Format", level 5.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "quadtune/internal/json_value.hpp"

namespace quadtune::internal {

/// The first 128 bytes of a file.
/// @param title  at most 34 bytes are kept. There is no date: the same content gives the same bytes
[[nodiscard]] std::string mat_header(const std::string& title);

[[nodiscard]] std::string mat_matrix(const Eigen::Ref<const Eigen::MatrixXd>& M);
/// @param utf8  what is not UTF-8 is refused by whoever read it
[[nodiscard]] std::string mat_text(const std::string& utf8);
/// A column of texts.
[[nodiscard]] std::string mat_cells(const std::vector<std::string>& texts);
/// A struct, or a column of them.
/// @param values  all fields of the first one, then those of the second one, …
/// @param name    of a variable; empty within another value
[[nodiscard]] std::string mat_structs(const std::vector<std::string>& fields,
                                      const std::string& values, std::size_t rows = 1,
                                      const std::string& name = "");

/// A JSON value: objects as structs, numbers as scalars, truths as 0 or 1, texts as texts, null as
/// []. A list of numbers is a column, a list of such lists of one length a matrix by rows, a list
/// of objects with the same members a column of structs, any other list a cell.
/// @param name  of a variable, which must be an object
[[nodiscard]] std::string mat_of_json(const Json& json, const std::string& name = "");

}  // namespace quadtune::internal
