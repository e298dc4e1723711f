// SPDX-License-Identifier: Apache-2.0
#include "program/file_kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "program/program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/imu_calibration_file.hpp"
#include "quadtune/exports/manifest.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json_value.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/toml_reader.hpp"

namespace quadtune::cli {
namespace {

namespace fs = std::filesystem;

/// The commands that take a kind, with the option where it is none that stands alone.
struct FileKind {
  const char* words;  ///< "a design file"
  std::vector<std::string> takers;
};

std::vector<std::string> with(std::vector<std::string> some, const std::vector<std::string>& more) {
  some.insert(some.end(), more.begin(), more.end());
  return some;
}

const std::vector<std::string> kLawTakers = {
    "fly --gains", "compare", "compare --gains",  "margins --gains",
    "diff",        "export",  "tune pid --gains", "tune lqr --match-gains"};

const FileKind kExport = {"an export", with({"verify", "certify"}, kLawTakers)};
const FileKind kGains = {"a file of gains", kLawTakers};
const FileKind kDesign = {"a design file", with({"design", "verify --design"}, kLawTakers)};
const FileKind kVehicle = {
    "a vehicle file",
    {"vehicle", "linearize", "lqr", "lqg", "pid", "margins", "discretize", "fly", "compare",
     "tune pid", "tune lqr", "export --vehicle", "verify --vehicle", "certify --vehicle"}};
const FileKind kMission = {
    "a mission file",
    {"fly --mission", "compare --mission", "tune pid --mission", "tune lqr --mission"}};
const FileKind kCampaign = {"a campaign file", {"campaign run", "campaign init"}};
const FileKind kCampaignFolder = {"a campaign's folder",
                                  {"campaign work", "campaign status", "campaign merge",
                                   "campaign replay", "campaign run", "campaign init"}};
const FileKind kRequirements = {"a file of requirements",
                                {"tune pid --requirements", "tune lqr --requirements"}};
const FileKind kFilterModel = {"a filter model", {"tune kalman --model"}};
const FileKind kSchedule = {"a gain schedule", {"fly --gains", "compare", "compare --gains"}};
const FileKind kLog = {"a flight log",
                       {"log", "tune kalman --log", "calibrate imu --log", "allan --log"}};
const FileKind kCalibration = {"a calibration of sensors", {"calibrate imu --base"}};
const FileKind kOtherJson = {"JSON, but neither gains nor an export", {}};
const FileKind kPage = {"a page to look at", {}};

const FileKind* kind_of_json(const std::string& text) {
  internal::Json json;
  try {
    json = internal::Json::parse(text);
  } catch (const internal::JsonError&) {
    return nullptr;
  }
  if (!json.is_object()) return nullptr;
  const std::string format = json.contains("format") && json["format"].is_string()
                                 ? json["format"].get<std::string>()
                                 : "";
  if (format == "quadtune-gains" || format == "quadtune-export") return &kGains;
  if (format.find("schedule") != std::string::npos) return &kSchedule;
  return &kOtherJson;
}

const FileKind* kind_of_toml(const std::string& text) {
  const auto file = internal::TomlTable::parse(text, "file");
  if (file.has("body") || file.has("rotors")) return &kVehicle;
  if (file.has("dynamics") || file.has("noises")) return &kFilterModel;
  if (file.has("format")) return &kSchedule;
  if (file.has("flights")) return &kCampaign;
  if (file.has("lqr") || file.has("cascade") || file.has("kalman")) return &kDesign;
  if (file.has("duration_s")) return &kMission;
  if (file.has("cost") || file.has("margins") || file.has("loops")) return &kRequirements;
  return nullptr;
}

bool is_calibration(const std::string& text) {
  try {
    (void)parse_imu_calibration(text, "file");
    return true;
  } catch (const InvalidInput&) {
    return false;
  }
}

/// @throws InvalidInput  for what is no text, or is no TOML though nothing else fits
const FileKind* kind_of_file(const fs::path& path) {
  const std::string name = path.extension().string();
  if (name == ".mat" || name == ".ulg") return &kLog;
  if (name == ".html") return &kPage;
  const std::string text = internal::read_text_file(path.string(), internal::kTomlLimit);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return nullptr;
  if (text[first] == '{') return kind_of_json(text);
  if (text.starts_with("# quadtune-log")) return &kLog;
  // What the Mambo project has beside its gains.
  if (path.filename() == "vehicleVars.m" || path.filename() == "estimatorVars.m") return nullptr;
  if (name == ".m" || (name == ".txt" && path.filename().string().starts_with("K"))) return &kGains;
  if (std::isdigit(static_cast<unsigned char>(text[first])) != 0 || text[first] == '-')
    return is_calibration(text) ? &kCalibration : nullptr;
  return name == ".toml" ? kind_of_toml(text) : nullptr;
}

const FileKind* kind_of(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    if (fs::exists(path / kManifestName, ignored)) return &kExport;
    return fs::exists(path / "plan.json", ignored) ? &kCampaignFolder : nullptr;
  }
  if (!fs::is_regular_file(path, ignored)) return nullptr;  // a pipe would be waited for
  try {
    return kind_of_file(path);
  } catch (const InvalidInput&) {
    return nullptr;
  } catch (const FileError&) {
    return nullptr;
  }
}

/// "fly --gains" for the argument at `at`; "fly" where it stands alone.
std::string place_of(const std::vector<std::string>& args, std::size_t at) {
  std::string place = args[0];
  if (const std::vector<std::string> kinds = kinds_of(args[0]);
      args.size() > 1 && std::find(kinds.begin(), kinds.end(), args[1]) != kinds.end())
    place += " " + args[1];
  const std::size_t equals = args[at].find('=');
  if (args[at].starts_with("--") && equals != std::string::npos)
    return place + " " + args[at].substr(0, equals);
  if (at > 0 && args[at - 1].starts_with("-") && args[at - 1] != "--json" &&
      args[at - 1] != "--quiet")
    return place + " " + args[at - 1];
  return place;
}

}  // namespace

std::string who_takes(const std::vector<std::string>& args, const std::string& where) {
  const auto names = [&](const std::string& file) {
    return where == file || where.starts_with(file + ":");
  };
  for (std::size_t i = 1; i < args.size(); ++i) {
    const std::size_t equals = args[i].starts_with("--") ? args[i].find('=') : std::string::npos;
    const std::string file = equals == std::string::npos ? args[i] : args[i].substr(equals + 1);
    if (file.empty() || !names(file)) continue;
    const FileKind* kind = kind_of(file);
    if (kind == nullptr) return "";
    const std::vector<std::string>& takers = kind->takers;
    const std::string place = place_of(args, i);
    // One file may stand in two places, one of them the right one.
    if (std::find(takers.begin(), takers.end(), place) != takers.end()) continue;
    if (takers.empty()) return fmt::format("; this is {}, which no command reads", kind->words);
    return fmt::format("; this is {}; it is read by: quadtune {}", kind->words,
                       internal::joined(takers, ", "));
  }
  return "";
}

}  // namespace quadtune::cli
