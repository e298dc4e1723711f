// SPDX-License-Identifier: Apache-2.0
/// The built-in exporters.
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
/// One exporter for each FirmwareKind.
[[nodiscard]] std::vector<Exporter> firmware_exporters();

/// The name of the file with the Mambo's gains.
inline constexpr char kControllerVars[] = "controllerVars.m";
/// The format of gains.json.
inline constexpr char kGainsFormat[] = "quadtune-gains";

}  // namespace quadtune::exports
