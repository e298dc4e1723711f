// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/files/file_kind.hpp"

#include <cctype>

#include "quadtune/errors.hpp"
#include "quadtune/exports/imu_calibration_file.hpp"
#include "quadtune/exports/manifest.hpp"
#include "quadtune/internal/json_value.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/toml_reader.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;

std::optional<FileKind> kind_of_json(const std::string& text) {
  internal::Json json;
  try {
    json = internal::Json::parse(text);
  } catch (const internal::JsonError&) {
    return std::nullopt;
  }
  if (!json.is_object()) return std::nullopt;
  const std::string format = json.contains("format") && json["format"].is_string()
                                 ? json["format"].get<std::string>()
                                 : "";
  if (format == "quadtune-gains" || format == "quadtune-export") return FileKind::gains;
  if (format.find("schedule") != std::string::npos) return FileKind::schedule;
  return FileKind::other_json;
}

std::optional<FileKind> kind_of_toml(const std::string& text) {
  const auto file = internal::TomlTable::parse(text, "file");
  if (file.has("body") || file.has("rotors")) return FileKind::vehicle;
  if (file.has("dynamics") || file.has("noises")) return FileKind::filter_model;
  if (file.has("format")) return FileKind::schedule;
  if (file.has("flights")) return FileKind::campaign;
  if (file.has("lqr") || file.has("cascade") || file.has("kalman")) return FileKind::design;
  if (file.has("duration_s")) return FileKind::mission;
  if (file.has("cost") || file.has("margins") || file.has("loops")) return FileKind::requirements;
  return std::nullopt;
}

bool is_calibration(const std::string& text) {
  try {
    (void)parse_imu_calibration(text, "file");
    return true;
  } catch (const InvalidInput&) {
    return false;
  }
}

/// @throws InvalidInput  if the file is not text, or is not valid TOML although no other kind fits
std::optional<FileKind> kind_of_file(const fs::path& path) {
  const std::string name = path.extension().string();
  if (name == ".mat" || name == ".ulg") return FileKind::log;
  if (name == ".html") return FileKind::page;
  const std::string text = internal::read_text_file(path.string(), internal::kTomlLimit);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return std::nullopt;
  if (text[first] == '{') return kind_of_json(text);
  if (text.starts_with("# quadtune-log")) return FileKind::log;
  // Files of the Mambo project next to its gains.
  if (path.filename() == "vehicleVars.m" || path.filename() == "estimatorVars.m" ||
      path.filename() == "sensorsVars.m")
    return std::nullopt;
  if (name == ".m" || (name == ".txt" && path.filename().string().starts_with("K")))
    return FileKind::gains;
  if (std::isdigit(static_cast<unsigned char>(text[first])) != 0 || text[first] == '-')
    return is_calibration(text) ? std::optional(FileKind::calibration) : std::nullopt;
  return name == ".toml" ? kind_of_toml(text) : std::nullopt;
}

}  // namespace

std::string to_string(FileKind kind) {
  switch (kind) {
    case FileKind::export_folder:
      return "an export";
    case FileKind::gains:
      return "a file of gains";
    case FileKind::design:
      return "a design file";
    case FileKind::vehicle:
      return "a vehicle file";
    case FileKind::mission:
      return "a mission file";
    case FileKind::campaign:
      return "a campaign file";
    case FileKind::campaign_folder:
      return "a campaign's folder";
    case FileKind::requirements:
      return "a file of requirements";
    case FileKind::filter_model:
      return "a filter model";
    case FileKind::schedule:
      return "a gain schedule";
    case FileKind::log:
      return "a flight log";
    case FileKind::calibration:
      return "a calibration of sensors";
    case FileKind::other_json:
      return "JSON, but neither gains nor an export";
    case FileKind::page:
      return "a page for a browser";
  }
  return "";
}

std::optional<FileKind> file_kind(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    if (fs::exists(path / kManifestName, ignored)) return FileKind::export_folder;
    return fs::exists(path / kPlanName, ignored) ? std::optional(FileKind::campaign_folder)
                                                 : std::nullopt;
  }
  if (!fs::is_regular_file(path, ignored)) return std::nullopt;  // reading a pipe could block
  try {
    return kind_of_file(path);
  } catch (const InvalidInput&) {
    return std::nullopt;
  } catch (const FileError&) {
    return std::nullopt;
  }
}

}  // namespace quadtune
