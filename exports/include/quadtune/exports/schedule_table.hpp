// SPDX-License-Identifier: Apache-2.0
/// Gain schedules as files: interpolation tables in TOML or JSON (docs/formats.md, "Gain
/// schedules").
#pragma once

#include <filesystem>
#include <string>

#include "quadtune/gain_schedule.hpp"

namespace quadtune {

/// The two formats of a table. Both hold the same data and read back to the same doubles.
enum class TableFormat { toml, json };

/// The format that the extension of a file name selects.
/// @throws InvalidInput  unless the name ends in .toml or .json
[[nodiscard]] TableFormat table_format(const std::filesystem::path& file, const std::string& where);

/// @param schedule  complete: every point has a status, and numbers or a culprit
/// @param format    TOML or JSON
/// @throws InvalidInput  if a number of a solved point is not finite
[[nodiscard]] std::string schedule_text(const GainSchedule& schedule, TableFormat format);

/// @param text    content of the file
/// @param origin  name of the file in messages
/// @param format  TOML or JSON
/// @throws InvalidInput  "origin:line: …" (TOML) or "origin: json path: …" for unknown or missing
///                       keys, wrong shapes, points that are not those of the axes in their order,
///                       and numbers that are not finite
[[nodiscard]] GainSchedule parse_schedule(const std::string& text, const std::string& origin,
                                          TableFormat format);

/// Reads a table; the format is that of table_format().
/// @throws FileError     if it cannot be read
/// @throws InvalidInput  as parse_schedule() and table_format()
[[nodiscard]] GainSchedule read_schedule(const std::filesystem::path& path);

/// Whether the contents of a file identify it as such a table; false for a pipe and for a file that
/// cannot be read.
[[nodiscard]] bool is_schedule(const std::filesystem::path& path);

/// Maximum size of a table [bytes]; a table of 100,000 points with 12 states has about 130 MB.
inline constexpr std::size_t kScheduleTableLimit = std::size_t{256} << 20;

}  // namespace quadtune
