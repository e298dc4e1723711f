// SPDX-License-Identifier: Apache-2.0
/// Text of nlohmann's JSON, as json_text() of quadtune/internal/json_value.hpp writes it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace quadtune::internal {

[[nodiscard]] std::string dump_json(const nlohmann::json& json, bool ascii = false);

}  // namespace quadtune::internal
