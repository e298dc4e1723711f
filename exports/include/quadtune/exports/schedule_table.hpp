// SPDX-License-Identifier: Apache-2.0
/// Gain schedules as files: an interpolation table in TOML or JSON (docs/formats.md, "Gain
/// schedules").
#pragma once

#include <filesystem>
#include <string>

#include "quadtune/gain_schedule.hpp"

namespace quadtune {

/// The two texts of a table; both hold the same and read back to the same doubles.
enum class TableFormat { toml, json };

/// By the end of a file's name.
/// @throws InvalidInput  unless it ends in .toml or .json.
[[nodiscard]] TableFormat table_format(const std::filesystem::path& file, const std::string& where);

/// @param schedule  complete: every point has its status, with numbers or a culprit
/// @throws InvalidInput  for a number that is not finite at a solved point.
[[nodiscard]] std::string schedule_text(const GainSchedule& schedule, TableFormat format);

/// @param origin  what messages call the file
/// @throws InvalidInput  "origin:line: …" (TOML) or "origin: json path: …" for whatever is wrong:
///                       unknown or missing keys, other shapes, points that are not those of the
///                       axes in their order, numbers that are not finite.
[[nodiscard]] GainSchedule parse_schedule(const std::string& text, const std::string& origin,
                                          TableFormat format);

/// Reads a table of either format, by its name.
/// @throws FileError     if it cannot be read.
/// @throws InvalidInput  as parse_schedule() and table_format().
[[nodiscard]] GainSchedule read_schedule(const std::filesystem::path& path);

/// Whether a file says of itself that it is such a table; false for a pipe, and for a file that
/// cannot be read.
[[nodiscard]] bool is_schedule(const std::filesystem::path& path);

/// Largest table that is read [bytes]; one of 100,000 points of 12 states has about 130 MB.
inline constexpr std::size_t kScheduleTableLimit = std::size_t{256} << 20;

}  // namespace quadtune
