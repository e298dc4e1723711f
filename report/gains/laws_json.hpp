// SPDX-License-Identifier: Apache-2.0
/// Control laws as JSON that is read again.
#pragma once

#include "quadtune/exports/content.hpp"
#include "quadtune/internal/json_fwd.hpp"

namespace quadtune::report {

/// The keys by which read_laws() knows the laws again, for what a verb prints as JSON:
/// "format", "format_version", and "gains", "cascade" and "estimator" of what `content` has.
void add_laws(internal::Json& json, const ExportContent& content);

}  // namespace quadtune::report
