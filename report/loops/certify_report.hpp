// SPDX-License-Identifier: Apache-2.0
/// What `certify` proved and found, as text and JSON.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/verify/certify.hpp"

namespace quadtune::report {

[[nodiscard]] internal::Json to_json(const CertifyReport& report);
[[nodiscard]] std::string to_text(const CertifyReport& report);

}  // namespace quadtune::report
