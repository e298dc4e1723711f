// SPDX-License-Identifier: Apache-2.0
#include "logs/open_log.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>

#include "logs/formats/foreign_formats.hpp"
#include "logs/formats/replay_reader.hpp"
#include "logs/formats/text_reader.hpp"
#include "logs/formats/ulog_reader.hpp"
#include "logs/formats/unicode.hpp"
#include "logs/formats/uquad_reader.hpp"
#include "logs/mat/mat_reader.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {
namespace {

constexpr std::size_t kLooked = 4096;  // [bytes] used to detect the format

std::string format_of(std::string_view bytes) {
  if (internal::is_ulog(bytes)) return "ulog";
  if (internal::is_mat(bytes)) return "mat";
  const std::string_view line = bytes.substr(0, bytes.find_first_of("\r\n"));
  if (internal::is_uquad_frame(line)) return "uquad-frames";
  return internal::is_replay(line) ? "replay" : "text";
}

void require_options(const LogOptions& options, const std::string& format,
                     const std::string& name) {
  if (!(options.rate_hz >= 0) || !std::isfinite(options.rate_hz))
    throw InvalidInput(name,
                       fmt::format("the rate is {} Hz, expected more than 0", options.rate_hz));
  const bool told = !options.columns.empty() || options.rate_hz > 0;
  if (told && format != "text")
    throw InvalidInput(name, fmt::format("is read as {}, which defines its own columns and times; "
                                         "columns and a rate apply to text only",
                                         format));
  constexpr std::int64_t kFarthest = 1'000'000'000'000'000;  // [s]
  if (options.epoch_s && (*options.epoch_s > kFarthest || *options.epoch_s < -kFarthest))
    throw InvalidInput(
        name, fmt::format("the epoch is {} s, expected at most {} s", *options.epoch_s, kFarthest));
}

std::string cleaned(const std::string& text) {
  constexpr std::size_t kMax = 200;
  std::string clean = text.substr(0, kMax);
  const bool utf8 = internal::utf16_of(clean).has_value();
  for (char& c : clean) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f || (byte >= 0x80 && !utf8)) c = '?';
  }
  return clean;
}

}  // namespace

std::string full_name(const LogGroup& group, const LogChannel& channel) {
  return group.name.empty() ? channel.name : group.name + '.' + channel.name;
}

void LogReader::add_group(LogGroup group) {
  group.name = cleaned(group.name);
  for (LogChannel& channel : group.channels)
    channel = {cleaned(channel.name), cleaned(channel.unit), channel.column};
  groups_.push_back(std::move(group));
}

const std::vector<LogFormat>& log_formats() {
  static const std::vector<LogFormat> formats = {
      {"text", "CSV and blank-separated text, quadtune's own flight logs included"},
      {"replay", "PX4 estimator replay: t_us,sensor,values"},
      {"ulog", "PX4 ULog"},
      {"mat", "MAT v5, compressed or not"},
      {"uquad-frames", "raw frames of the uquad's IMU: A, T_us, 11 numbers, Z"},
      {"uquad-log", "imu_raw.log of the uquad's main program: s, us, [T_us,] 11 numbers"}};
  return formats;
}

std::unique_ptr<LogReader> open_log(const std::string& path, const LogOptions& options) {
  return internal::open_log(internal::ByteStream(path), options);
}

namespace internal {

std::unique_ptr<LogReader> open_log(ByteStream stream, const LogOptions& options) {
  if (stream.peek(1).empty()) throw InvalidInput(stream.name(), "is empty, expected a log");
  if (options.format.empty())
    if (const std::string_view other = foreign_format(stream.peek(kLooked)); !other.empty())
      throw InvalidInput(stream.name(), std::string(other));
  const std::string format =
      options.format.empty() ? format_of(stream.peek(kLooked)) : options.format;
  require_options(options, format, stream.name());
  if (format == "text") return open_text(std::move(stream), options, "text");
  if (format == "replay") return open_replay(std::move(stream), options);
  if (format == "ulog") return open_ulog(std::move(stream), options);
  if (format == "mat") return open_mat(std::move(stream), options);
  if (format == "uquad-frames") return open_uquad_frames(std::move(stream), options);
  if (format == "uquad-log") return open_uquad_log(std::move(stream), options);
  std::vector<std::string> known;
  std::string names;
  for (const LogFormat& one : log_formats()) {
    known.push_back(one.name);
    names += (names.empty() ? "" : ", ") + one.name;
  }
  throw InvalidInput(
      "--format", fmt::format("no log format '{}', expected one of {}{}", printable(format), names,
                              did_you_mean(format, known)));
}

}  // namespace internal
}  // namespace quadtune
