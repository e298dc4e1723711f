// SPDX-License-Identifier: Apache-2.0
#include "verify/manifest_vehicle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <optional>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/exports/file_set.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::internal {
namespace {

namespace fs = std::filesystem;

/// The vehicle in a file, if the file has the bytes of the input and describes that vehicle.
std::optional<Vehicle> vehicle_in(const fs::path& path, const ManifestFile& input,
                                  const std::string& name) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored) || fs::file_size(path, ignored) != input.size)
    return std::nullopt;
  try {
    if (sha256(read_file(path.string(), input.size)) != input.sha256) return std::nullopt;
    Vehicle vehicle = load_vehicle(path.string());
    if (vehicle.name != name) return std::nullopt;
    return vehicle;
  } catch (const std::exception&) {
    return std::nullopt;  // another input, such as the design, or an unreadable file
  }
}

/// A file of the vehicle with another hash than that in the manifest; empty if there is none.
std::string changed_file(const std::string& directory, const Manifest& manifest) {
  for (const fs::path& folder : folders_of_inputs(directory))
    for (const ManifestFile& input : manifest.inputs) {
      const fs::path path = folder / input.path;
      std::error_code ignored;
      if (path.extension() != ".toml" || !fs::is_regular_file(path, ignored)) continue;
      try {
        if (load_vehicle(path.string()).name == manifest.vehicle)
          return path.lexically_proximate(fs::current_path()).string();
      } catch (const std::exception&) {
        continue;  // another input, such as the design, or an unreadable file
      }
    }
  return "";
}

}  // namespace

std::vector<fs::path> folders_of_inputs(const std::string& directory) {
  const fs::path parent = fs::absolute(directory).lexically_normal().parent_path();
  const fs::path here = fs::current_path();
  return {parent, parent.parent_path(), here, here / "designs", here / "vehicles"};
}

Vehicle vehicle_of_manifest(const std::string& directory, const Manifest& manifest,
                            const std::string& name) {
  if (!name.empty()) {
    Vehicle given = load_vehicle(name);
    if (given.name != manifest.vehicle && !manifest.vehicle.empty())
      throw OptionError("vehicle",
                        fmt::format("vehicle is '{}', expected '{}', the vehicle of the manifest",
                                    printable(given.name), printable(manifest.vehicle)));
    return given;
  }
  const std::vector<std::string> built_in = built_in_vehicles();
  if (std::find(built_in.begin(), built_in.end(), manifest.vehicle) != built_in.end())
    return load_vehicle(manifest.vehicle);
  for (const fs::path& folder : folders_of_inputs(directory))
    for (const ManifestFile& input : manifest.inputs)
      if (std::optional<Vehicle> found = vehicle_in(folder / input.path, input, manifest.vehicle))
        return std::move(*found);
  const std::string changed = changed_file(directory, manifest);
  throw OptionError(
      "vehicle",
      fmt::format("vehicle is missing, expected the file of '{}', the vehicle of the manifest, "
                  "which is not built in; {}",
                  printable(manifest.vehicle),
                  changed.empty() ? "no file nearby has the hash in the manifest"
                                  : printable(changed, 200) + " was changed after the export"));
}

}  // namespace quadtune::internal
