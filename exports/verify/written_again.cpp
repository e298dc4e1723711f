// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "export_text.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/exporter.hpp"
#include "quadtune/exports/text_difference.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/internal/text_file.hpp"
#include "verify/written_version.hpp"

namespace quadtune {

std::string file_difference(const std::filesystem::path& directory,
                            const std::vector<FileContent>& expected, const std::string& source) {
  for (const FileContent& file : expected) {
    const std::string found = exports::export_bytes(directory / file.name);
    if (const std::size_t line = first_other_line(found, file.bytes); line > 0)
      return fmt::format("{}: line {} differs from what {} give", file.name, line, source);
  }
  return "";
}

std::vector<VerifyCheck> written_again_checks(const std::filesystem::path& directory,
                                              const Vehicle& vehicle) {
  VerifyCheck check{"files computed again from the laws and the vehicle are the same", false, ""};
  try {
    const Manifest manifest = read_manifest(directory);
    const Exporter& exporter = exporter_of(manifest.kind, kManifestName);
    if (!exporter.written_again) return {};
    check.ok = true;
    if (vehicle.name != manifest.vehicle) {
      check.ok = false;
      check.detail =
          fmt::format("the export is for '{}', but the vehicle is '{}'",
                      internal::printable(manifest.vehicle), internal::printable(vehicle.name));
    } else if (!exports::is_of_this_version(manifest)) {
      check.detail = "not compared: another version of quadtune wrote them";
    } else {
      const std::vector<FileContent> files = exporter.written_again(directory, manifest, vehicle);
      check.detail = file_difference(directory, files, "the manifest's laws and the vehicle");
      check.ok = check.detail.empty();
      if (check.ok)
        check.detail =
            fmt::format("{} file{}, byte by byte", files.size(), files.size() == 1 ? "" : "s");
    }
  } catch (const InvalidInput& error) {
    check.ok = false;
    check.detail = error.what();
  } catch (const NoSolution& error) {
    check.ok = false;
    check.detail = error.what();
  } catch (const FileError& error) {
    check.ok = false;
    check.detail = error.what();
  }
  return {check};
}

}  // namespace quadtune
