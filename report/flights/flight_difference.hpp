// SPDX-License-Identifier: Apache-2.0
/// Where two flights of one mission part.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "report/flights/flight_text.hpp"

namespace quadtune::report {

/// One recorded quantity in both flights.
struct ColumnDifference {
  std::string column;  ///< of the log
  std::string name;    ///< as people and JSON call it: "T", "tau_x", "px" …
  std::string unit;
  double mean_squared = 0;  ///< [unit²]
  double max = 0;           ///< greatest size [unit]
  double max_at = 0;        ///< when [s]
};

/// Over the rows that both flights have.
struct FlightDifference {
  double duration = 0;  ///< [s]
  std::vector<ColumnDifference> columns;
};

[[nodiscard]] FlightDifference difference_of(const LogTable& a, const LogTable& b);

/// How well a flight believed to be where it was, horizontally.
struct EstimateError {
  double mean_absolute = 0;  ///< of the distance [m]
  double max = 0;            ///< [m]
  double final = 0;          ///< [m]
};
[[nodiscard]] EstimateError estimate_error(const LogTable& log);

[[nodiscard]] internal::Json to_json(const std::string& what,
                                     const std::array<std::string, 2>& names,
                                     const std::array<FlownFlight, 2>& flights,
                                     const FlightDifference& difference);
[[nodiscard]] std::string to_text(const std::string& what, const std::array<std::string, 2>& names,
                                  const std::array<FlownFlight, 2>& flights,
                                  const FlightDifference& difference);

}  // namespace quadtune::report
