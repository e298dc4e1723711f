// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/verify/verify_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "quadtune/errors.hpp"
#include "quadtune/export_target.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/firmware.hpp"
#include "quadtune/exports/flight_code.hpp"
#include "quadtune/exports/text_difference.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/design/export_content.hpp"
#include "quadtune/workbench/design/gains_export.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;

constexpr char kName[] = "files are what the design gives";
constexpr std::size_t kFileLimit = std::size_t{16} << 20;
/// Two machines solve one problem to about 1e-12.
constexpr double kRounding = 1e-9;

/// With the options of the export, which its files tell.
ExportContent content_of(const fs::path& directory, const Manifest& manifest,
                         const DesignOutcome& outcome) {
  ExportContent content = export_content(outcome);
  const std::string& kind = manifest.kind.name();
  if (kind == "c") content.flight_code = read_flight_code_options(directory);
  if (export_target(kind, kManifestName).is_firmware) {
    const FirmwareKind firmware = firmware_kind(kind, kManifestName);
    const fs::path path = directory / parameter_file_name(firmware);
    content.firmware = written_options(
        firmware, internal::read_text_file(path.string(), kFileLimit), path.string());
  }
  return content;
}

/// A manifest without what differs from one writing to the next: times and versions; hashes, which
/// follow from the files; and estimates of rounding errors, which check_evidence() judges.
std::string comparable(Manifest manifest) {
  manifest.made_at.clear();
  manifest.versions.clear();
  manifest.evidence.residual = manifest.evidence.rcond = std::numeric_limits<double>::quiet_NaN();
  for (ManifestFile& file : manifest.files) file = {file.path, "", 0};
  return manifest_text(manifest);
}

struct Comparison {
  std::string difference;  ///< what differs; empty: nothing but rounding
  double rounding = 0;     ///< the largest difference of two numbers
};

Comparison compare(const fs::path& directory, const Manifest& manifest,
                   const std::vector<FileContent>& files) {
  Comparison result;
  const auto compare_text = [&](const std::string& name, const std::string& found,
                                const std::string& expected) {
    if (found == expected || !result.difference.empty()) return;
    const std::optional<double> apart = numbers_apart(found, expected);
    if (!apart)
      result.difference =
          fmt::format("{}: line {} differs", name, first_other_line(found, expected));
    else if (*apart > kRounding)
      result.difference = fmt::format("{}: line {} differs, numbers by up to {:.3g}", name,
                                      first_other_line(found, expected), *apart);
    else
      result.rounding = std::max(result.rounding, *apart);
  };
  std::size_t listed = 0;
  for (const FileContent& file : files) {
    if (file.name == kManifestName) {
      compare_text(kManifestName, comparable(manifest),
                   comparable(parse_manifest(file.bytes, kManifestName)));
      continue;
    }
    ++listed;
    compare_text(file.name, internal::read_file((directory / file.name).string(), kFileLimit),
                 file.bytes);
  }
  if (result.difference.empty() && listed != manifest.files.size())
    result.difference = fmt::format("the manifest lists {} files, the design gives {}",
                                    manifest.files.size(), listed);
  return result;
}

}  // namespace

VerifyCheck check_design(const fs::path& directory, const Manifest& manifest,
                         const DesignOutcome& outcome) {
  try {
    ExportContent content = content_of(directory, manifest, outcome);
    Comparison found = compare(directory, manifest, export_files(manifest.kind, content));
    if (!found.difference.empty()) {
      // `quadtune export` turns gains into the convention of the program that they are for, which
      // `quadtune design` asks of the design.
      (void)adapt_to_program(content, manifest.kind);
      const Comparison adapted = compare(directory, manifest, export_files(manifest.kind, content));
      if (adapted.difference.empty()) found = adapted;
    }
    if (!found.difference.empty())
      return {kName, false, found.difference + " from what the design file gives"};
    return {kName, true,
            found.rounding > 0
                ? fmt::format("designed again; numbers apart by rounding, {:.2g}", found.rounding)
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
