// SPDX-License-Identifier: Apache-2.0
/// The records of a campaign as one table, for other programs: a row a flight, with what was drawn
/// for it.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "quadtune/simulation/campaign.hpp"

namespace quadtune {

/// Names of the columns: number, draw, design, mission, the quantities by name, passed, end,
/// reason, end_time_s, and the metrics with their units, e.g. tilt_max_rad.
[[nodiscard]] std::vector<std::string> campaign_columns(const Campaign& campaign);

/// Writes them as CSV, whole or not at all. A figure that a flight does not have is empty, one that
/// it did not reach `inf`. Numbers read back to the same double.
/// @param drawn    all_draws() of the campaign
/// @param records  all of the campaign, in order
/// @throws FileError    with the path and the system's reason
/// @throws Interrupted
void write_campaign_csv(const std::filesystem::path& file, const Campaign& campaign,
                        const Eigen::MatrixXd& drawn, std::span<const CampaignRecord> records,
                        const std::function<bool()>& interrupted = {});

/// Writes them as a SQLite database, whole or not at all: table `flights`, and `quantities` with
/// what was uncertain. A figure that a flight does not have is NULL.
/// @throws  as write_campaign_csv()
void write_campaign_database(const std::filesystem::path& file, const Campaign& campaign,
                             const Eigen::MatrixXd& drawn, std::span<const CampaignRecord> records,
                             const std::function<bool()>& interrupted = {});

}  // namespace quadtune
