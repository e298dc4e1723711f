// SPDX-License-Identifier: Apache-2.0
/// The steady Kalman filters of a design, exported with its flight program.
#pragma once

#include <string>
#include <vector>

#include "flight_code/source_text.hpp"
#include "quadtune/filter.hpp"

namespace quadtune::exports {

/// Maximum dimensions over the filters of a design, at least 1 each.
struct KalmanSizes {
  int states = 1;
  int inputs = 1;
  int measurements = 1;
};
[[nodiscard]] KalmanSizes kalman_sizes(const std::vector<KalmanFilter>& filters);

/// Selects the features, sizes and words of source/kalman.h; does nothing without filters.
/// @throws InvalidInput  if the shapes of matrices disagree or an entry is not finite
void choose_kalman(const std::vector<KalmanFilter>& filters, SourceChoices& choices);

/// Records a run of each filter with simulated inputs and measurements, computed by the library's
/// template in the precision of the program. The first lines describe the contents.
[[nodiscard]] std::string kalman_recording(const std::vector<KalmanFilter>& filters,
                                           bool double_precision);

}  // namespace quadtune::exports
