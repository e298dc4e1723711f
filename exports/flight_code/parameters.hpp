// SPDX-License-Identifier: Apache-2.0
/// The numbers of a flight program as the structure qt_parameters of its C code.
#pragma once

#include <string>
#include <vector>

#include "flight_code/program_settings.hpp"
#include "quadtune/filter.hpp"

namespace quadtune::exports {

/// Formats a number as in C: "0.005f", "1e-09f", "QT_INFINITY"; without f in double precision.
/// @param where  name of the number, for messages
/// @throws InvalidInput  if the number is NaN or overflows `float`
[[nodiscard]] std::string c_number(double x, bool double_precision, const std::string& where);

/// The source parameters.c, with the prefix qt.
/// @param filters  steady Kalman filters of the design, or none
/// @throws InvalidInput  as c_number()
[[nodiscard]] std::string parameters_text(const ProgramSettings& settings,
                                          const std::vector<KalmanFilter>& filters,
                                          bool double_precision);

}  // namespace quadtune::exports
