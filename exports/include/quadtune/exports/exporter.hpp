// SPDX-License-Identifier: Apache-2.0
/// What one flight program, or one format, needs to be exported to: a struct in a registry.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/export_target.hpp"
#include "quadtune/exports/content.hpp"
#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/read_gains.hpp"

namespace quadtune {

/// An exporter. The manifest, the hashes, the writing as a whole and the checks that compare what
/// was read with the manifest are the same for all; these are the parts that differ. A function
/// that is empty means that there is nothing of the kind.
///
///     add_exporter({.target = {"mine"}, .convention = "ned", .gain_files = {"gains.txt"},
///                   .files = my_files, .read = my_reader});
///     write_export("out", ExportKind("mine"), content);
struct Exporter {
  ExportTarget target;     ///< its name, and the estimator of its flight program
  std::string convention;  ///< that its gains are written in; empty: any
  /// Every name under which its flight program would find gains.
  std::vector<std::string> gain_files;
  bool writes_cascade = true;  ///< whether its files hold a PID cascade
  /// Whether its files have numbers of a cascade even where none was designed.
  bool always_has_cascade = false;

  /// The content as its flight program will have it, e.g. with gains rounded to its numbers. The
  /// files and the manifest are made of this.
  /// @throws InvalidInput  for content that the flight program cannot fly
  std::function<ExportContent(ExportContent)> fit = {};
  /// The files of an export but the manifest.
  /// @throws InvalidInput  for content that the files cannot express
  std::function<std::vector<FileContent>(const ExportContent&)> files;
  /// The numbers with names that a file defines, which the manifest then lists.
  std::function<std::vector<NamedMatrix>(const FileContent&)> numbers = {};
  /// The laws as the flight program reads them from a directory.
  /// @throws InvalidInput, FileError
  std::function<StoredLaws(const std::filesystem::path&, const Manifest&)> read;
  /// The laws of a file, or of a directory without a manifest; no value if it holds none of its
  /// files. The exporter that was added last is asked first.
  /// @throws InvalidInput, FileError
  std::function<std::optional<StoredLaws>(const std::filesystem::path&)> read_plain = {};
  /// Reads what stands beside the laws, and refuses what the flight program would.
  /// @throws InvalidInput, FileError
  std::function<void(const std::filesystem::path&, const Manifest&, const Gains&)> check = {};
  /// How the weights in the files differ from the manifest's; "" where they do not.
  /// @throws InvalidInput, FileError
  std::function<std::string(const std::filesystem::path&, const Manifest&)> weights_difference = {};
  /// Files of a directory, written again from the laws of its manifest and a vehicle; from the
  /// files themselves comes only what stands nowhere else, such as an estimator's numbers. Files
  /// that these do not determine are left out. verify_export() compares them byte by byte.
  /// @throws InvalidInput, FileError
  std::function<std::vector<FileContent>(const std::filesystem::path&, const Manifest&,
                                         const Vehicle&)>
      written_again = {};
  /// The Kalman filters that a directory holds.
  /// @throws InvalidInput, FileError
  std::function<std::vector<KalmanFilter>(const std::filesystem::path&)> filters = {};
};

/// Adds an exporter, or replaces the one of its name: design files, `write_export()`, `read_laws()`
/// and `verify_export()` know it from then on. Not while other threads use any of these.
void add_exporter(Exporter exporter);

/// @throws InvalidInput  as export_kind()
[[nodiscard]] const Exporter& exporter_of(const ExportKind& kind, const std::string& where);

/// All of them, in the order of export_targets().
[[nodiscard]] const std::vector<Exporter>& exporters();

}  // namespace quadtune
