// SPDX-License-Identifier: Apache-2.0
/// Writes nlohmann::json as text, in the same form as json_text() of
/// quadtune/internal/json_value.hpp.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace quadtune::internal {

[[nodiscard]] std::string dump_json(const nlohmann::json& json, bool ascii = false);

}  // namespace quadtune::internal
