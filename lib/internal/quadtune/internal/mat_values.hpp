// SPDX-License-Identifier: Apache-2.0
/// Encodes values as bytes of a MAT v5 file. Source: The MathWorks, "MAT-File Format", level 5.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "quadtune/internal/json_value.hpp"

namespace quadtune::internal {

/// The 128-byte header of a file.
/// @param title  truncated to 34 bytes. There is no date, so the same content gives the same bytes
[[nodiscard]] std::string mat_header(const std::string& title);

[[nodiscard]] std::string mat_matrix(const Eigen::Ref<const Eigen::MatrixXd>& M);
/// @param utf8  valid UTF-8, which the caller has checked
[[nodiscard]] std::string mat_text(const std::string& utf8);
/// A column of strings.
[[nodiscard]] std::string mat_cells(const std::vector<std::string>& texts);
/// A struct, or a column of structs.
/// @param values  all fields of the first struct, then those of the second, …
/// @param name    name of a variable; empty within another value
[[nodiscard]] std::string mat_structs(const std::vector<std::string>& fields,
                                      const std::string& values, std::size_t rows = 1,
                                      const std::string& name = "");

/// Encodes a JSON value: objects as structs, numbers as scalars, booleans as 0 or 1, strings as
/// strings, null as []. A list of numbers becomes a column, a list of such lists of equal length a
/// matrix by rows, a list of objects with the same members a column of structs, any other list a
/// cell.
/// @param name  name of a variable, which must be an object
[[nodiscard]] std::string mat_of_json(const Json& json, const std::string& name = "");

}  // namespace quadtune::internal
