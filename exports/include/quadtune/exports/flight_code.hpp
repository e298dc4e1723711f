// SPDX-License-Identifier: Apache-2.0
/// Flight code: a design as a self-contained C99 program for a board.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "quadtune/design/flight_code_options.hpp"
#include "quadtune/exports/file_set.hpp"

namespace quadtune {

struct ExportContent;

/// Converts a name to a C identifier: characters other than letters, digits and _ become _.
[[nodiscard]] std::string flight_code_name(const std::string& name);

/// The name of the exporter of flight code.
inline constexpr char kFlightCodeTarget[] = "c";

/// Creates the files of the program: C sources, a recorded flight with a program that replays it, a
/// Makefile, a README, and gains.json and the vehicle, with which `verify` compares the sources.
///
/// The estimator is the general filter with the numbers of the content; without them, the program
/// expects the estimate from its caller.
///
/// If the content has a schedule, the program contains the interpolation table and its law, with
/// recorded points instead of the flight and schedule.json instead of gains.json.
/// @throws InvalidInput  if the content has no law, two laws and no choice, or no sample period, a
///                       name is not an identifier, or the chosen precision cannot represent a
///                       number; the message names the parameter
[[nodiscard]] std::vector<FileContent> flight_code_files(const ExportContent& content);

/// Reads the options with which flight code was exported.
/// @throws FileError, InvalidInput
[[nodiscard]] FlightCodeOptions read_flight_code_options(const std::filesystem::path& directory);

/// Name of the file that holds the options.
inline constexpr char kFlightCodeName[] = "flight_code.json";
/// Name of the file that holds the gain schedule.
inline constexpr char kScheduleJsonName[] = "schedule.json";

/// Whether the flight code in a directory is that of a gain schedule.
[[nodiscard]] bool holds_schedule(const std::filesystem::path& directory);

}  // namespace quadtune
