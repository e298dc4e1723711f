// SPDX-License-Identifier: Apache-2.0
/// The numbers of a flight program as the structure qt_parameters of its C.
#pragma once

#include <string>
#include <vector>

#include "flight_code/program_settings.hpp"
#include "quadtune/filter.hpp"

namespace quadtune::exports {

/// A number as it stands in the C: "0.005f", "1e-09f", "QT_INFINITY"; without f in double
/// precision.
/// @param where  its name, for the message
/// @throws InvalidInput  for NaN, and for a number that overflows `float`
[[nodiscard]] std::string c_number(double x, bool double_precision, const std::string& where);

/// The source parameters.c, with the prefix qt.
/// @param filters  steady Kalman filters of the design, or none
/// @throws InvalidInput  as c_number()
[[nodiscard]] std::string parameters_text(const ProgramSettings& settings,
                                          const std::vector<KalmanFilter>& filters,
                                          bool double_precision);

}  // namespace quadtune::exports
