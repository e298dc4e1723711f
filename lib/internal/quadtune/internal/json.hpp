// SPDX-License-Identifier: Apache-2.0
/// Converts matrices, signals and poles to JSON and back. Numbers read back as the same double.
/// JSON cannot represent numbers that are not finite: they are rejected, or written as null where a
/// null has a meaning.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/internal/json_value.hpp"
#include "quadtune/lti.hpp"

namespace quadtune::internal {

/// @param name  the number's name in the message.
/// @throws InvalidInput  if it is not finite.
[[nodiscard]] Json number_to_json(double number, const std::string& name);

/// The number, or null if it is not finite, for values that may be missing or unbounded.
[[nodiscard]] Json finite_or_null(double number);

/// An array of rows; a matrix without columns keeps its number of rows: [[], []].
/// @throws InvalidInput  with the first entry that is not finite.
[[nodiscard]] Json matrix_to_json(const Eigen::Ref<const Eigen::MatrixXd>& M,
                                  const std::string& name);

[[nodiscard]] Json vector_to_json(const Eigen::Ref<const Eigen::VectorXd>& v,
                                  const std::string& name);

/// Complex numbers as [real, imaginary].
[[nodiscard]] Json poles_to_json(const Eigen::Ref<const Eigen::VectorXcd>& poles,
                                 const std::string& name);

/// [{"name": "z", "unit": "m"}, …]
[[nodiscard]] Json signals_to_json(const std::vector<Signal>& signals);

/// The member `key` of an object. `where` is "file: path", to which the readers append the key.
/// @throws InvalidInput  if `json` is not an object or has no such member.
[[nodiscard]] const Json& member(const Json& json, const std::string& key,
                                 const std::string& where);

[[nodiscard]] double number_from_json(const Json& json, const std::string& where);

[[nodiscard]] std::string string_from_json(const Json& json, const std::string& where);

[[nodiscard]] Eigen::VectorXd vector_from_json(const Json& json, const std::string& where);

/// @throws InvalidInput  if the rows have different lengths.
[[nodiscard]] Eigen::MatrixXd matrix_from_json(const Json& json, const std::string& where);

[[nodiscard]] Eigen::VectorXcd poles_from_json(const Json& json, const std::string& where);

[[nodiscard]] std::vector<Signal> signals_from_json(const Json& json, const std::string& where);

}  // namespace quadtune::internal
