// SPDX-License-Identifier: Apache-2.0
/// Flights, the missions of a design, and campaigns, as text, JSON and pages. The results are only
/// declared here; include the header of a result to use it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/flight/diagnosis.hpp"
#include "report/page/flight_report.hpp"

namespace quadtune {
struct CampaignPlan;
struct CampaignProgress;
struct CampaignRecord;
struct CampaignStatistics;
struct CampaignStatus;
struct ComparedFlights;
struct DesignOutcome;
struct FlownFlight;
struct MissionDiagnoses;
struct PlannedFlight;
struct ShardWork;
}  // namespace quadtune

namespace quadtune::report {

/// "estimator mambo, real sensors, wind calm"
[[nodiscard]] std::string surroundings(const PlannedFlight& plan);
/// "cascaded PID, …; estimator mambo, real sensors, wind calm, seed 1"
[[nodiscard]] std::string circumstances(const PlannedFlight& plan);

/// A flight: "metrics", "limits", "verdict", "events", "final_state", "steps", "wall_s" and its
/// conditions.
/// @param diagnosis  of a failed flight, if one was computed: "diagnosis"
[[nodiscard]] internal::Json to_json(const FlownFlight& flight,
                                     const std::optional<Diagnosis>& diagnosis = {});
[[nodiscard]] std::string to_text(const FlownFlight& flight,
                                  const std::optional<Diagnosis>& diagnosis = {});
/// The page of a flight whose log was kept; html() converts it to a file.
/// @param command    the command line that produced it; may be empty
[[nodiscard]] FlightReport flight_page(const FlownFlight& flight, const std::string& command,
                                       const std::optional<Diagnosis>& diagnosis = {});

/// Flights that differ only in their seed: an array; or one verdict, a table of all, and the first
/// flight that failed, or else the first one.
/// @param diagnosis  of the first flight that failed
[[nodiscard]] internal::Json to_json(const std::vector<FlownFlight>& flights,
                                     const std::optional<Diagnosis>& diagnosis);
[[nodiscard]] std::string to_text(const std::vector<FlownFlight>& flights,
                                  const std::optional<Diagnosis>& diagnosis);

/// Where two flights of one mission differ.
[[nodiscard]] internal::Json to_json(const ComparedFlights& compared);
[[nodiscard]] std::string to_text(const ComparedFlights& compared);

/// The missions of a design, in a few lines each.
[[nodiscard]] internal::Json missions_json(const DesignOutcome& outcome,
                                           const MissionDiagnoses& diagnoses);
[[nodiscard]] std::string missions_text(const DesignOutcome& outcome,
                                        const MissionDiagnoses& diagnoses);

/// The plan of a campaign: its cases, and the commands that fly it.
/// @param folder     folder of the campaign
/// @param was_there  whether the folder already contained this plan
[[nodiscard]] internal::Json to_json(const CampaignPlan& plan);
[[nodiscard]] std::string to_text(const CampaignPlan& plan, const std::string& folder,
                                  bool was_there);

/// The progress of a campaign, shard by shard.
[[nodiscard]] internal::Json to_json(const CampaignPlan& plan, const CampaignStatus& status);
[[nodiscard]] std::string to_text(const CampaignPlan& plan, const CampaignStatus& status);
/// The work of a worker on one shard.
[[nodiscard]] internal::Json to_json(std::uint32_t shard, const ShardWork& work);
[[nodiscard]] std::string to_text(std::uint32_t shard, const ShardWork& work);
/// A progress bar, the number of flights that are done, and the remaining time.
/// @param seconds  since the work began
[[nodiscard]] std::string progress_line(const CampaignProgress& now, double seconds);

/// A campaign's statistics.
/// @param folder   folder of the campaign, for the commands that fly a flight again
[[nodiscard]] internal::Json to_json(const CampaignPlan& plan, const CampaignStatistics& statistics,
                                     const std::string& folder);
[[nodiscard]] std::string to_text(const CampaignPlan& plan, const CampaignStatistics& statistics,
                                  const std::string& folder);
/// The page as one HTML file.
/// @param records  all records of the campaign, in order
[[nodiscard]] std::string campaign_html(const CampaignPlan& plan,
                                        const CampaignStatistics& statistics,
                                        std::span<const CampaignRecord> records,
                                        const std::string& folder);

}  // namespace quadtune::report
