// SPDX-License-Identifier: Apache-2.0
/// How often does a design pass if mass, thrust and wind are uncertain? campaign [FLIGHTS]
/// Exit status: 0 after all flights, 2 and one line for any error.
#include <cstdint>
#include <exception>
#include <iostream>
#include <quadtune/quadtune.hpp>
#include <stdexcept>
#include <string>
#include <vector>

int main(int count, char** words) {
  try {
    // One design in one mission. Law and estimator assume the nominal vehicle.
    const quadtune::Vehicle vehicle = quadtune::load_vehicle("crazyflie");
    quadtune::FlightOptions options;
    options.mission = "step-north";
    const quadtune::PlannedFlight plan = quadtune::plan_flight(options, vehicle, "campaign");

    // What is drawn. The seed and the number of a flight determine its draw.
    using quadtune::DistributionKind;
    quadtune::Campaign campaign;
    campaign.cases = {{"cascade", plan.setup.mission.name, plan.setup}};
    campaign.uncertainty.numbers = {
        {"mass", {DistributionKind::normal, 1, 0.1, 0.7, 1.3}},  // mean, deviation, min, max
        {"thrust", {DistributionKind::uniform, 0.9, 1.1}},
        {"wind_north", {DistributionKind::normal, 0, 1, -3, 3}}};  // [m/s]
    const int flights = count > 1 ? std::stoi(words[1]) : 200;
    if (flights < 1) throw std::runtime_error("FLIGHTS must be positive");
    campaign.flights = static_cast<std::uint32_t>(flights);
    quadtune::validate(campaign, "campaign");

    // On all processors. The result does not depend on their number.
    const std::vector<quadtune::CampaignRecord> records =
        quadtune::fly_draws(campaign, 0, campaign.flights);
    const quadtune::CampaignStatistics statistics =
        quadtune::campaign_statistics(campaign, quadtune::all_draws(campaign), records);
    const quadtune::CaseStatistics& all = statistics.cases[0];
    std::cout << all.passed << " of " << all.flights << " flights passed: " << all.success.value
              << ", 95 % within " << all.success.low << " ... " << all.success.high << '\n';
    // Rank correlations of failures and metrics with what was drawn, the largest first.
    for (std::size_t i = 0; i < all.sensitivities.size() && i < 5; ++i)
      std::cout << all.sensitivities[i].figure << " with " << all.sensitivities[i].quantity << ": "
                << all.sensitivities[i].correlation.value << '\n';
    for (const quadtune::WorstFlight& worst : all.worst)
      std::cout << "flight " << worst.number << ": " << worst.why << '\n';
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "campaign: " << error.what() << '\n';
    return 2;
  }
}
