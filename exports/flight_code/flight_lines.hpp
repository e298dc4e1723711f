// SPDX-License-Identifier: Apache-2.0
/// Inputs and outputs of a flight program as lines of text, as in recorded flights and in the input
/// and output of `replay -`. docs/formats.md, "Recorded flights of flight code".
#pragma once

#include <string>

#include "flight_code/flight_program.hpp"
#include "quadtune/simulation/flight_estimator.hpp"

namespace quadtune::exports {

/// Writes numbers in the shortest form that reads back to the same float or double.
class FlightLines {
 public:
  /// @param with_sensors  whether the program has an estimator; otherwise its input is the estimate
  FlightLines(bool with_sensors, bool double_precision)
      : sensors_(with_sensors), double_(double_precision) {}

  [[nodiscard]] std::string start(const ProgramStart& start) const;
  /// The sensor samples, or the true state.
  [[nodiscard]] std::string input(const EstimatorInput& input) const;
  [[nodiscard]] std::string reference(const Reference<double>& reference,
                                      const Eigen::VectorXd& idle) const;
  /// Commands, the 12 states, whether the wrench was limited, whether the estimate is finite.
  [[nodiscard]] std::string output(const ProgramOutput& output) const;

 private:
  class Line;
  [[nodiscard]] Line line() const;

  bool sensors_, double_;
};

}  // namespace quadtune::exports
