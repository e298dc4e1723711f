// SPDX-License-Identifier: Apache-2.0
/// The interface to one flight program or file format: a struct that is added to a registry.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/design/export_target.hpp"
#include "quadtune/exports/content.hpp"
#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/read_gains.hpp"

namespace quadtune {

/// An exporter. Manifest, hashes, atomic writing and the comparison of the files with the manifest
/// are the same for all exporters; the members are the parts that differ. An empty function means
/// that the exporter does not support the feature.
///
///     add_exporter({.target = {"mine"}, .convention = "ned", .gain_files = {"gains.txt"},
///                   .files = my_files, .read = my_reader});
///     write_export("out", ExportKind("mine"), content);
struct Exporter {
  ExportTarget target;     ///< its name, and the estimator of its flight program
  std::string convention;  ///< convention of the gains that it writes; empty: any
  /// Names of all files in which its flight program would look for gains.
  std::vector<std::string> gain_files;
  bool writes_cascade = true;  ///< whether its files can contain a PID cascade
  /// Whether its files contain numbers of a cascade even if none was designed.
  bool always_has_cascade = false;

  /// Converts the content to what the flight program will use, e.g. with gains rounded to the
  /// precision of the program. The files and the manifest are created from the result.
  /// @throws InvalidInput  if the flight program cannot fly the content
  std::function<ExportContent(ExportContent)> fit = {};
  /// Creates the files of an export, without the manifest.
  /// @throws InvalidInput  if the files cannot represent the content
  std::function<std::vector<FileContent>(const ExportContent&)> files;
  /// Returns the named numbers that a file defines; they are listed in the manifest.
  std::function<std::vector<NamedMatrix>(const FileContent&)> numbers = {};
  /// Reads the laws from a directory as the flight program does.
  /// @throws InvalidInput, FileError
  std::function<StoredLaws(const std::filesystem::path&, const Manifest&)> read;
  /// Reads the laws from a file, or from a directory without a manifest; returns no value if the
  /// path has none of its files. The exporter that was added last is tried first.
  /// @throws InvalidInput, FileError
  std::function<std::optional<StoredLaws>(const std::filesystem::path&)> read_plain = {};
  /// Reads the other files of the export and rejects what the flight program would reject.
  /// @throws InvalidInput, FileError
  std::function<void(const std::filesystem::path&, const Manifest&, const Gains&)> check = {};
  /// Describes how the weights in the files differ from those of the manifest; "" if they agree.
  /// @throws InvalidInput, FileError
  std::function<std::string(const std::filesystem::path&, const Manifest&)> weights_difference = {};
  /// Regenerates the files of a directory from the laws of its manifest and a vehicle. Only data
  /// that exist nowhere else, such as the numbers of an estimator, are read from the files. Files
  /// that these inputs do not determine are omitted. verify_export() compares the result byte by
  /// byte.
  /// @throws InvalidInput, FileError
  std::function<std::vector<FileContent>(const std::filesystem::path&, const Manifest&,
                                         const Vehicle&)>
      written_again = {};
  /// Reads the Kalman filters from a directory.
  /// @throws InvalidInput, FileError
  std::function<std::vector<KalmanFilter>(const std::filesystem::path&)> filters = {};
};

/// Adds an exporter, or replaces the exporter of the same name. From then on, design files,
/// `write_export()`, `read_laws()` and `verify_export()` accept it. Not safe while other threads
/// use any of these.
void add_exporter(Exporter exporter);

/// @throws InvalidInput  as export_kind()
[[nodiscard]] const Exporter& exporter_of(const ExportKind& kind, const std::string& where);

/// All exporters, in the order of export_targets().
[[nodiscard]] const std::vector<Exporter>& exporters();

}  // namespace quadtune
