// SPDX-License-Identifier: Apache-2.0
#include "report/gains/laws_json.hpp"

#include "quadtune/exports/export.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune::report {

void add_laws(internal::Json& json, const ExportContent& content) {
  const internal::Json stored = internal::Json::parse(gains_json_text(content));
  for (const char* key : {"format", "format_version", "gains", "cascade", "estimator"})
    if (stored.contains(key)) json[key] = stored[key];
}

}  // namespace quadtune::report
