// SPDX-License-Identifier: Apache-2.0
/// The exporters that come with quadtune.
#pragma once

#include <string>
#include <vector>

#include "quadtune/exports/exporter.hpp"

namespace quadtune::exports {

[[nodiscard]] Exporter uquad_exporter();
[[nodiscard]] Exporter mambo_exporter();
[[nodiscard]] Exporter json_exporter();
[[nodiscard]] Exporter mat_exporter();
[[nodiscard]] Exporter flight_code_exporter();
/// Those of firmware_kind().
[[nodiscard]] std::vector<Exporter> firmware_exporters();

/// The file of the Mambo's gains.
inline constexpr char kControllerVars[] = "controllerVars.m";
/// The format of gains.json.
inline constexpr char kGainsFormat[] = "quadtune-gains";

}  // namespace quadtune::exports
