// SPDX-License-Identifier: Apache-2.0
/// Writes the exports that a design file requests, and verifies them.
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

/// One export of a design: the written files and the result of their verification.
struct WrittenExport {
  ExportKind kind = ExportKind::json;  ///< target of the export
  std::string directory;               ///< that was written
  std::vector<ManifestFile> files;     ///< as in the manifest
  VerifyReport verification;           ///< of the written files
  /// Changes that the target program makes to the design, e.g. by rounding; one sentence each.
  std::vector<std::string> notes = {};
  std::string weak = {};  ///< weak_loops(), with which it was written by force; empty if sufficient
};

/// Writes one export to its directory: write_export(), or a wrapper of it.
using ExportWriter = std::function<std::vector<ManifestFile>(
    const std::filesystem::path& directory, ExportKind kind, const ExportContent& content)>;

/// Writes every export of the design ([[export]]) and verifies the files. A single export is
/// written to `directory` itself, several to one subfolder each, named after the kind of export.
/// All exports are first created in memory: if one of them cannot represent the design, none is
/// written. With `force`, parameters of a firmware are also written if the margins are too small
/// with its filters and delay (weak_loops()); the manifest then contains the reason.
///
/// @throws InvalidInput  if the design has no [[export]], or as export_files()
/// @throws NoSolution    if a rotation loop is unstable with the filters and delays of a firmware;
///                       without `force`, also if its margins are too small
/// @throws FileError, Interrupted  as `write`
[[nodiscard]] std::vector<WrittenExport> write_exports(const DesignOutcome& outcome,
                                                       const std::string& directory,
                                                       const ExportWriter& write, bool force);

}  // namespace quadtune
