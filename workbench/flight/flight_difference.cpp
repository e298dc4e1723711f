// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flight/flight_difference.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace quadtune {
namespace {

constexpr const char* kCompared[][2] = {{"command.T", "T"},
                                        {"command.tau_x", "tau_x"},
                                        {"command.tau_y", "tau_y"},
                                        {"command.tau_z", "tau_z"},
                                        {"x.px", "px"},
                                        {"x.py", "py"},
                                        {"x.pz", "pz"},
                                        {"x.roll", "roll"},
                                        {"x.pitch", "pitch"},
                                        {"x.yaw", "yaw"},
                                        {"estimate.px", "believed_px"},
                                        {"estimate.py", "believed_py"},
                                        {"estimate.pz", "believed_pz"}};

}  // namespace

FlightDifference difference_of(const LogTable& a, const LogTable& b) {
  FlightDifference difference;
  const std::size_t rows = std::min(a.rows(), b.rows());
  const std::vector<double>& t = a.columns.front().values;
  if (rows > 0) difference.duration = t[rows - 1];
  for (const auto& [column, name] : kCompared) {
    const LogColumn* first = a.find(column);
    const LogColumn* second = b.find(column);
    if (first == nullptr || second == nullptr) continue;
    ColumnDifference one{column, name, first->unit};
    for (std::size_t k = 0; k < rows; ++k) {
      const double d = std::abs(first->values[k] - second->values[k]);
      one.mean_squared += d * d / static_cast<double>(rows);
      if (d <= one.max) continue;
      one.max = d;
      one.max_at = t[k];
    }
    difference.columns.push_back(one);
  }
  return difference;
}

EstimateError estimate_error(const LogTable& log) {
  EstimateError error;
  const auto& px = log.find("x.px")->values;
  const auto& py = log.find("x.py")->values;
  const auto& ex = log.find("estimate.px")->values;
  const auto& ey = log.find("estimate.py")->values;
  for (std::size_t k = 0; k < px.size(); ++k) {
    error.final = std::hypot(ex[k] - px[k], ey[k] - py[k]);
    error.mean_absolute += error.final / static_cast<double>(px.size());
    error.max = std::max(error.max, error.final);
  }
  return error;
}

std::array<PlannedFlight, 2> plan_both(const std::array<FlightOptions, 2>& options,
                                       const std::string& who) {
  std::array<PlannedFlight, 2> plans;
  for (std::size_t i = 0; i < 2; ++i) {
    plans[i] = plan_flight(options[i], who);
    keep_log(plans[i]);
  }
  return plans;
}

ComparedFlights fly_both(std::string what, std::array<std::string, 2> names,
                         std::array<PlannedFlight, 2> plans, const std::function<bool()>& stop) {
  ComparedFlights compared{std::move(what), std::move(names), {}, {}};
  for (std::size_t i = 0; i < 2; ++i) compared.flights[i] = fly_planned(std::move(plans[i]), stop);
  compared.difference =
      difference_of(compared.flights[0].result.log, compared.flights[1].result.log);
  return compared;
}

}  // namespace quadtune
