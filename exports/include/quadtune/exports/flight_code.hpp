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

/// The files of the program: C sources, a recorded flight with a program that replays it, a
/// Makefile, a README, and gains.json and the vehicle that `verify` compares them with.
///
/// The estimator is the general filter with the content's numbers; without them the program takes
/// the estimate from its caller.
/// @throws InvalidInput  for content without a law, with two laws and no choice, without a sample
///                       period, for a name that is no identifier, and for a number that the
///                       precision cannot hold; the message names the parameter
[[nodiscard]] std::vector<FileContent> flight_code_files(const ExportContent& content);

/// The choices with which an export of flight code was made.
/// @throws FileError, InvalidInput
[[nodiscard]] FlightCodeOptions read_flight_code_options(const std::filesystem::path& directory);

/// Which file has them.
inline constexpr char kFlightCodeName[] = "flight_code.json";

}  // namespace quadtune
