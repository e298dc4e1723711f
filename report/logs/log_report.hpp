// SPDX-License-Identifier: Apache-2.0
/// What a survey of a log looks like, to people and to scripts.
#pragma once

#include <string>
#include <vector>

#include "quadtune/estimation/model_needs.hpp"
#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/logs/log_survey.hpp"

namespace quadtune::report {

/// Keys as docs/cli.md says; what is not known is null.
/// @param models  what each filter model finds in it
[[nodiscard]] internal::Json to_json(const LogSurvey& survey, const std::vector<ModelNeeds>& models,
                                     const std::string& file);
[[nodiscard]] std::string to_text(const LogSurvey& survey, const std::vector<ModelNeeds>& models,
                                  const std::string& file);

}  // namespace quadtune::report
