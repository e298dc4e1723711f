// SPDX-License-Identifier: Apache-2.0
/// What a controls engineer wants to see first of a design, as text and as JSON.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/exports/export.hpp"
#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/design/design.hpp"

namespace quadtune::report {

/// One export of the design: what was written and whether it reads back right.
struct WrittenExport {
  ExportKind kind = ExportKind::json;
  std::string directory;
  std::vector<ManifestFile> files;
  VerifyReport verification;
};

/// True when every export read back right; a design that wrote nothing has nothing to fail.
[[nodiscard]] bool passed(const DesignOutcome& outcome, const std::vector<WrittenExport>& written);

[[nodiscard]] internal::Json design_json(const DesignOutcome& outcome,
                                         const std::vector<WrittenExport>& written);
[[nodiscard]] std::string design_text(const DesignOutcome& outcome,
                                      const std::vector<WrittenExport>& written);

}  // namespace quadtune::report
