// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/manifest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "export_text.hpp"
#include "json/to_json.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"

namespace quadtune {
namespace {

using internal::Json;
using internal::member;

Json files_to_json(const std::vector<ManifestFile>& files) {
  Json json = Json::array();
  for (const ManifestFile& file : files)
    json.push_back({{"path", file.path}, {"sha256", file.sha256}, {"size", file.size}});
  return json;
}

std::vector<ManifestFile> files_from_json(const Json& json, const std::string& where) {
  if (!json.is_array()) throw InvalidInput(where, "is not an array; expected a list of files");
  std::vector<ManifestFile> files;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::string here = fmt::format("{}[{}]", where, i);
    const Json& size = member(json[i], "size", here);
    if (!size.is_number_unsigned())
      throw InvalidInput(here + ".size",
                         fmt::format("is {}, expected bytes", internal::json_text(size)));
    files.push_back({internal::string_from_json(member(json[i], "path", here), here + ".path"),
                     internal::string_from_json(member(json[i], "sha256", here), here + ".sha256"),
                     size.get<std::size_t>()});
    // A foreign manifest must not cause files outside its directory to be read or removed.
    const std::string& path = files.back().path;
    if (path.empty() || path == "." || path == ".." || path.find('/') != std::string::npos)
      throw InvalidInput(here + ".path",
                         fmt::format("is '{}', expected a file name without a slash", path));
  }
  return files;
}

Json evidence_to_json(const ExportEvidence& evidence) {
  Json json = Json::object();
  if (!evidence.method.empty()) json["method"] = evidence.method;
  if (!evidence.status.empty()) json["status"] = evidence.status;
  if (!std::isnan(evidence.residual))
    json["residual"] = internal::number_to_json(evidence.residual, "residual");
  if (!std::isnan(evidence.rcond))
    json["rcond"] = internal::number_to_json(evidence.rcond, "rcond");
  if (evidence.iterations > 0) json["iterations"] = evidence.iterations;
  if (evidence.poles.size() > 0)
    json["poles"] = internal::poles_to_json(evidence.poles, "evidence.poles");
  return json;
}

ExportEvidence evidence_from_json(const Json& json, const std::string& where) {
  if (!json.is_object())
    throw InvalidInput(where, "is not an object; expected the evidence of a solution");
  ExportEvidence evidence;
  const auto with = [&](const char* key, auto use) {
    if (json.contains(key)) use(json[key], where + "." + key);
  };
  using Where = const std::string&;
  with("method",
       [&](const Json& j, Where w) { evidence.method = internal::string_from_json(j, w); });
  with("status",
       [&](const Json& j, Where w) { evidence.status = internal::string_from_json(j, w); });
  with("residual",
       [&](const Json& j, Where w) { evidence.residual = internal::number_from_json(j, w); });
  with("rcond", [&](const Json& j, Where w) { evidence.rcond = internal::number_from_json(j, w); });
  with("iterations", [&](const Json& j, Where w) {
    const double count = internal::number_from_json(j, w);
    if (!(count >= 0 && count <= 1e9) || count != std::floor(count))
      throw InvalidInput(w, fmt::format("is {}, expected a whole number from 0 to 1e9", count));
    evidence.iterations = static_cast<int>(count);
  });
  with("poles", [&](const Json& j, Where w) { evidence.poles = internal::poles_from_json(j, w); });
  return evidence;
}

Json closed_loop_to_json(const Eigen::VectorXcd& poles, const char* about) {
  Json json;
  json["about"] = about;
  json["spectral_radius"] =
      internal::number_to_json(poles.cwiseAbs().maxCoeff(), "closed_loop.spectral_radius");
  json["poles"] = internal::poles_to_json(poles, "closed_loop.poles");
  return json;
}

Eigen::VectorXcd closed_loop_from_json(const Json& json, const std::string& where) {
  Eigen::VectorXcd poles =
      internal::poles_from_json(member(json, "poles", where), where + ".poles");
  const double radius = internal::number_from_json(member(json, "spectral_radius", where),
                                                   where + ".spectral_radius");
  const double largest = poles.size() > 0 ? poles.cwiseAbs().maxCoeff() : 0;
  if (!(std::abs(radius - largest) <= 1e-12 * std::max(1.0, largest)))
    throw InvalidInput(where + ".spectral_radius",
                       fmt::format("is {}, expected {}, the modulus of the largest of its poles",
                                   radius, largest));
  return poles;
}

}  // namespace

std::string manifest_text(const Manifest& manifest) {
  Json json;
  json["format"] = exports::kManifestFormat;
  const int version = manifest.gains && exports::has_dynamic_parts(*manifest.gains) ? 2 : 1;
  json["format_version"] = version;
  json["kind"] = to_string(manifest.kind);
  json["vehicle"] = manifest.vehicle;
  if (!manifest.made_at.empty()) json["made_at"] = manifest.made_at;
  if (!manifest.forced.empty()) {
    json["forced"] = Json::array();
    for (const std::string& reason : manifest.forced) json["forced"].push_back(Json(reason));
  }
  json["versions"] = Json::object();
  for (const auto& [name, number] : manifest.versions) json["versions"][name] = number;
  json["inputs"] = files_to_json(manifest.inputs);
  json["files"] = files_to_json(manifest.files);
  if (manifest.gains) json["gains"] = exports::gains_to_json(*manifest.gains, version);
  if (manifest.cascade) json["cascade"] = exports::cascade_to_json(*manifest.cascade);
  exports::add_weights(json, manifest.Q, manifest.R);
  json["evidence"] = evidence_to_json(manifest.evidence);
  if (manifest.closed_loop_poles.size() > 0)
    json["closed_loop"] = closed_loop_to_json(
        manifest.closed_loop_poles,
        "the law as written with the sampled vehicle; integrals advance by dt times the error");
  if (manifest.cascade_poles.size() > 0)
    json["cascade_closed_loop"] =
        closed_loop_to_json(manifest.cascade_poles,
                            "the cascade as written with the sampled vehicle and its motors' lag");
  json["numbers"] = Json::array();
  for (const NamedMatrix& number : manifest.numbers)
    json["numbers"].push_back({{"file", number.file},
                               {"name", number.name},
                               {"value", internal::matrix_to_json(number.value, number.name)},
                               {"text", number.text}});
  return internal::readable(json) + "\n";
}

Manifest parse_manifest(const std::string& text, const std::string& origin) {
  const Json json =
      exports::parse_json(text, origin, exports::kManifestFormat, exports::kGainsVersion);
  const auto path = [&](const std::string& key) { return origin + ": " + key; };
  Manifest manifest;
  manifest.kind = export_kind(
      internal::string_from_json(member(json, "kind", origin), path("kind")), path("kind"));
  manifest.vehicle = internal::string_from_json(member(json, "vehicle", origin), path("vehicle"));
  if (json.contains("made_at"))
    manifest.made_at = internal::string_from_json(json["made_at"], path("made_at"));
  if (json.contains("forced")) {
    const Json& forced = json["forced"];
    if (!forced.is_array())
      throw InvalidInput(path("forced"), "is not an array; expected a list of reasons");
    for (std::size_t i = 0; i < forced.size(); ++i)
      manifest.forced.push_back(
          internal::string_from_json(forced[i], path(fmt::format("forced[{}]", i))));
  }
  const Json& versions = member(json, "versions", origin);
  if (!versions.is_object())
    throw InvalidInput(path("versions"), "is not an object; expected a version for each program");
  for (const std::string& name : versions.keys())
    manifest.versions.emplace_back(
        name, internal::string_from_json(versions[name], path("versions." + name)));
  manifest.inputs = files_from_json(member(json, "inputs", origin), path("inputs"));
  manifest.files = files_from_json(member(json, "files", origin), path("files"));
  if (json.contains("gains"))
    manifest.gains =
        exports::gains_from_json(json["gains"], path("gains"), exports::format_version(json));
  if (json.contains("cascade"))
    manifest.cascade = exports::cascade_from_json(json["cascade"], path("cascade"), 1);
  std::tie(manifest.Q, manifest.R) = exports::weights_from_json(json, origin);
  manifest.evidence = evidence_from_json(member(json, "evidence", origin), path("evidence"));
  if (json.contains("closed_loop"))
    manifest.closed_loop_poles = closed_loop_from_json(json["closed_loop"], path("closed_loop"));
  if (json.contains("cascade_closed_loop"))
    manifest.cascade_poles =
        closed_loop_from_json(json["cascade_closed_loop"], path("cascade_closed_loop"));
  const Json& numbers = member(json, "numbers", origin);
  if (!numbers.is_array())
    throw InvalidInput(path("numbers"), "is not an array; expected the numbers of the files");
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::string here = path(fmt::format("numbers[{}]", i));
    manifest.numbers.push_back(
        {internal::string_from_json(member(numbers[i], "file", here), here + ".file"),
         internal::string_from_json(member(numbers[i], "name", here), here + ".name"),
         internal::matrix_from_json(member(numbers[i], "value", here), here + ".value"),
         internal::string_from_json(member(numbers[i], "text", here), here + ".text")});
  }
  return manifest;
}

Manifest read_manifest(const std::filesystem::path& directory) {
  const std::filesystem::path path = directory / kManifestName;
  return parse_manifest(exports::export_text(path), path.string());
}

}  // namespace quadtune
