// SPDX-License-Identifier: Apache-2.0
/// Many flights of the same designs and missions, each with its own draw of what is uncertain.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "quadtune/simulation/flight.hpp"
#include "quadtune/simulation/uncertainty.hpp"

namespace quadtune {

/// A design in a mission.
struct CampaignCase {
  std::string design;
  std::string mission;
  FlightSetup setup;  ///< without anything drawn; seed and flight are set for each
};

/// What is flown: each of `flights` draws in every case, with the same draw and the same noise, so
/// that designs are compared on the same winds (common random numbers).
///
/// Records are numbered draw by draw: number = draw · cases + case.
struct Campaign {
  std::vector<CampaignCase> cases;  ///< at least one; all of the same vehicle
  Uncertainty uncertainty;
  std::uint32_t flights = 0;  ///< draws, ≥ 1
  std::uint64_t seed = 1;

  [[nodiscard]] std::uint64_t records() const {
    return std::uint64_t{flights} * static_cast<std::uint64_t>(cases.size());
  }
};

/// The flight of a number, as it is flown.
/// @throws InvalidInput  for a number that the campaign does not have, or as apply()
[[nodiscard]] FlightSetup setup_of(const Campaign& campaign, std::uint64_t number);

/// Checks that the campaign can be flown, its first flight in every case.
/// @throws InvalidInput  naming the case and what is wrong
void validate(const Campaign& campaign, const std::string& where);

/// What is drawn, of every flight: a column each, as draw() gives it.
/// @param threads  as fly_all()
/// @return         (quantities × flights)
[[nodiscard]] Eigen::MatrixXd all_draws(const Campaign& campaign, std::size_t threads = 0);

/// What is kept of a flight.
struct CampaignRecord {
  std::uint64_t number = 0;
  FlightEnd end = FlightEnd::completed;
  bool passed = false;  ///< completed, and every limit of the mission kept
  double end_time = 0;  ///< [s]
  std::string reason;   ///< what ended it, e.g. "tilt"; at most 47 bytes; empty where it completed
  MetricValues metrics;
};

/// What is kept of a result.
/// @param setup  that was flown: its mission is what the flight is held against
[[nodiscard]] CampaignRecord record_of(std::uint64_t number, const FlightSetup& setup,
                                       const FlightResult& result);

/// Flies draws `begin` to `end` - 1 in every case.
/// @param begin, end   begin ≤ end ≤ `campaign.flights`
/// @param threads      as fly_all()
/// @param interrupted  likewise
/// @return             in the order of their numbers; the same bytes for any threads, and for any
///                     way in which draws are shared among calls
/// @throws InvalidInput, Interrupted  as fly_all()
[[nodiscard]] std::vector<CampaignRecord> fly_draws(const Campaign& campaign, std::uint32_t begin,
                                                    std::uint32_t end, std::size_t threads = 0,
                                                    const std::function<bool()>& interrupted = {});

/// Draws `begin` to `end` - 1.
struct DrawRange {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};
/// The draws of a shard: as many in each, or one more.
/// @param shards  ≥ 1
/// @param shard   from 0, less than `shards`
[[nodiscard]] DrawRange shard_draws(std::uint32_t flights, std::uint32_t shards,
                                    std::uint32_t shard);

}  // namespace quadtune
