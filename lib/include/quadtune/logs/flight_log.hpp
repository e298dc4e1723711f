// SPDX-License-Identifier: Apache-2.0
/// Logs as files: CSV for everything, MAT v5 for MATLAB and Octave. Both read back exactly.
#pragma once

#include <cstddef>
#include <string>

#include "quadtune/logs/log_table.hpp"

namespace quadtune {

/// Largest log file that is read [bytes]: what MATLAB takes as one variable of a MAT v5 file.
inline constexpr std::size_t kLogLimit = std::size_t{1} << 31;

/// Refuses a name that tells no format, before a flight is flown for it.
/// @param path   Ends in ".csv" or ".mat", in small letters.
/// @param where  What the message begins with, e.g. "--log".
/// @throws InvalidInput  for any other ending.
void require_log_name(const std::string& path, const std::string& where);

/// The bytes of a log in the format that the ending of `path` names. The same table gives the same
/// bytes. Nothing is written: pass them to write_files(), which replaces a file whole or not at
/// all.
/// @throws InvalidInput  as require_log_name(), csv_of() and bytes_of_mat().
[[nodiscard]] std::string log_bytes(const LogTable& table, const std::string& path);

/// Reads a file that log_bytes() made, by the ending of its name.
/// @throws InvalidInput  as require_log_name(), table_of_csv() and table_of_mat().
/// @throws FileError     if the file cannot be read.
[[nodiscard]] LogTable read_log(const std::string& path);

/// One row a line under a line of names, `t[s],x.px[m],…`, below comment lines that hold the rest
/// (docs/formats.md, "Flight logs"). A number has the fewest digits that read back to the same
/// double; NaN is an empty field.
/// @param table  All columns of one length, with distinct names that are not empty; texts UTF-8.
/// @throws InvalidInput  for any other table.
[[nodiscard]] std::string csv_of(const LogTable& table);

/// What csv_of() was given, save the sign and payload of NaN.
/// @param text    The file's bytes; lines may end in CR LF.
/// @param origin  What messages call the file.
/// @throws InvalidInput  "origin:line: …" for anything else than such a text, one that is cut short
///                       included.
[[nodiscard]] LogTable table_of_csv(const std::string& text, const std::string& origin);

/// A MAT v5 file, not compressed, with one struct `flight`: `flight.t`, `flight.x.px`, …,
/// `flight.units.x.px`, `flight.about`, `flight.events(i)` (docs/formats.md, "Flight logs").
/// @param table  As for csv_of(), with less than 2 GiB of numbers and texts.
/// @throws InvalidInput  for any other table.
[[nodiscard]] std::string bytes_of_mat(const LogTable& table);

/// What bytes_of_mat() was given, every bit of it.
/// @param bytes   The file's bytes.
/// @param origin  What messages call the file.
/// @throws InvalidInput  for any other file: one of another version, with other variables,
///                       compressed, cut short, or in need of more than 4 GiB.
[[nodiscard]] LogTable table_of_mat(const std::string& bytes, const std::string& origin);

}  // namespace quadtune
