// SPDX-License-Identifier: Apache-2.0
/// Flight code: a design as a self-contained C99 program for a board.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "quadtune/exports/file_set.hpp"
#include "quadtune/flight_code_options.hpp"

namespace quadtune {

struct ExportContent;

/// A C identifier made from a name: other characters than letters, digits and _ become _.
[[nodiscard]] std::string flight_code_name(const std::string& name);

/// The exporter of flight code.
inline constexpr char kFlightCodeTarget[] = "c";

/// The files of the program: C sources, a recorded flight with a program that replays it, a
/// Makefile, a README, and gains.json and the vehicle that `verify` compares them with.
///
/// The estimator is the general filter with the content's numbers; without them the program takes
/// the estimate from its caller.
///
/// Of content with a schedule the program is the interpolation table and its law, with recorded
/// points in the place of the flight, and schedule.json in that of gains.json.
/// @throws InvalidInput  for content without a law, with two laws and no choice, without a sample
///                       period, for a name that is no identifier, and for a number that the
///                       precision cannot hold; the message names the parameter
[[nodiscard]] std::vector<FileContent> flight_code_files(const ExportContent& content);

/// The choices with which an export of flight code was made.
/// @throws FileError, InvalidInput
[[nodiscard]] FlightCodeOptions read_flight_code_options(const std::filesystem::path& directory);

/// Which file has them, and which the schedule.
inline constexpr char kFlightCodeName[] = "flight_code.json";
inline constexpr char kScheduleJsonName[] = "schedule.json";

/// Whether a directory's flight code is that of a gain schedule.
[[nodiscard]] bool holds_schedule(const std::filesystem::path& directory);

}  // namespace quadtune
