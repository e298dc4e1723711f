// SPDX-License-Identifier: Apache-2.0
/// The parameter files of the Parrot Mambo's model project: vehicleVars.m, controllerVars.m,
/// estimatorVars.m and sensorsVars.m, which MATLAB or Octave runs in this order without toolboxes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/exports/content.hpp"
#include "quadtune/exports/manifest.hpp"

namespace quadtune {

/// Creates the files; sensorsVars.m only if the sensors of the vehicle are known.
///
/// @param content  vehicle: four equal rotors in X (1 front left and clockwise, 2 front right,
///                 3 back right, 4 back left) with Ct, Cq and radius, commands counted as w²;
///                 gains, if any: convention mambo, inputs wrench;
///                 filters: names "altitude" and "velocity" only
/// @throws InvalidInput  if the model project cannot represent the vehicle, the gains have another
///                       convention, there are other filters, or a number is not finite
[[nodiscard]] std::vector<FileContent> mambo_files(const ExportContent& content);

/// Whether the model project can represent the vehicle, that is mambo_files() accepts it.
[[nodiscard]] bool takes_mambo_files(const Vehicle& vehicle);

/// Reads all definitions of a parameter file, numbers and expressions.
///
/// @throws InvalidInput  as parse_m_numbers()
[[nodiscard]] std::vector<NamedMatrix> parse_m_file(const std::string& text,
                                                    const std::string& origin);

/// Reads the numeric definitions of a parameter file; names defined by expressions are ignored.
///
/// @param text    the lines that quadtune writes: comments, and "Name = value;"
/// @param origin  name of the file in messages
/// @throws InvalidInput  "origin:line: …" if a line has another form, a name is defined twice, rows
///                       of a matrix differ in length, or a number is nan or infinite
[[nodiscard]] std::vector<NamedMatrix> parse_m_numbers(const std::string& text,
                                                       const std::string& origin);

/// Reads the state feedback of a controllerVars.m, with trim and sample time.
/// @throws InvalidInput  as parse_m_numbers(), or if the file has no state feedback
[[nodiscard]] Gains parse_controller_vars(const std::string& text, const std::string& origin);

/// Reads the cascade of a controllerVars.m; no value if the file has none.
/// @throws InvalidInput  as parse_m_numbers(), or if a loop or a gain of the cascade is missing
[[nodiscard]] std::optional<CascadeDesign> parse_cascade_vars(const std::string& text,
                                                              const std::string& origin);

/// Whether the file has a state feedback that parse_controller_vars() reads.
/// @throws InvalidInput  as parse_m_numbers()
[[nodiscard]] bool has_state_feedback(const std::string& text, const std::string& origin);

}  // namespace quadtune
