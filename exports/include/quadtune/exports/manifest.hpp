// SPDX-License-Identifier: Apache-2.0
/// The page that travels with an export: what is in it, from what it was made, how it is applied.
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

/// For whom the files are: the name of an exporter (exporter.hpp).
class ExportKind {
 public:
  static const ExportKind uquad, mambo, json;

  explicit ExportKind(std::string name) : name_(std::move(name)) {}

  [[nodiscard]] const std::string& name() const { return name_; }
  friend bool operator==(const ExportKind&, const ExportKind&) = default;

 private:
  std::string name_;
};
inline const ExportKind ExportKind::uquad("uquad");
inline const ExportKind ExportKind::mambo("mambo");
inline const ExportKind ExportKind::json("json");

/// "uquad", "mambo", "json", "c", or the name of an exporter that was added; and back.
[[nodiscard]] std::string to_string(const ExportKind& kind);
/// @throws InvalidInput  naming the word, the kinds that exist, and the nearest.
[[nodiscard]] ExportKind export_kind(const std::string& name, const std::string& where);

/// One file by its hash.
struct ManifestFile {
  std::string path;  ///< name within the export, or of an input without its directory
  std::string sha256;
  std::size_t size = 0;  ///< [byte]
};

/// What stands in a file under a name, e.g. "Controller.StateFeedback.K".
struct NamedMatrix {
  std::string file;
  std::string name;
  Eigen::MatrixXd value;  ///< empty for an expression
  std::string text = {};  ///< an expression as written, e.g. "inv(Controller.Ts2Q)"; else empty
};

/// manifest.json.
struct Manifest {
  ExportKind kind = ExportKind::json;
  std::string vehicle;
  std::vector<std::pair<std::string, std::string>> versions;  ///< quadtune and its libraries
  std::string made_at;                                        ///< empty unless asked for
  std::vector<std::string> forced;                            ///< as ExportContent::forced
  std::vector<ManifestFile> inputs;
  std::vector<ManifestFile> files;  ///< all of the export but the manifest itself
  std::optional<Gains> gains;
  std::optional<CascadeDesign> cascade;
  Eigen::MatrixXd Q;  ///< weights of the gains' states, then integrals; empty if there were none
  Eigen::MatrixXd R;  ///< weights of the gains' inputs, likewise
  ExportEvidence evidence;
  Eigen::VectorXcd
      closed_loop_poles;             ///< of the gains as written with the plant; empty if not known
  Eigen::VectorXcd cascade_poles;    ///< of the cascade as written, likewise
  std::vector<NamedMatrix> numbers;  ///< all that the files with names define
};

inline constexpr char kManifestName[] = "manifest.json";

/// @throws InvalidInput  for a number that is not finite.
[[nodiscard]] std::string manifest_text(const Manifest& manifest);

/// @param origin  the file's name in messages
/// @throws InvalidInput  "origin:line: …" or "origin: json path: …".
[[nodiscard]] Manifest parse_manifest(const std::string& text, const std::string& origin);

/// Reads manifest.json of a directory.
/// @throws FileError     if it cannot be read.
[[nodiscard]] Manifest read_manifest(const std::filesystem::path& directory);

}  // namespace quadtune
