// SPDX-License-Identifier: Apache-2.0
/// Many flights of the same designs and missions, each with its own draw of the uncertain
/// parameters.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "quadtune/simulation/campaign/uncertainty.hpp"
#include "quadtune/simulation/flight.hpp"

namespace quadtune {

/// One design in one mission.
struct CampaignCase {
  std::string design;   ///< name of the design
  std::string mission;  ///< name of the mission
  FlightSetup setup;  ///< without drawn parameters; seed and flight number are set for each flight
};

/// A campaign flies each of `flights` draws in every case. All cases of a draw share the same
/// parameters and noise, so that designs are compared under identical conditions (common random
/// numbers).
///
/// Records are numbered draw by draw: number = draw · cases + case.
struct Campaign {
  std::vector<CampaignCase> cases;  ///< at least one; all with the same vehicle
  Uncertainty uncertainty;          ///< of the drawn parameters
  std::uint32_t flights = 0;        ///< number of draws, ≥ 1
  std::uint64_t seed = 1;           ///< of all draws

  /// Number of flights: draws times cases.
  [[nodiscard]] std::uint64_t records() const {
    return std::uint64_t{flights} * static_cast<std::uint64_t>(cases.size());
  }
};

/// Setup of the flight with this number, drawn parameters included.
/// @throws InvalidInput  if the campaign has no such flight, or as apply()
[[nodiscard]] FlightSetup setup_of(const Campaign& campaign, std::uint64_t number);

/// Checks the first flight of every case, to find out whether the campaign can be flown.
/// @throws InvalidInput  naming the case and the mistake
void validate(const Campaign& campaign, const std::string& where);

/// Drawn parameters of all draws, one column per draw as returned by draw().
/// @param campaign  accepted by fly_draws()
/// @param threads   as fly_all()
/// @return          (quantities × draws)
[[nodiscard]] Eigen::MatrixXd all_draws(const Campaign& campaign, std::size_t threads = 0);

/// The stored result of one flight.
struct CampaignRecord {
  std::uint64_t number = 0;              ///< of the flight, from 0
  FlightEnd end = FlightEnd::completed;  ///< how the flight ended
  bool passed = false;                   ///< completed, and every limit of the mission satisfied
  double end_time = 0;                   ///< [s]
  /// Reason of an early end, e.g. "tilt"; at most 47 bytes; empty if completed
  std::string reason;
  MetricValues metrics;  ///< of the flight
};

/// Extracts the record of a flight from its result.
/// @param number  of the flight
/// @param setup   of the flight; its mission defines the limits
/// @param result  of the flight
[[nodiscard]] CampaignRecord record_of(std::uint64_t number, const FlightSetup& setup,
                                       const FlightResult& result);

/// Flies draws `begin` to `end` - 1 in every case.
/// @param campaign     its setups are accepted by fly_all() in every draw
/// @param begin, end   begin ≤ end ≤ `campaign.flights`
/// @param threads      as fly_all()
/// @param interrupted  as fly_all()
/// @return             records in the order of their numbers; bit-identical for any number of
///                     threads and any partition of the draws into calls
/// @throws InvalidInput, Interrupted  as fly_all()
[[nodiscard]] std::vector<CampaignRecord> fly_draws(const Campaign& campaign, std::uint32_t begin,
                                                    std::uint32_t end, std::size_t threads = 0,
                                                    const std::function<bool()>& interrupted = {});

/// The draws `begin` to `end` - 1.
struct DrawRange {
  std::uint32_t begin = 0;  ///< first draw
  std::uint32_t end = 0;    ///< one past the last draw
};
/// The draws of one shard. The sizes of the shards differ by at most one draw.
/// @param flights  number of draws
/// @param shards   ≥ 1
/// @param shard    0 ≤ shard < `shards`
[[nodiscard]] DrawRange shard_draws(std::uint32_t flights, std::uint32_t shards,
                                    std::uint32_t shard);

}  // namespace quadtune
