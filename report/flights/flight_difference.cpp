// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flight/flight_difference.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/internal/json.hpp"
#include "report/flights/flights.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

Json flight_json(const std::string& name, const FlownFlight& flight) {
  const EstimateError error = estimate_error(flight.result.log);
  Json json = {{"name", name}};
  json.update(to_json(flight));
  json["estimate_error_m"] = {
      {"mean_absolute", error.mean_absolute}, {"max", error.max}, {"final", error.final}};
  return json;
}

}  // namespace

Json to_json(const ComparedFlights& compared) {
  const FlightDifference& difference = compared.difference;
  Json json = {{"what", compared.what}};
  json["difference"] = {{"duration_s", difference.duration},
                        {"mean_squared", Json::object()},
                        {"max", Json::object()}};
  for (const ColumnDifference& column : difference.columns) {
    json["difference"]["mean_squared"][column.name] = column.mean_squared;
    json["difference"]["max"][column.name] = column.max;
  }
  json["a"] = flight_json(compared.names[0], compared.flights[0]);
  json["b"] = flight_json(compared.names[1], compared.flights[1]);
  return json;
}

std::string to_text(const ComparedFlights& compared) {
  const auto& [what, names, flights, difference] = compared;
  const FlightSetup& setup = flights[0].plan.setup;
  std::string text =
      fmt::format("{} flies {} twice, compared by {}: a {}, b {}\n  a  {}\n", setup.vehicle.name,
                  setup.mission.name, what, names[0], names[1], circumstances(flights[0].plan));
  text += fmt::format("  b  {}\n\n", circumstances(flights[1].plan));
  Cells columns = {{"", "mean squared", "greatest", "at"}};
  const bool carried = std::holds_alternative<Carried>(setup.mission.kind);
  for (const ColumnDifference& column : difference.columns) {
    // A vehicle that is carried has no command.
    if (carried && column.max == 0) continue;
    columns.push_back({"  " + column.name, figure(column.mean_squared, ".3g"),
                       figure(column.max, ".3g"), figure(column.max_at, ".4g") + " s",
                       column.unit});
  }
  text += fmt::format("difference over {:.4g} s\n{}\n\n", difference.duration,
                      aligned(columns, "<>>><"));
  const auto verdict = [](const FlownFlight& flight) { return flight.passed ? "pass" : "fail"; };
  Cells metrics = {{"", "a", "b"}, {"  verdict", verdict(flights[0]), verdict(flights[1])}};
  const auto row = [&](const std::string& label, double a, double b) {
    metrics.push_back({"  " + label, reached(a, ".4g"), reached(b, ".4g")});
  };
  for (std::size_t i = 0; i < kMetrics; ++i) {
    const auto metric = static_cast<Metric>(i);
    const double a = flights[0].result.metrics[metric], b = flights[1].result.metrics[metric];
    if (std::isnan(a) && std::isnan(b)) continue;
    const std::string& unit = unit_of(metric);
    row(label_of(metric) + (unit == "1" ? "" : " [" + unit + "]"), a, b);
  }
  const EstimateError a = estimate_error(flights[0].result.log);
  const EstimateError b = estimate_error(flights[1].result.log);
  row("horizontal estimate error, mean [m]", a.mean_absolute, b.mean_absolute);
  row("horizontal estimate error, at the end [m]", a.final, b.final);
  text += aligned(metrics) + "\n";
  for (std::size_t i = 0; i < 2; ++i) {
    const std::vector<std::string> why = reasons(flights[i]);
    for (std::size_t k = 0; k < why.size(); ++k)
      text += fmt::format("{}{}: {}\n", i == 0 && k == 0 ? "\n" : "", i == 0 ? "a" : "b", why[k]);
  }
  return text;
}

}  // namespace quadtune::report
