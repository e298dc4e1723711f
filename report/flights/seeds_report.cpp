// SPDX-License-Identifier: Apache-2.0
#include "report/flights/seeds_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/internal/json.hpp"
#include "report/flights/flight_text.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

std::string seeds_table(const std::vector<SeedVerdict>& seeds) {
  Cells cells = {{"seed", "verdict", "rms", "greatest", "end", "settled", "yaw", "tilt", "limited"},
                 {"", "", "[m]", "[m]", "[m]", "[s]", "[rad]", "[rad]", "motor [s]"}};
  for (const SeedVerdict& seed : seeds) {
    cells.push_back({fmt::format("{}", seed.seed), seed.passed ? "pass" : "FAIL"});
    for (const Metric metric :
         {Metric::tracking_rms, Metric::tracking_max, Metric::final_distance, Metric::settling_time,
          Metric::yaw_max, Metric::tilt_max, Metric::saturation_time})
      cells.back().push_back(reached(seed.metrics[metric], ".3g"));
  }
  return aligned(cells, "><>") + "\n";
}

}  // namespace

internal::Json to_json(const std::vector<FlownFlight>& flights,
                       const std::optional<Diagnosis>& diagnosis) {
  internal::Json json = internal::Json::array();
  bool failed = false;
  for (const FlownFlight& flight : flights) {
    const bool first_failed = !flight.passed && !failed;
    json.push_back(to_json(flight, first_failed ? diagnosis : std::nullopt));
    failed = failed || first_failed;
  }
  return json;
}

std::string to_text(const std::vector<FlownFlight>& flights,
                    const std::optional<Diagnosis>& diagnosis) {
  const FlownFlight worst = worst_of(flights);
  const auto passed = std::count_if(flights.begin(), flights.end(),
                                    [](const FlownFlight& flight) { return flight.passed; });
  return fmt::format("verdict of {} seeds: {}, {} passed\n", flights.size(),
                     worst.passed ? "pass" : "fail", passed) +
         seeds_table(worst.seeds) +
         fmt::format("\n{}, seed {}\n", worst.passed ? "the first" : "the first that failed",
                     worst.plan.setup.seed) +
         to_text(worst, diagnosis);
}

}  // namespace quadtune::report
