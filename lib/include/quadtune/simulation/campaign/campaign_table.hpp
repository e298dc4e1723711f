// SPDX-License-Identifier: Apache-2.0
/// Exports the records of a campaign as one table: one row per flight, with its drawn parameters.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "quadtune/simulation/campaign/campaign.hpp"

namespace quadtune {

/// Column names: number, draw, design, mission, the quantities by name, passed, end, reason,
/// end_time_s, and the metrics with their units, e.g. tilt_max_rad.
[[nodiscard]] std::vector<std::string> campaign_columns(const Campaign& campaign);

/// Writes the table as CSV. The file is complete or does not change. A metric that is undefined for
/// a flight is empty; one that was not reached is `inf`. Numbers are written with full precision
/// and read back as the same double.
/// @param file         replaced if it exists
/// @param campaign     that was flown
/// @param drawn        all_draws() of the campaign
/// @param records      all records of the campaign, in order
/// @param interrupted  as fly_all()
/// @throws FileError    with the path and the operating system's reason
/// @throws Interrupted
void write_campaign_csv(const std::filesystem::path& file, const Campaign& campaign,
                        const Eigen::MatrixXd& drawn, std::span<const CampaignRecord> records,
                        const std::function<bool()>& interrupted = {});

/// Writes the table as an SQLite database. The file is complete or does not change. Its tables are
/// `flights` and `quantities`, which lists the uncertain quantities. A metric that is undefined for
/// a flight is NULL.
/// @throws  as write_campaign_csv()
void write_campaign_database(const std::filesystem::path& file, const Campaign& campaign,
                             const Eigen::MatrixXd& drawn, std::span<const CampaignRecord> records,
                             const std::function<bool()>& interrupted = {});

}  // namespace quadtune
