// SPDX-License-Identifier: Apache-2.0
/// Any log, read row by row in constant memory: what channels it has, their numbers, its damage.
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
  std::string name;        ///< as the file calls it, without its unit: "z", "gyro_x", "values[1]"
  std::string unit;        ///< e.g. "m/s^2"; "" where the file does not say
  std::size_t column = 0;  ///< of a text, counted from 1; 0 where the file has no columns

  friend bool operator==(const LogChannel&, const LogChannel&) = default;
};

/// Channels that share one clock: a topic, a sensor, or the one table of a text.
struct LogGroup {
  std::string name;  ///< e.g. "sensor_combined"; "" where the file has but one table
  std::vector<LogChannel> channels;
  bool timed = true;  ///< false: nothing gives the rows a time, LogBlock::time holds NaN
};

/// "group.channel", or the channel's name alone where the group has none.
[[nodiscard]] std::string full_name(const LogGroup& group, const LogChannel& channel);

/// Some rows of one group, in the order of the file.
struct LogBlock {
  std::size_t group = 0;       ///< in LogReader::groups()
  std::vector<double> time;    ///< [s] after LogReader::epoch_s(), one a row
  std::vector<double> values;  ///< row after row, one a channel; NaN where there is none

  [[nodiscard]] std::size_t rows() const { return time.size(); }
};

/// What is wrong with a log. Complete only once the reader has come to the end.
struct LogCondition {
  std::string torn;                ///< where and why the file ends too early; "" where it does not
  std::uint64_t skipped = 0;       ///< records that could not be read and were passed over
  std::string first_skipped;       ///< where the first of them stands, and why; "" without
  std::uint64_t dropouts = 0;      ///< times at which the logger itself lost records, as it says
  double dropout_s = 0;            ///< how long it lost them in all [s]
  std::string unclear_time;        ///< why the unit of the time is not known; "" where it is. The
                                   ///< times are then delivered as if they were seconds
  std::vector<std::string> notes;  ///< what a user should know of how the file was taken

  /// False where something that the file should hold was not delivered.
  [[nodiscard]] bool whole() const { return torn.empty() && skipped == 0; }
};

/// A column of a text to be read, and what to call it.
struct LogColumnChoice {
  std::string name;    ///< what to call it; "" takes all columns not chosen otherwise
  std::string unit;    ///< "" keeps what the header says
  std::string column;  ///< its number, counted from 1, or its name in the header
  double ticks = 0;    ///< a part of the time, so many a second; 0 for a channel
};

/// Understands "t_s:1, t_us:2, height[m]:19": items NAME[UNIT]:COLUMN. COLUMN is a number from 1 or
/// a name of the header; without it, in a text without header, the column after the last one,
/// otherwise the column of that name. A NAME that is t, time or timestamp, with its unit as in
/// t_us, time[ns] or t[ms], is a part of the time (its values show a unit that is not stated);
/// parts are added. The item * takes all other columns.
/// @param where  What messages begin with, e.g. "--columns".
/// @throws InvalidInput  for anything else.
[[nodiscard]] std::vector<LogColumnChoice> parse_log_columns(const std::string& text,
                                                             const std::string& where);

/// How to read a log.
struct LogOptions {
  std::string format;                    ///< one of log_formats(); "" looks at the content
  std::vector<LogColumnChoice> columns;  ///< of a text; none: all
  double rate_hz = 0;                    ///< > 0: row i of a text is at i / rate, whatever it says
  std::optional<std::int64_t> epoch_s;   ///< where time 0 lies in the file's clock [s]
  std::size_t memory_limit = std::size_t{4} << 30;  ///< of all variables of a MAT file [bytes]
};

/// A name for LogOptions::format and what it means.
struct LogFormat {
  std::string name;
  std::string summary;
};
[[nodiscard]] const std::vector<LogFormat>& log_formats();

/// Delivers a log block by block. Copies of time are exact: integer times are subtracted as
/// integers before they become seconds.
class LogReader {
 public:
  virtual ~LogReader() = default;
  LogReader(const LogReader&) = delete;
  LogReader& operator=(const LogReader&) = delete;

  /// The next rows, in the order of the file; false at its end, `block` then being empty.
  /// @throws FileError     if the file can no longer be read.
  /// @throws InvalidInput  if nothing of the file can be read. What can be read of a torn one is
  ///                       delivered, and condition() tells where it ends.
  [[nodiscard]] virtual bool next(LogBlock& block) = 0;

  /// The groups that came so far. More may come with each block; those that came stay as they are.
  [[nodiscard]] const std::vector<LogGroup>& groups() const { return groups_; }
  [[nodiscard]] const LogCondition& condition() const { return condition_; }
  /// One of log_formats().
  [[nodiscard]] const std::string& format() const { return format_; }
  /// Where time 0 lies in the file's clock [s]: 0, or the whole seconds of the first time where a
  /// double would not hold nanoseconds beside it (1e6 s and more). Known with the first block.
  [[nodiscard]] virtual std::int64_t epoch_s() const = 0;

 protected:
  explicit LogReader(std::string format) : format_(std::move(format)) {}

  /// Adds a group; what no terminal and no JSON takes in its names and units becomes '?'.
  void add_group(LogGroup group);

  LogCondition condition_;

 private:
  std::string format_;
  std::vector<LogGroup> groups_;
};

/// Opens a log by LogOptions::format, or by what its first bytes look like.
/// @param path  A file; "-" is standard input.
/// @throws FileError     if it cannot be read.
/// @throws InvalidInput  if it is no log of that format, or options do not fit it.
[[nodiscard]] std::unique_ptr<LogReader> open_log(const std::string& path,
                                                  const LogOptions& options = {});

}  // namespace quadtune
