// SPDX-License-Identifier: Apache-2.0
/// The nouns as JSON, shared by gains.json and the manifest.
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

/// @param where  "file: path" for messages
/// @throws InvalidInput  naming the JSON path, what came and what was expected.
/// @param version  of the file; from 2 on the file says everything of a law that has a memory,
///                 limits or axes of its own
[[nodiscard]] Gains gains_from_json(const Json& json, const std::string& where, int version);

/// Whether the gains have a part that version 1 of the files has no place for.
[[nodiscard]] bool has_dynamic_parts(const Gains& gains);

/// Adds "weights" with Q and R, each only if it has entries.
void add_weights(Json& json, const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R);

/// Q and R of "weights"; empty where there are none.
/// @throws InvalidInput  naming the JSON path, what came and what was expected.
[[nodiscard]] std::pair<Eigen::MatrixXd, Eigen::MatrixXd> weights_from_json(
    const Json& json, const std::string& origin);

/// [sensors] and [battery] of a vehicle file, likewise.
[[nodiscard]] Json sensors_to_json(const Sensors& sensors);
[[nodiscard]] Json battery_to_json(const Battery& battery);

/// The tables and keys of a vehicle file. What is not known, and what a file without the key would
/// mean, is left out; the environment and the curves of thrust and torque always stand.
[[nodiscard]] Json vehicle_to_json(const Vehicle& vehicle);

[[nodiscard]] Json filter_to_json(const KalmanFilter& filter);
/// @param where  "file: path" for messages
/// @throws InvalidInput  naming the JSON path, what came and what was expected.
[[nodiscard]] KalmanFilter filter_from_json(const Json& json, const std::string& where);

[[nodiscard]] Json cascade_to_json(const CascadeDesign& cascade);

/// A cascade with its gains, the loops in the order of kAllCascadeAxes.
/// @param where    "file: path" for messages
/// @param version  of the file; from 2 on every part must be there
/// @throws InvalidInput  naming the JSON path, what came and what was expected.
[[nodiscard]] CascadeDesign cascade_from_json(const Json& json, const std::string& where,
                                              int version);

/// An estimator with the numbers that are its own.
[[nodiscard]] Json estimator_to_json(const StoredEstimator& estimator);
/// @throws InvalidInput  naming the JSON path, what came and what was expected.
[[nodiscard]] StoredEstimator estimator_from_json(const Json& json, const std::string& where);

/// The parameters of an autopilot, by name.
[[nodiscard]] Json parameters_to_json(const StoredParameters& parameters);
/// @throws InvalidInput  naming the JSON path, what came and what was expected.
[[nodiscard]] StoredParameters parameters_from_json(const Json& json, const std::string& where);

/// "format" of a manifest.
inline constexpr char kManifestFormat[] = "quadtune-export";

/// What a JSON text calls its format.
/// @throws InvalidInput  "origin:line: …" for bad syntax, or where it says nothing.
[[nodiscard]] std::string json_format(const std::string& text, const std::string& origin);

/// The newest version of gains and manifests.
inline constexpr int kGainsVersion = 2;

/// Parses a JSON text whose member "format" must be `format` in a version from 1 to `newest`.
/// @throws InvalidInput  "origin:line: …" for bad syntax or another format.
[[nodiscard]] Json parse_json(const std::string& text, const std::string& origin,
                              const std::string& format, int newest = 1);
/// "format_version" of what parse_json() returned.
[[nodiscard]] int format_version(const Json& json);

}  // namespace quadtune::exports
