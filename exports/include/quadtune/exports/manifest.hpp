// SPDX-License-Identifier: Apache-2.0
/// The manifest of an export: its files, its inputs and how the law is applied.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "quadtune/exports/content.hpp"
#include "quadtune/gains.hpp"

namespace quadtune {

/// The target of an export: the name of an exporter (exporter.hpp).
class ExportKind {
 public:
  static const ExportKind uquad,  ///< gain files of the uquad
      mambo,                      ///< model parameters of the Mambo
      json;                       ///< gains.json

  /// The kind with this name; export_kind() also checks that it exists.
  explicit ExportKind(std::string name) : name_(std::move(name)) {}

  [[nodiscard]] const std::string& name() const { return name_; }  ///< e.g. "uquad"
  friend bool operator==(const ExportKind&, const ExportKind&) = default;

 private:
  std::string name_;
};
inline const ExportKind ExportKind::uquad("uquad");
inline const ExportKind ExportKind::mambo("mambo");
inline const ExportKind ExportKind::json("json");

/// "uquad", "mambo", "json", "c", or the name of an exporter that was added.
[[nodiscard]] std::string to_string(const ExportKind& kind);
/// The inverse of to_string().
/// @throws InvalidInput  if the name is unknown, with the existing kinds and the nearest
[[nodiscard]] ExportKind export_kind(const std::string& name, const std::string& where);

/// One file with its hash.
struct ManifestFile {
  std::string path;      ///< name within the export; of an input, its name without the directory
  std::string sha256;    ///< of the bytes of the file, 64 hexadecimal digits
  std::size_t size = 0;  ///< [byte]
};

/// A named value in a file, e.g. "Controller.StateFeedback.K".
struct NamedMatrix {
  std::string file;       ///< name of the file within the export
  std::string name;       ///< as the file spells it
  Eigen::MatrixXd value;  ///< empty for an expression
  std::string text = {};  ///< source of an expression, e.g. "inv(Controller.Ts2Q)"; else empty
};

/// The contents of manifest.json.
struct Manifest {
  ExportKind kind = ExportKind::json;                         ///< target of the export
  std::string vehicle;                                        ///< name of the vehicle
  std::vector<std::pair<std::string, std::string>> versions;  ///< quadtune and its libraries
  std::string made_at;                                        ///< empty unless requested
  std::vector<std::string> forced;                            ///< see ExportContent::forced
  std::vector<ManifestFile> inputs;  ///< design and vehicle files that the export was made from
  std::vector<ManifestFile> files;   ///< all files of the export except the manifest
  /// In the convention of the target; empty if there is no state feedback.
  std::optional<Gains> gains;
  std::optional<CascadeDesign> cascade;  ///< the PID cascade; empty if there is none
  Eigen::MatrixXd Q;  ///< weights of the gains' states, then integrals; empty if there were none
  Eigen::MatrixXd R;  ///< weights of the gains' inputs, likewise
  ExportEvidence evidence;  ///< of the solver of the gains
  /// Closed loop of the written gains with the plant; empty if unknown.
  Eigen::VectorXcd closed_loop_poles;
  Eigen::VectorXcd cascade_poles;    ///< of the written cascade, likewise
  std::vector<NamedMatrix> numbers;  ///< all named values that the files define
};

inline constexpr char kManifestName[] = "manifest.json";  ///< name of the manifest in an export

/// @throws InvalidInput  if a number is not finite
[[nodiscard]] std::string manifest_text(const Manifest& manifest);

/// @param text    content of the file
/// @param origin  name of the file in messages
/// @throws InvalidInput  "origin:line: …" or "origin: json path: …"
[[nodiscard]] Manifest parse_manifest(const std::string& text, const std::string& origin);

/// Reads manifest.json of a directory.
/// @throws FileError     if it cannot be read
/// @throws InvalidInput  as parse_manifest()
[[nodiscard]] Manifest read_manifest(const std::filesystem::path& directory);

}  // namespace quadtune
