// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flight/flight_difference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"

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

/// A comparison of two variants.
struct Variant {
  const char* what;
  const char* key;  ///< of the option
  std::string FlightOptions::*option;
  std::array<std::string, 2> values;
  std::array<std::string, 2> names;
  const char* because;  ///< why the option must not be set
};

const std::vector<Variant>& variants() {
  static const std::vector<Variant> all = {
      {"integrators",
       "integrator",
       &FlightOptions::integrator,
       {"euler", "tustin"},
       {"euler", "tustin"},
       "euler is compared with tustin"},
      {"flow",
       "flow",
       &FlightOptions::flow,
       {"simplified", "full"},
       {"simplified", "full"},
       "the simplified flow is compared with the full one"},
      {"filter",
       "estimator",
       &FlightOptions::estimator,
       {"mambo", "mambo-raw"},
       {"filtered", "raw"},
       "the estimator mambo, which filters the velocity, is compared with mambo-raw"},
      {"gains",
       "gains",
       &FlightOptions::gains,
       {},
       {},
       "the two gains to compare follow the vehicle"}};
  return all;
}

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

const std::vector<std::string>& compared_things() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> names;
    for (const Variant& variant : variants()) names.emplace_back(variant.what);
    return names;
  }();
  return all;
}

std::string missing_sensor(const std::string& what, bool usual_estimator, const Sensors& sensors) {
  if (what != "flow" && what != "filter") return "";
  if (!sensors.flow) return "optical flow sensor";
  if (!usual_estimator) return "";
  // Both comparisons fly variants of the Mambo's estimator.
  if (!sensors.sonar) return "sonar";
  if (!sensors.accelerometer) return "accelerometer";
  return sensors.gyroscope ? "" : "gyroscope";
}

FlightPair flight_pair(const std::string& what, FlightOptions flight,
                       const std::array<std::string, 2>& gains) {
  const auto at = std::find_if(variants().begin(), variants().end(),
                               [&](const Variant& variant) { return variant.what == what; });
  if (at == variants().end())
    throw InvalidInput("compare", fmt::format("no comparison '{}', expected {}", what,
                                              internal::joined(compared_things(), ", ")));
  if (!(flight.*at->option).empty())
    throw OptionError(at->key, fmt::format("{} does not apply to the comparison '{}', because {}",
                                           at->key, what, at->because));
  if (what == "flow" && flight.estimator.empty()) flight.estimator = "mambo-original";
  if (what == "flow" || what == "integrators") flight = as_the_model_project(flight);
  FlightPair pair{what, at->key, what == "gains" ? gains : at->names, {flight, flight}};
  const std::array<std::string, 2>& values = what == "gains" ? gains : at->values;
  for (std::size_t i = 0; i < 2; ++i) pair.options[i].*at->option = values[i];
  return pair;
}

std::array<PlannedFlight, 2> plan_both(const FlightPair& pair, const std::string& who) {
  std::array<PlannedFlight, 2> plans;
  for (std::size_t i = 0; i < 2; ++i) {
    plans[i] = plan_flight(pair.options[i], who);
    keep_log(plans[i]);
  }
  return plans;
}

ComparedFlights fly_both(const FlightPair& pair, std::array<PlannedFlight, 2> plans,
                         const std::function<bool()>& stop) {
  ComparedFlights compared{pair.what, pair.names, {}, {}};
  for (std::size_t i = 0; i < 2; ++i) compared.flights[i] = fly_planned(std::move(plans[i]), stop);
  compared.difference =
      difference_of(compared.flights[0].result.log, compared.flights[1].result.log);
  return compared;
}

}  // namespace quadtune
