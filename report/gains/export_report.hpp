// SPDX-License-Identifier: Apache-2.0
/// Written files as JSON, for `export` and `design`.
#pragma once

#include <vector>

#include "quadtune/exports/manifest.hpp"
#include "quadtune/internal/json_fwd.hpp"

namespace quadtune::report {

[[nodiscard]] internal::Json to_json(const std::vector<ManifestFile>& files);

}  // namespace quadtune::report
