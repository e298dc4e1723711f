// SPDX-License-Identifier: Apache-2.0
/// The checks of an export: for `verify`, `design` and `certify`.
#pragma once

#include <string>

#include "quadtune/exports/verify.hpp"
#include "quadtune/internal/json_fwd.hpp"

namespace quadtune::report {

[[nodiscard]] internal::Json to_json(const VerifyReport& report);
[[nodiscard]] std::string to_text(const VerifyReport& report);

}  // namespace quadtune::report
