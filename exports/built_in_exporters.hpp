// SPDX-License-Identifier: Apache-2.0
/// The exporters that come with quadtune.
#pragma once

#include <string>

#include "quadtune/exports/exporter.hpp"

namespace quadtune::exports {

[[nodiscard]] Exporter uquad_exporter();
[[nodiscard]] Exporter mambo_exporter();
[[nodiscard]] Exporter json_exporter();

/// The file of the Mambo's gains.
inline constexpr char kControllerVars[] = "controllerVars.m";
/// The format of gains.json.
inline constexpr char kGainsFormat[] = "quadtune-gains";

/// Laws from the text of gains.json, and of what `lqr` and `pid` print as JSON.
/// @throws InvalidInput
[[nodiscard]] StoredLaws laws_of_json_text(const std::string& text, const std::string& origin);

/// Laws from the text of controllerVars.m.
/// @throws InvalidInput
[[nodiscard]] StoredLaws laws_of_m_text(const std::string& text, const std::string& origin);

}  // namespace quadtune::exports
