// SPDX-License-Identifier: Apache-2.0
/// The name of a JSON value, for headers: nlohmann/json.hpp takes more than a second to compile.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace quadtune::internal {

using Json = nlohmann::ordered_json;

}  // namespace quadtune::internal
