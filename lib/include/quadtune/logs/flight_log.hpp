// SPDX-License-Identifier: Apache-2.0
/// Flight logs as files: CSV, or MAT v5 for MATLAB and Octave. Both are read back exactly.
#pragma once

#include <cstddef>
#include <string>

#include "quadtune/logs/log_table.hpp"

namespace quadtune {

/// Maximum size of a log file that is read [bytes]: the limit of a variable in a MAT v5 file.
inline constexpr std::size_t kLogLimit = std::size_t{1} << 31;

/// Rejects a file name that does not determine the log format, so that the mistake is reported
/// before the flight.
/// @param path   must end in ".csv" or ".mat", in lower case
/// @param where  beginning of the message, e.g. "--log"
/// @throws InvalidInput  for any other ending
void require_log_name(const std::string& path, const std::string& where);

/// Serializes a log in the format given by the ending of `path`. The same table gives the same
/// bytes. Nothing is written; pass the bytes to write_files(), which replaces a file atomically.
/// @throws InvalidInput  as require_log_name(), csv_of() and bytes_of_mat()
[[nodiscard]] std::string log_bytes(const LogTable& table, const std::string& path);

/// Reads a file written from log_bytes(), according to the ending of its name.
/// @throws InvalidInput  as require_log_name(), table_of_csv() and table_of_mat()
/// @throws FileError     if the file cannot be read
[[nodiscard]] LogTable read_log(const std::string& path);

/// Serializes a log as CSV: comment lines with the metadata (docs/formats.md, "Flight logs"), a
/// line of column titles `t[s],x.px[m],…`, then one line per row. Numbers have the smallest number
/// of digits that read back to the same double; NaN is an empty field.
/// @param table  columns of equal length with distinct names that are not empty; texts in UTF-8
/// @throws InvalidInput  for any other table
[[nodiscard]] std::string csv_of(const LogTable& table);

/// Parses the output of csv_of(). The result equals its input, except for the sign and payload of
/// NaN.
/// @param text    content of the file; lines may end in CR LF
/// @param origin  name of the file in messages
/// @throws InvalidInput  "origin:line: …" if the text is not a log written by csv_of(), or is
///                       truncated
[[nodiscard]] LogTable table_of_csv(const std::string& text, const std::string& origin);

/// Serializes a log as an uncompressed MAT v5 file with one struct `flight`: `flight.t`,
/// `flight.x.px`, …, `flight.units.x.px`, `flight.about`, `flight.events(i)` (docs/formats.md,
/// "Flight logs").
/// @param table  as for csv_of(), with less than 2 GiB of numbers and texts
/// @throws InvalidInput  for any other table
[[nodiscard]] std::string bytes_of_mat(const LogTable& table);

/// Parses the output of bytes_of_mat(). The result equals its input bit for bit.
/// @param bytes   content of the file
/// @param origin  name of the file in messages
/// @throws InvalidInput  if the file has another version or other variables, is compressed or
///                       truncated, or needs more than 4 GiB of memory
[[nodiscard]] LogTable table_of_mat(const std::string& bytes, const std::string& origin);

}  // namespace quadtune
