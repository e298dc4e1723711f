// SPDX-License-Identifier: Apache-2.0
/// The parameter files of the Parrot Mambo's model project: vehicleVars.m, controllerVars.m,
/// estimatorVars.m and sensorsVars.m, run in this order by MATLAB or Octave without any toolbox.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/exports/content.hpp"
#include "quadtune/exports/manifest.hpp"

namespace quadtune {

/// The files; sensorsVars.m where the sensors of the vehicle are known.
///
/// @param content  vehicle: four equal rotors in X (1 front left and clockwise, 2 front right,
///                 3 back right, 4 back left) with Ct, Cq and radius, commands counted as w²;
///                 gains, if any: convention mambo, inputs wrench;
///                 filters: names "altitude" and "velocity" only
/// @throws InvalidInput  for a vehicle that the model project cannot express, gains in another
///                       convention, other filters, and numbers that are not finite.
[[nodiscard]] std::vector<FileContent> mambo_files(const ExportContent& content);

/// Whether the model project can express the vehicle, so that mambo_files() takes it.
[[nodiscard]] bool takes_mambo_files(const Vehicle& vehicle);

/// All that a parameter file defines, numbers and expressions.
///
/// @throws InvalidInput  as parse_m_numbers.
[[nodiscard]] std::vector<NamedMatrix> parse_m_file(const std::string& text,
                                                    const std::string& origin);

/// What a parameter file defines by plain numbers; names defined by expressions are passed over.
///
/// @param text    the lines that quadtune writes: comments, and "Name = value;"
/// @param origin  the file's name in messages
/// @throws InvalidInput  "origin:line: …" for a line of another form, a name given twice, a matrix
///                       with rows of different lengths, nan or infinity.
[[nodiscard]] std::vector<NamedMatrix> parse_m_numbers(const std::string& text,
                                                       const std::string& origin);

/// The state feedback of a controllerVars.m, with trim and sample time.
/// @throws InvalidInput  as parse_m_numbers, and if the file has no state feedback.
[[nodiscard]] Gains parse_controller_vars(const std::string& text, const std::string& origin);

/// The cascade of a controllerVars.m; none if the file has none.
/// @throws InvalidInput  as parse_m_numbers, and for a cascade that lacks a loop or a gain.
[[nodiscard]] std::optional<CascadeDesign> parse_cascade_vars(const std::string& text,
                                                              const std::string& origin);

/// Whether the file has a state feedback that parse_controller_vars() reads.
/// @throws InvalidInput  as parse_m_numbers.
[[nodiscard]] bool has_state_feedback(const std::string& text, const std::string& origin);

}  // namespace quadtune
