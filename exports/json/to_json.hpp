// SPDX-License-Identifier: Apache-2.0
/// JSON representations that gains.json and the manifest share.
#pragma once

#include <string>
#include <utility>

#include "quadtune/design.hpp"
#include "quadtune/exports/firmware_names.hpp"
#include "quadtune/exports/stored_estimator.hpp"
#include "quadtune/filter.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune::exports {

using internal::Json;

/// @param version  of the file; from 2 on with memory, limits and axes
[[nodiscard]] Json gains_to_json(const Gains& gains, int version);

/// @param where    "file: path" for messages
/// @param version  of the file; from 2 on, the file states memory, limits and axes of every law
/// @throws InvalidInput  with the JSON path, the value and what was expected
[[nodiscard]] Gains gains_from_json(const Json& json, const std::string& where, int version);

/// Whether the gains have a part that version 1 of the files cannot represent.
[[nodiscard]] bool has_dynamic_parts(const Gains& gains);

/// Adds "weights" with Q and R, each only if it has entries.
void add_weights(Json& json, const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R);

/// Q and R of "weights"; empty if missing.
/// @throws InvalidInput  with the JSON path, the value and what was expected
[[nodiscard]] std::pair<Eigen::MatrixXd, Eigen::MatrixXd> weights_from_json(
    const Json& json, const std::string& origin);

/// [sensors] and [battery] of a vehicle file, likewise.
[[nodiscard]] Json sensors_to_json(const Sensors& sensors);
[[nodiscard]] Json battery_to_json(const Battery& battery);

/// The tables and keys of a vehicle file. Unknown values and values equal to the default of a
/// missing key are omitted; the environment and the thrust and torque curves are always included.
[[nodiscard]] Json vehicle_to_json(const Vehicle& vehicle);

[[nodiscard]] Json filter_to_json(const KalmanFilter& filter);
/// @param where  "file: path" for messages
/// @throws InvalidInput  with the JSON path, the value and what was expected
[[nodiscard]] KalmanFilter filter_from_json(const Json& json, const std::string& where);

[[nodiscard]] Json cascade_to_json(const CascadeDesign& cascade);

/// A cascade with its gains, the loops in the order of kAllCascadeAxes.
/// @param where    "file: path" for messages
/// @param version  of the file; from 2 on, every part is required
/// @throws InvalidInput  with the JSON path, the value and what was expected
[[nodiscard]] CascadeDesign cascade_from_json(const Json& json, const std::string& where,
                                              int version);

/// An estimator with its own numbers.
[[nodiscard]] Json estimator_to_json(const StoredEstimator& estimator);
/// @throws InvalidInput  with the JSON path, the value and what was expected
[[nodiscard]] StoredEstimator estimator_from_json(const Json& json, const std::string& where);

/// The parameters of an autopilot, by name.
[[nodiscard]] Json parameters_to_json(const StoredParameters& parameters);
/// @throws InvalidInput  with the JSON path, the value and what was expected
[[nodiscard]] StoredParameters parameters_from_json(const Json& json, const std::string& where);

/// "format" of a manifest.
inline constexpr char kManifestFormat[] = "quadtune-export";

/// The member "format" of a JSON text.
/// @throws InvalidInput  "origin:line: …" for a syntax error, or if there is no such member
[[nodiscard]] std::string json_format(const std::string& text, const std::string& origin);

/// The newest version of gains and manifests.
inline constexpr int kGainsVersion = 2;

/// Parses a JSON text whose member "format" must be `format` in a version from 1 to `newest`.
/// @throws InvalidInput  "origin:line: …" for a syntax error or another format
[[nodiscard]] Json parse_json(const std::string& text, const std::string& origin,
                              const std::string& format, int newest = 1);
/// "format_version" of a result of parse_json().
[[nodiscard]] int format_version(const Json& json);

}  // namespace quadtune::exports
