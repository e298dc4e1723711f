// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/campaign/campaign.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "quadtune/errors.hpp"
#include "quadtune/internal/in_parallel.hpp"
#include "simulation/campaign/campaign_records.hpp"

namespace quadtune {
namespace {

FlightSetup drawn_setup(const Campaign& campaign, const CampaignCase& of, std::uint32_t flight,
                        const Eigen::VectorXd& drawn) {
  FlightSetup setup = of.setup;
  setup.seed = campaign.seed;
  setup.flight = flight;
  apply(campaign.uncertainty, drawn, setup);
  return setup;
}

}  // namespace

FlightSetup setup_of(const Campaign& campaign, std::uint64_t number) {
  if (number >= campaign.records())
    throw InvalidInput("flight", fmt::format("the number is {}, expected 0 to {}", number,
                                             campaign.records() - 1));
  const auto flight = static_cast<std::uint32_t>(number / campaign.cases.size());
  return drawn_setup(campaign, campaign.cases[number % campaign.cases.size()], flight,
                     draw(campaign.uncertainty, campaign.seed, flight));
}

void validate(const Campaign& campaign, const std::string& where) {
  if (campaign.flights == 0) throw InvalidInput(where, "flights is 0, expected 1 or more");
  if (campaign.cases.empty())
    throw InvalidInput(where, "there is no design with a mission, expected at least one");
  validate(campaign.uncertainty, where);
  for (std::size_t i = 0; i < campaign.cases.size(); ++i) {
    const CampaignCase& of = campaign.cases[i];
    try {
      validate(setup_of(campaign, i));
    } catch (const InvalidInput& error) {
      throw InvalidInput(where, fmt::format("{} in {}: {}", of.design, of.mission, error.what()));
    }
  }
}

Eigen::MatrixXd all_draws(const Campaign& campaign, std::size_t threads) {
  constexpr std::uint32_t kAtOnce = 4096;
  Eigen::MatrixXd drawn(static_cast<Eigen::Index>(campaign.uncertainty.numbers.size()),
                        static_cast<Eigen::Index>(campaign.flights));
  const auto worker = [&](std::size_t part) {
    const std::uint64_t begin = std::uint64_t{part} * kAtOnce;
    const std::uint64_t end = std::min<std::uint64_t>(begin + kAtOnce, campaign.flights);
    for (std::uint64_t flight = begin; flight < end; ++flight)
      drawn.col(static_cast<Eigen::Index>(flight)) =
          draw(campaign.uncertainty, campaign.seed, static_cast<std::uint32_t>(flight));
  };
  internal::in_parallel((std::size_t{campaign.flights} + kAtOnce - 1) / kAtOnce,
                        internal::thread_count(threads), [&] { return worker; }, {});
  return drawn;
}

CampaignRecord record_of(std::uint64_t number, const FlightSetup& setup,
                         const FlightResult& result) {
  Mission judged = setup.mission;
  judged.duration = duration_of(setup);
  CampaignRecord record;
  record.number = number;
  record.end = result.end;
  record.end_time = result.end_time;
  record.metrics = result.metrics;
  record.passed = result.end == FlightEnd::completed && judge(judged, result.metrics).ok;
  if (result.end == FlightEnd::safety_exit && !result.events.empty())
    record.reason = result.events.back().name;
  if (result.end == FlightEnd::diverged) record.reason = "diverged: " + result.culprit;
  record.reason.resize(std::min(record.reason.size(), internal::kReasonLength - 1));
  return record;
}

std::vector<CampaignRecord> fly_draws(const Campaign& campaign, std::uint32_t begin,
                                      std::uint32_t end, std::size_t threads,
                                      const std::function<bool()>& interrupted) {
  // Consecutive flights of one case share a pack.
  const std::size_t cases = campaign.cases.size(), draws = end - begin;
  std::vector<FlightSetup> setups(cases * draws);
  for (std::uint32_t flight = begin; flight < end; ++flight) {
    const Eigen::VectorXd drawn = draw(campaign.uncertainty, campaign.seed, flight);
    for (std::size_t c = 0; c < cases; ++c)
      setups[c * draws + (flight - begin)] =
          drawn_setup(campaign, campaign.cases[c], flight, drawn);
  }
  const std::vector<FlightResult> results = fly_all(setups, threads, interrupted);
  std::vector<CampaignRecord> records(setups.size());
  for (std::size_t c = 0; c < cases; ++c)
    for (std::size_t d = 0; d < draws; ++d)
      records[d * cases + c] = record_of((std::uint64_t{begin} + d) * cases + c,
                                         campaign.cases[c].setup, results[c * draws + d]);
  return records;
}

DrawRange shard_draws(std::uint32_t flights, std::uint32_t shards, std::uint32_t shard) {
  const auto at = [&](std::uint64_t k) {
    return static_cast<std::uint32_t>(std::uint64_t{flights} * k / shards);
  };
  return {at(shard), at(std::uint64_t{shard} + 1)};
}

}  // namespace quadtune
