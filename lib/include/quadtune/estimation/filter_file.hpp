// SPDX-License-Identifier: Apache-2.0
/// Filter models as TOML files: docs/formats.md, "Filter models".
#pragma once

#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"

namespace quadtune {

/// A model that the library carries, or a user's file.
/// @param name  a built-in model's name, or a path.
/// @throws InvalidInput  "file:line: …" for a mistake in it; for a name that is none.
/// @throws FileError     for a file that cannot be read.
[[nodiscard]] FilterModel load_filter_model(const std::string& name);

/// A model from the text of its file.
/// @param origin  What messages call it.
[[nodiscard]] FilterModel parse_filter_model(const std::string& text, const std::string& origin);

/// The text of a file that parse_filter_model() reads as this model, with its starts.
/// @param comments  lines at its head, without '#'
/// @throws InvalidInput  as validate(); for what a file cannot say: a part of a covariance that is
/// no
///                       identity, some diffuse states among others.
[[nodiscard]] std::string text_of_filter_model(const FilterModel& model,
                                               const std::vector<std::string>& comments = {});

/// Name and description of each built-in model, in the order of the documentation.
struct FilterModelTitle {
  std::string name, description;
};
[[nodiscard]] std::vector<FilterModelTitle> built_in_filter_models();

}  // namespace quadtune
