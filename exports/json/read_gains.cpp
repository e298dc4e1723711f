// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/read_gains.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "export_text.hpp"
#include "json/to_json.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/mambo.hpp"
#include "quadtune/exports/uquad.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;

constexpr char kControllerVars[] = "controllerVars.m";

constexpr char kGainsFormat[] = "quadtune-gains";

using internal::Json;

/// The filter's numbers are of its period, which is that of the law.
void require_one_period(const StoredLaws& laws, const std::string& origin) {
  if (!laws.estimator || !laws.estimator->general) return;
  const double dt = laws.estimator->general->dt;
  const double of_law = laws.gains ? laws.gains->dt : laws.cascade ? laws.cascade->gains.dt : dt;
  if (std::abs(dt - of_law) > 1e-9 * of_law)
    throw InvalidInput(
        origin + ": estimator.dt_s",
        fmt::format("is {} s, expected {} s, the sample period of the law", dt, of_law));
}

// gains.json, and what `lqr` and `pid` print as JSON: there "vehicle" is the name alone.
StoredLaws laws_of_json(const Json& json, const std::string& origin) {
  StoredLaws laws;
  const int version = exports::format_version(json);
  if (json.contains("gains")) {
    laws.gains = exports::gains_from_json(json["gains"], origin + ": gains", version);
    laws.vehicle = laws.gains->vehicle;
  }
  if (json.contains("cascade"))
    laws.cascade = exports::cascade_from_json(json["cascade"], origin + ": cascade", version);
  // From version 2 on it is there, null for true states.
  if (version >= 2) {
    const Json& estimator = internal::member(json, "estimator", origin);
    if (!estimator.is_null())
      laws.estimator = exports::estimator_from_json(estimator, origin + ": estimator");
  } else if (json.contains("estimator")) {
    laws.estimator = exports::estimator_from_json(json["estimator"], origin + ": estimator");
  }
  require_one_period(laws, origin);
  if (laws.vehicle.empty() && json.contains("vehicle")) {
    const Json& vehicle = json["vehicle"];
    const std::string where = origin + ": vehicle";
    laws.vehicle =
        vehicle.is_object()
            ? internal::string_from_json(internal::member(vehicle, "name", where), where + ".name")
            : internal::string_from_json(vehicle, where);
  }
  return laws;
}

StoredLaws laws_of_json_text(const std::string& text, const std::string& origin) {
  return laws_of_json(exports::parse_json(text, origin, kGainsFormat, exports::kGainsVersion),
                      origin);
}

StoredLaws laws_of_m_text(const std::string& text, const std::string& origin) {
  StoredLaws laws;
  laws.cascade = parse_cascade_vars(text, origin);
  if (has_state_feedback(text, origin)) laws.gains = parse_controller_vars(text, origin);
  return laws;
}

StoredLaws laws_of_manifest(const Manifest& manifest) {
  return {manifest.vehicle, manifest.gains, manifest.cascade};
}

StoredLaws read_json(const fs::path& path) {
  return laws_of_json_text(exports::export_text(path), path.string());
}

StoredLaws read_m(const fs::path& path) {
  return laws_of_m_text(exports::export_text(path), path.string());
}

StoredLaws read_uquad(const fs::path& path) { return {"", read_uquad_gains(path), {}}; }

// A uquad directory may hold other builds' files that the manifest does not list.
fs::path listed_uquad_file(const fs::path& directory, const Manifest& manifest) {
  for (const UquadFileSet& set : uquad_file_sets())
    for (const ManifestFile& file : manifest.files)
      if (file.path == set.proportional) return directory / file.path;
  throw InvalidInput((directory / kManifestName).string(), "lists no gain file of uquad");
}

StoredLaws read_by_manifest(const fs::path& directory) {
  const Manifest manifest = read_manifest(directory);
  StoredLaws laws;
  switch (manifest.kind) {
    case ExportKind::json:
      return read_json(directory / kGainsJsonName);
    case ExportKind::mambo:
      laws = read_m(directory / kControllerVars);
      break;
    case ExportKind::uquad:
      laws = read_uquad(listed_uquad_file(directory, manifest));
      break;
  }
  laws.vehicle = manifest.vehicle;
  if (!laws.gains) return laws;
  Gains& gains = *laws.gains;
  gains.vehicle = manifest.vehicle;
  // What the files cannot say; the columns are compared by name, so the order may differ.
  if (manifest.kind == ExportKind::uquad && manifest.gains) {
    gains.dt = manifest.gains->dt;
    gains.sign_law = manifest.gains->sign_law;
    gains.u0 = manifest.gains->u0;
    for (std::size_t i = 0; i < gains.states.size(); ++i)
      for (std::size_t j = 0; j < manifest.gains->states.size(); ++j)
        if (gains.states[i].name == manifest.gains->states[j].name)
          gains.x0(static_cast<Eigen::Index>(i)) = manifest.gains->x0(static_cast<Eigen::Index>(j));
  }
  return laws;
}

StoredLaws read_directory(const fs::path& path) {
  if (fs::exists(path / kManifestName)) return read_by_manifest(path);
  if (fs::exists(path / kGainsJsonName)) return read_json(path / kGainsJsonName);
  if (fs::exists(path / kControllerVars)) return read_m(path / kControllerVars);
  return read_uquad(path);
}

bool is_uquad_name(const std::string& name) {
  const std::vector<UquadFileSet>& sets = uquad_file_sets();
  return std::any_of(sets.begin(), sets.end(), [&](const UquadFileSet& set) {
    return name == set.proportional || (!set.integral.empty() && name == set.integral);
  });
}

// A file by what is in it, so that any name may be given to it; only uquad's have no mark but
// theirs.
StoredLaws read_file(const fs::path& path) {
  if (is_uquad_name(path.filename().string())) return read_uquad(path);
  const std::string origin = path.string();
  const std::string text = exports::export_text(path);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const char mark = first == std::string::npos ? '\0' : text[first];
  if (mark == '{' || path.extension() == ".json") {
    if (exports::json_format(text, origin) == exports::kManifestFormat) {
      // Its folder holds more than it does, such as the estimator.
      if (path.filename() == kManifestName &&
          parse_manifest(text, origin).kind == ExportKind::json &&
          fs::exists(path.parent_path() / kGainsJsonName))
        return read_json(path.parent_path() / kGainsJsonName);
      return laws_of_manifest(parse_manifest(text, origin));
    }
    return laws_of_json_text(text, origin);
  }
  if (mark == '%' || path.extension() == ".m") return laws_of_m_text(text, origin);
  if (std::isdigit(static_cast<unsigned char>(mark)) != 0 || mark == '-' || mark == '+')
    return read_uquad(path);  // which tells the names that it takes
  throw InvalidInput(
      origin, fmt::format("is no file of gains, expected gains.json, manifest.json, {}, one of "
                          "uquad ({}, …), or what `quadtune lqr` or `pid` writes as JSON: with "
                          "--json, or into a name that ends in .json",
                          kControllerVars, uquad_file_sets().front().proportional));
}

}  // namespace

StoredLaws read_laws(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status))
    throw FileError(path.string(), error ? error.message() : std::strerror(ENOENT));
  return fs::is_directory(status) ? read_directory(path) : read_file(path);
}

Gains read_gains(const fs::path& path) {
  StoredLaws laws = read_laws(path);
  if (!laws.gains)
    throw InvalidInput(path.string(),
                       laws.cascade
                           ? "holds a PID cascade and no state feedback, expected a state feedback"
                           : "holds no control law, expected a state feedback");
  return std::move(*laws.gains);
}

}  // namespace quadtune
