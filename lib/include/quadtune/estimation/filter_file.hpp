// SPDX-License-Identifier: Apache-2.0
/// Filter models as TOML files: docs/formats.md, "Filter models".
#pragma once

#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"

namespace quadtune {

/// Loads a built-in filter model or a user's file.
/// @param name  name of a built-in model, or a path
/// @throws InvalidInput  "file:line: …" if the file has a mistake; if there is no built-in model
///                       and no file of that name
/// @throws FileError     if the file cannot be read
[[nodiscard]] FilterModel load_filter_model(const std::string& name);

/// Parses a filter model from the text of its file.
/// @param text    content of the file
/// @param origin  name of the text in messages
/// @throws InvalidInput  "origin:line: …" if the text has a mistake
[[nodiscard]] FilterModel parse_filter_model(const std::string& text, const std::string& origin);

/// Returns the text of a file that parse_filter_model() reads as this model, including its starts.
/// @param model     accepted by validate()
/// @param comments  lines at the beginning of the file, without '#'
/// @throws InvalidInput  as validate(); if the file format cannot express the model: a term of a
///                       covariance that is not an identity, or only some diffuse states
[[nodiscard]] std::string text_of_filter_model(const FilterModel& model,
                                               const std::vector<std::string>& comments = {});

/// Name and description of a built-in model; built_in_filter_models() lists them in the order of
/// the documentation.
struct FilterModelTitle {
  std::string name,  ///< e.g. "altitude"
      description;   ///< what the filter estimates, in one line
};

/// The titles of all built-in models.
[[nodiscard]] std::vector<FilterModelTitle> built_in_filter_models();

}  // namespace quadtune
