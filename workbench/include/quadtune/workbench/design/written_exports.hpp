// SPDX-License-Identifier: Apache-2.0
/// The exports that a design file asks for, written and read back.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "quadtune/exports/content.hpp"
#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/workbench/design/design.hpp"

namespace quadtune {

/// One export of a design: what was written and whether it reads back right.
struct WrittenExport {
  ExportKind kind = ExportKind::json;
  std::string directory;
  std::vector<ManifestFile> files;
  VerifyReport verification;
  /// What the program that it is for changes of the design, a sentence each, e.g. by rounding.
  std::vector<std::string> notes = {};
};

/// What puts one export into its place: write_export(), or a function around it.
using ExportWriter = std::function<std::vector<ManifestFile>(
    const std::filesystem::path& directory, ExportKind kind, const ExportContent& content)>;

/// Writes every export of the design ([[export]]) and verifies what was written. A single one goes
/// into the directory itself, several into one folder each, named as the export's kind. All are
/// made in memory first: what one of them cannot express keeps the others from being written.
/// @throws InvalidInput  for a design without [[export]], or as export_files()
/// @throws NoSolution    for a firmware with whose filters and delays a turn is unstable
/// @throws FileError, Interrupted  as `write` does
[[nodiscard]] std::vector<WrittenExport> write_exports(const DesignOutcome& outcome,
                                                       const std::string& directory,
                                                       const ExportWriter& write);

}  // namespace quadtune
