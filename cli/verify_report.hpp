// SPDX-License-Identifier: Apache-2.0
/// A verification as text and JSON, for `verify` and `design`.
#pragma once

#include <string>

#include "quadtune/exports/verify.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune::cli {

[[nodiscard]] internal::Json to_json(const VerifyReport& report);
[[nodiscard]] std::string to_text(const VerifyReport& report);

}  // namespace quadtune::cli
