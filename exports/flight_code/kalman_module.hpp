// SPDX-License-Identifier: Apache-2.0
/// The steady Kalman filters of a design beside its flight program.
#pragma once

#include <string>
#include <vector>

#include "flight_code/source_text.hpp"
#include "quadtune/filter.hpp"

namespace quadtune::exports {

/// Greatest numbers of a design's filters, at least 1 each.
struct KalmanSizes {
  int states = 1;
  int inputs = 1;
  int measurements = 1;
};
[[nodiscard]] KalmanSizes kalman_sizes(const std::vector<KalmanFilter>& filters);

/// Features, sizes and words of source/kalman.h; without filters there is nothing to choose.
/// @throws InvalidInput  for matrices that do not fit each other or are not finite
void choose_kalman(const std::vector<KalmanFilter>& filters, SourceChoices& choices);

/// The first lines of a recorded run of the filters say what is in it; then each filter runs by the
/// library's template, in the precision of the program, through made-up inputs and measurements.
[[nodiscard]] std::string kalman_recording(const std::vector<KalmanFilter>& filters,
                                           bool double_precision);

}  // namespace quadtune::exports
