// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "built_in_exporters.hpp"
#include "export_text.hpp"
#include "json/to_json.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune::exports {
namespace {

namespace fs = std::filesystem;
using internal::Json;

/// The filter's numbers depend on its period, which must be that of the law.
void require_one_period(const StoredLaws& laws, const std::string& origin) {
  if (!laws.estimator || !(laws.estimator->general || laws.estimator->uquad)) return;
  const double dt =
      laws.estimator->general ? laws.estimator->general->dt : laws.estimator->uquad->dt;
  const double of_law = laws.gains ? laws.gains->dt : laws.cascade ? laws.cascade->gains.dt : dt;
  if (std::abs(dt - of_law) > 1e-9 * of_law)
    throw InvalidInput(
        origin + ": estimator.dt_s",
        fmt::format("is {} s, expected {} s, the sample period of the law", dt, of_law));
}

// gains.json, and the JSON output of `lqr` and `pid`, in which "vehicle" is just the name.
StoredLaws laws_of_json(const Json& json, const std::string& origin) {
  StoredLaws laws;
  const int version = format_version(json);
  if (json.contains("gains")) {
    laws.gains = gains_from_json(json["gains"], origin + ": gains", version);
    laws.vehicle = laws.gains->vehicle;
  }
  if (json.contains("cascade"))
    laws.cascade = cascade_from_json(json["cascade"], origin + ": cascade", version);
  // Version 2 always has an estimator; null means true states.
  if (version >= 2) {
    const Json& estimator = internal::member(json, "estimator", origin);
    if (!estimator.is_null())
      laws.estimator = estimator_from_json(estimator, origin + ": estimator");
  } else if (json.contains("estimator")) {
    laws.estimator = estimator_from_json(json["estimator"], origin + ": estimator");
  }
  if (json.contains("parameters"))
    laws.parameters = parameters_from_json(json["parameters"], origin + ": parameters");
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
  return laws_of_json(parse_json(text, origin, kGainsFormat, kGainsVersion), origin);
}

StoredLaws read(const fs::path& directory, const Manifest& /*manifest*/) {
  const fs::path path = directory / kGainsJsonName;
  return laws_of_json_text(export_text(path), path.string());
}

std::optional<StoredLaws> read_plain(const fs::path& path) {
  const bool is_directory = fs::is_directory(path);
  const fs::path file = is_directory ? path / kGainsJsonName : path;
  if (is_directory && !fs::exists(file)) return {};
  const std::string text = export_text(file);
  if (!is_directory && !is_json(file, text)) return {};
  return laws_of_json_text(text, file.string());
}

bool same(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && a == b;
}

std::string weights_difference(const fs::path& directory, const Manifest& manifest) {
  const fs::path path = directory / kGainsJsonName;
  const auto [Q, R] = weights_from_json(
      parse_json(export_text(path), path.string(), kGainsFormat, kGainsVersion), path.string());
  if (!same(Q, manifest.Q)) return std::string(kGainsJsonName) + ": weights.Q differs";
  return same(R, manifest.R) ? "" : std::string(kGainsJsonName) + ": weights.R differs";
}

const Json& filter_list(const Json& json, const std::string& origin) {
  const Json& filters = internal::member(json, "filters", origin);
  if (!filters.is_array())
    throw InvalidInput(origin + ": filters",
                       fmt::format("is {}, expected a list", filters.type_name()));
  return filters;
}

std::vector<KalmanFilter> filters_of_json(const Json& json, const std::string& origin) {
  std::vector<KalmanFilter> filters;
  const Json& list = filter_list(json, origin);
  for (std::size_t i = 0; i < list.size(); ++i)
    filters.push_back(filter_from_json(list[i], fmt::format("{}: filters[{}]", origin, i)));
  return filters;
}

Json json_of(const fs::path& directory) {
  const fs::path path = directory / kGainsJsonName;
  return parse_json(export_text(path), path.string(), kGainsFormat, kGainsVersion);
}

std::vector<FileContent> written_again(const fs::path& directory, const Manifest& manifest,
                                       const Vehicle& vehicle) {
  const std::string origin = (directory / kGainsJsonName).string();
  const Json json = json_of(directory);
  ExportContent content;
  content.vehicle = vehicle;
  content.gains = manifest.gains;
  content.cascade = manifest.cascade;
  content.Q = manifest.Q;
  content.R = manifest.R;
  content.filters = filters_of_json(json, origin);
  content.estimator = laws_of_json(json, origin).estimator;
  return {{kGainsJsonName, gains_json_text(content)}};
}

/// What no other entry of the manifest contains: filters and estimator.
std::vector<NamedMatrix> numbers(const FileContent& file) {
  if (fs::path(file.name).filename() != kGainsJsonName) return {};
  std::vector<NamedMatrix> all;
  const Json json = parse_json(file.bytes, file.name, kGainsFormat, kGainsVersion);
  const auto add = [&](const std::string& name, const Json& part) {
    all.push_back({file.name, name, {}, internal::json_text(part)});
  };
  const Json& filters = filter_list(json, file.name);
  for (std::size_t i = 0; i < filters.size(); ++i) add(fmt::format("filters[{}]", i), filters[i]);
  if (json.contains("estimator") && !json["estimator"].is_null())
    add("estimator", json["estimator"]);
  return all;
}

}  // namespace

Exporter json_exporter() {
  Exporter exporter;
  exporter.target = export_target("json", "exporter");
  exporter.gain_files = {kGainsJsonName};
  exporter.files = [](const ExportContent& content) -> std::vector<FileContent> {
    return {{kGainsJsonName, gains_json_text(content)}};
  };
  exporter.read = read;
  exporter.read_plain = read_plain;
  exporter.weights_difference = weights_difference;
  exporter.numbers = numbers;
  exporter.written_again = written_again;
  exporter.filters = [](const fs::path& directory) {
    return filters_of_json(json_of(directory), (directory / kGainsJsonName).string());
  };
  return exporter;
}

}  // namespace quadtune::exports
