// SPDX-License-Identifier: Apache-2.0
/// Reads logs of any format row by row in constant memory: channels, values, damage.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace quadtune {

/// One recorded quantity.
struct LogChannel {
  std::string name;        ///< name in the file, without its unit: "z", "gyro_x", "values[1]"
  std::string unit;        ///< e.g. "m/s^2"; empty if the file does not state it
  std::size_t column = 0;  ///< column number of a text, from 1; 0 if the file has no columns

  friend bool operator==(const LogChannel&, const LogChannel&) = default;
};

/// Channels with a common clock: a topic, a sensor, or the table of a text file.
struct LogGroup {
  std::string name;  ///< e.g. "sensor_combined"; empty if the file has only one table
  std::vector<LogChannel> channels;  ///< in the order of the file
  bool timed = true;                 ///< false: the rows have no times, LogBlock::time contains NaN
};

/// "group.channel", or only the channel's name if the group has no name.
[[nodiscard]] std::string full_name(const LogGroup& group, const LogChannel& channel);

/// Consecutive rows of one group, in the order of the file.
struct LogBlock {
  std::size_t group = 0;       ///< index into LogReader::groups()
  std::vector<double> time;    ///< [s] since LogReader::epoch_s(), one per row
  std::vector<double> values;  ///< row by row, one per channel; NaN if missing

  [[nodiscard]] std::size_t rows() const { return time.size(); }  ///< number of rows
};

/// Damage and ambiguities of a log. Complete only after the reader has reached the end.
struct LogCondition {
  std::string torn;           ///< where and why the file is truncated; empty if it is not
  std::uint64_t skipped = 0;  ///< number of records that could not be read
  /// Location of the first of them and the reason; empty if there is none
  std::string first_skipped;
  std::uint64_t dropouts = 0;  ///< number of losses of records that the logger itself reports
  double dropout_s = 0;        ///< total duration of these losses [s]
  /// Why the unit of time is unknown; empty if it is known. Times are then delivered in seconds
  std::string unclear_time;
  /// Information for the user about the interpretation of the file
  std::vector<std::string> notes;

  /// False if data that the file should contain were not delivered.
  [[nodiscard]] bool whole() const { return torn.empty() && skipped == 0; }
};

/// A column of a text to be read, and its name.
struct LogColumnChoice {
  std::string name;    ///< name of the channel; empty: all columns that are not selected otherwise
  std::string unit;    ///< empty: the unit in the header
  std::string column;  ///< its number, from 1, or its name in the header
  double ticks = 0;    ///< for a part of the time: ticks per second; 0 for a channel
};

/// Parses a column selection such as "t_s:1, t_us:2, height[m]:19": items NAME[UNIT]:COLUMN. COLUMN
/// is a number from 1 or a name in the header. Without COLUMN, the item selects the column of the
/// same name or, if the text has no header, the column after the previous item. A NAME of t, time
/// or timestamp, with its unit as in t_us, time[ns] or t[ms], is a part of the time (if the unit is
/// not stated, it is inferred from the values); several parts are added. The item * selects all
/// other columns.
/// @param text   one or more items, separated by commas
/// @param where  beginning of messages, e.g. "--columns"
/// @throws InvalidInput  if the text is not a column selection
[[nodiscard]] std::vector<LogColumnChoice> parse_log_columns(const std::string& text,
                                                             const std::string& where);

/// Options for reading a log.
struct LogOptions {
  std::string format;                    ///< one of log_formats(); empty: detected from the content
  std::vector<LogColumnChoice> columns;  ///< for text; empty: all columns
  /// > 0: row i of a text is at time i / rate, even if the text contains times
  double rate_hz = 0;
  std::optional<std::int64_t> epoch_s;              ///< time 0 in the clock of the file [s]; empty:
                                                    ///< as described at LogReader::epoch_s()
  std::size_t memory_limit = std::size_t{4} << 30;  ///< for all variables of a MAT file [bytes]
};

/// A value of LogOptions::format and its description.
struct LogFormat {
  std::string name;     ///< value of LogOptions::format
  std::string summary;  ///< one line
};

/// All formats, in the order of the documentation.
[[nodiscard]] const std::vector<LogFormat>& log_formats();

/// Delivers a log block by block. Times are exact: the epoch is subtracted from integer times
/// before these are converted to seconds.
class LogReader {
 public:
  virtual ~LogReader() = default;
  LogReader(const LogReader&) = delete;
  LogReader& operator=(const LogReader&) = delete;

  /// Reads the next rows, in the order of the file; false at its end, with an empty `block`.
  /// @throws FileError     if the file can no longer be read
  /// @throws InvalidInput  if no part of the file can be read. The readable part of a truncated
  ///                       file is delivered, and condition() reports the truncation.
  [[nodiscard]] virtual bool next(LogBlock& block) = 0;

  /// The groups found so far. Each block may add groups; existing groups do not change.
  [[nodiscard]] const std::vector<LogGroup>& groups() const { return groups_; }
  /// Damage that was found so far.
  [[nodiscard]] const LogCondition& condition() const { return condition_; }
  /// One of log_formats().
  [[nodiscard]] const std::string& format() const { return format_; }
  /// Time 0 in the clock of the file [s]: 0, or the whole seconds of the first time if it is so
  /// large (1e6 s and more) that a double would not resolve nanoseconds. Known after the first
  /// block.
  [[nodiscard]] virtual std::int64_t epoch_s() const = 0;

 protected:
  /// By the reader of one format: its name in log_formats()
  explicit LogReader(std::string format) : format_(std::move(format)) {}

  /// Adds a group. Characters of its names and units that are invalid in terminals or JSON are
  /// replaced by '?'.
  void add_group(LogGroup group);

  LogCondition condition_;  ///< for the reader of one format, which adds the damage that it finds

 private:
  std::string format_;
  std::vector<LogGroup> groups_;
};

/// Opens a log in the format LogOptions::format, or detects the format from the first bytes.
/// @param path     a file; "-" is standard input
/// @param options  format, columns and clock, if they are not detected
/// @throws FileError     if it cannot be read
/// @throws InvalidInput  if it is not a log of that format, or the options do not fit the format
[[nodiscard]] std::unique_ptr<LogReader> open_log(const std::string& path,
                                                  const LogOptions& options = {});

}  // namespace quadtune
