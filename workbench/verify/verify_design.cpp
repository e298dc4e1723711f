// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/verify/verify_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "quadtune/design/export_target.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/firmware.hpp"
#include "quadtune/exports/flight_code.hpp"
#include "quadtune/exports/imu_calibration_file.hpp"
#include "quadtune/exports/text_difference.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/design/design_verdict.hpp"
#include "quadtune/workbench/export/export_content.hpp"
#include "quadtune/workbench/export/gains_export.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;

constexpr char kName[] = "files are what the design gives";
constexpr std::size_t kFileLimit = std::size_t{16} << 20;
/// Solutions of one problem agree between machines to about 1e-12, and results of searches, as for
/// a cascade, to 1e-8.
constexpr double kDesignRounding = 1e-7;

/// The content with the options of the export, which are read from its files.
ExportContent content_of(const fs::path& directory, const Manifest& manifest,
                         const DesignOutcome& outcome) {
  ExportContent content = export_content(outcome);
  const std::string& kind = manifest.kind.name();
  if (kind == "c") content.flight_code = read_flight_code_options(directory);
  for (const ManifestFile& file : manifest.files) {
    if (kind == "uquad" && file.path == kImuCalibrationName)
      content.imu_calibration = read_imu_calibration((directory / file.path).string());
    if (kind == "uquad" && file.path == kUquadConstantsName) content.uquad_constants = true;
  }
  if (export_target(kind, kManifestName).is_firmware) {
    const FirmwareKind firmware = firmware_kind(kind, kManifestName);
    const fs::path path = directory / parameter_file_name(firmware);
    content.firmware = written_options(
        firmware, internal::read_text_file(path.string(), kFileLimit), path.string());
  }
  return content;
}

/// The text of a manifest without data that differ between runs (times, versions, hashes, which
/// follow from the files) and without data that other checks compare better: estimates of rounding
/// errors, and poles, whose order may differ between machines.
std::string comparable(Manifest manifest) {
  manifest.made_at.clear();
  manifest.versions.clear();
  manifest.forced.clear();
  manifest.evidence.residual = manifest.evidence.rcond = std::numeric_limits<double>::quiet_NaN();
  manifest.evidence.iterations = 0;
  manifest.evidence.poles.resize(0);
  manifest.closed_loop_poles.resize(0);
  manifest.cascade_poles.resize(0);
  for (ManifestFile& file : manifest.files) file = {file.path, "", 0};
  return manifest_text(manifest);
}

struct Comparison {
  std::string difference;  ///< a sentence; empty: equal up to rounding
  double rounding = 0;     ///< the largest difference of two numbers

  /// @param place  of the difference, e.g. "gains.json, line 7"
  void add(const std::string& place, const std::string& found, const std::string& expected) {
    if (found == expected || !difference.empty()) return;
    const std::optional<double> apart = numbers_apart(found, expected);
    if (!apart)
      difference = fmt::format("{}, differs from what the design file gives", place);
    else if (*apart > kDesignRounding)
      difference = fmt::format(
          "{}, has numbers that differ by {:.3g} of its largest from what the "
          "design file gives",
          place, *apart);
    else
      rounding = std::max(rounding, *apart);
  }
};

void compare_manifests(const std::string& found, const std::string& expected,
                       Comparison& comparison) {
  const internal::Json a = internal::Json::parse(found), b = internal::Json::parse(expected);
  for (const std::string& key : b.keys())
    comparison.add(fmt::format("{}, member '{}'", kManifestName, key),
                   a.contains(key) ? internal::json_text(a[key]) : "", internal::json_text(b[key]));
  for (const std::string& key : a.keys())
    if (!b.contains(key))
      comparison.add(fmt::format("{}, member '{}'", kManifestName, internal::printable(key)),
                     internal::json_text(a[key]), "");
}

/// Files derived from numbers that differ by rounding may differ by more. Other checks compare
/// them: flight code by a recorded flight, and binary files.
bool follows_from_gains(const FileContent& file, const std::string& kind) {
  if (kind == "c") return file.name != kGainsJsonName && file.name != kFlightCodeName;
  return file.bytes.find('\0') != std::string::npos;
}

Comparison compare(const fs::path& directory, const Manifest& manifest,
                   const std::vector<FileContent>& files) {
  Comparison result;
  const auto read = [&](const FileContent& file) {
    return internal::read_file((directory / file.name).string(), kFileLimit);
  };
  const auto add = [&](const FileContent& file) {
    const std::string found = read(file);
    result.add(fmt::format("{}, line {}", file.name, first_other_line(found, file.bytes)), found,
               file.bytes);
  };
  std::size_t listed = 0;
  for (const FileContent& file : files) {
    if (file.name == kManifestName)
      compare_manifests(comparable(manifest), comparable(parse_manifest(file.bytes, kManifestName)),
                        result);
    else if (!follows_from_gains(file, manifest.kind.name()))
      add(file);
    listed += file.name == kManifestName ? 0 : 1;
  }
  for (const FileContent& file : files)
    if (file.name != kManifestName && follows_from_gains(file, manifest.kind.name()) &&
        result.rounding == 0)
      add(file);
  if (result.difference.empty() && listed != manifest.files.size())
    result.difference = fmt::format("the manifest lists {} files, the design file gives {}",
                                    manifest.files.size(), listed);
  return result;
}

/// A reason against the export that the manifest lacks.
std::string missing_reason(const Manifest& manifest, const DesignOutcome& outcome) {
  for (const std::string& reason : reasons_against_export(outcome))
    if (std::find(manifest.forced.begin(), manifest.forced.end(), reason) == manifest.forced.end())
      return fmt::format("the manifest does not state that --force was used, although {}", reason);
  return "";
}

}  // namespace

VerifyCheck check_design(const fs::path& directory, const Manifest& manifest,
                         const DesignOutcome& outcome) {
  try {
    ExportContent content = content_of(directory, manifest, outcome);
    Comparison found = compare(directory, manifest, export_files(manifest.kind, content));
    if (!found.difference.empty()) {
      // `quadtune export` converts gains to the convention of the target program, whereas `quadtune
      // design` requires it in the design.
      (void)adapt_to_program(content, manifest.kind);
      const Comparison adapted = compare(directory, manifest, export_files(manifest.kind, content));
      if (adapted.difference.empty()) found = adapted;
    }
    if (found.difference.empty()) found.difference = missing_reason(manifest, outcome);
    if (!found.difference.empty()) return {kName, false, found.difference};
    return {kName, true,
            found.rounding > 0
                ? fmt::format("designed again; numbers differ by rounding, {:.2g}", found.rounding)
                : "designed again, byte by byte"};
  } catch (const InvalidInput& error) {
    return {kName, false, error.what()};
  } catch (const FileError& error) {
    return {kName, false, error.what()};
  } catch (const NoSolution& error) {
    return {kName, false, error.what()};
  }
}

}  // namespace quadtune
