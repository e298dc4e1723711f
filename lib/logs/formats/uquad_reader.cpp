// SPDX-License-Identifier: Apache-2.0
#include "logs/formats/uquad_reader.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "logs/formats/log_lines.hpp"
#include "logs/formats/text_reader.hpp"
#include "logs/log_clock.hpp"
#include "logs/log_titles.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"

namespace quadtune::internal {
namespace {

constexpr std::size_t kReadings = 11;
constexpr std::size_t kTemperature = 9;
constexpr double kDegrees = 0.1;   // [degC] per count of the temperature
constexpr double kSeconds = 1e-6;  // per tick of T_us
constexpr std::size_t kBlockRows = 512;

const std::array<LogChannel, kReadings> kChannels = {{{"acc_x", "1"},
                                                      {"acc_y", "1"},
                                                      {"acc_z", "1"},
                                                      {"gyro_x", "1"},
                                                      {"gyro_y", "1"},
                                                      {"gyro_z", "1"},
                                                      {"magn_x", "1"},
                                                      {"magn_y", "1"},
                                                      {"magn_z", "1"},
                                                      {"temperature", "degC"},
                                                      {"pressure", "Pa"}}};

struct Frame {
  double T_us = 0;
  std::array<double, kReadings> readings{};
};

std::optional<Frame> frame_of(std::string_view line) {
  line = trimmed(line);
  if (next_word(line, ' ') != "A") return std::nullopt;
  Frame frame;
  const std::optional<double> T_us = number_of(next_word(line, ' '));
  if (!T_us || !std::isfinite(*T_us)) return std::nullopt;
  frame.T_us = *T_us;
  for (double& reading : frame.readings) {
    const std::optional<double> value = number_of(next_word(line, ' '));
    if (!value) return std::nullopt;
    reading = *value;
  }
  frame.readings[kTemperature] *= kDegrees;
  if (line != "Z") return std::nullopt;
  return frame;
}

class FrameReader final : public LogReader {
 public:
  FrameReader(ByteStream stream, const LogOptions& options)
      : LogReader("uquad-frames"),
        lines_(std::move(stream)),
        epoch_s_(options.epoch_s.value_or(0)) {
    add_group({"", {kChannels.begin(), kChannels.end()}, true});
  }

  bool next(LogBlock& block) override {
    block.group = 0;
    block.time.clear();
    block.values.clear();
    while (block.rows() < kBlockRows) {
      const std::optional<std::string_view> line = lines_.next(condition_);
      if (!line) break;
      if (!trimmed(*line).empty()) read(*line, block);
    }
    if (block.time.empty() && first_ && condition_.skipped > 0)
      throw InvalidInput("", condition_.first_skipped + "; no other line can be read either");
    return !block.time.empty();
  }

  [[nodiscard]] std::int64_t epoch_s() const override { return epoch_s_; }

 private:
  void read(std::string_view line, LogBlock& block) {
    const std::optional<Frame> frame = frame_of(line);
    if (!frame) {
      skip_record(condition_,
                  lines_.where() + ": is not a frame, expected A, T_us, 11 numbers and Z");
      return;
    }
    if (!first_) elapsed_us_ += frame->T_us;
    first_ = false;
    block.time.push_back(elapsed_us_ * kSeconds - static_cast<double>(epoch_s_));
    block.values.insert(block.values.end(), frame->readings.begin(), frame->readings.end());
  }

  LogLines lines_;
  std::int64_t epoch_s_;
  double elapsed_us_ = 0;  // whole microseconds: exact for 285 years
  bool first_ = true;
};

LogColumnChoice channel_choice(const LogChannel& channel, std::size_t column) {
  return {channel.name, channel.unit, std::to_string(column), 0};
}

}  // namespace

bool is_uquad_frame(std::string_view line) { return frame_of(line).has_value(); }

std::unique_ptr<LogReader> open_uquad_frames(ByteStream stream, const LogOptions& options) {
  return std::make_unique<FrameReader>(std::move(stream), options);
}

std::unique_ptr<LogReader> open_uquad_log(ByteStream stream, const LogOptions& options) {
  constexpr std::size_t kTimes = 2;
  std::string_view line = stream.peek(ByteStream::kWindow);
  line = trimmed(line.substr(0, line.find('\n')));
  std::size_t columns = 0;
  while (!line.empty()) {
    next_word(line, ' ');
    ++columns;
  }
  const bool with_period = columns == kTimes + 1 + kReadings;
  if (!with_period && columns != kTimes + kReadings)
    throw InvalidInput(stream.name() + ":1",
                       fmt::format("has {} separated by blanks, expected {} or {} of the uquad's "
                                   "imu_raw.log",
                                   internal::counted(columns, "column"), kTimes + kReadings,
                                   kTimes + 1 + kReadings));
  LogOptions named = options;
  named.columns = {{"t_s", "s", "1", 1}, {"t_us", "us", "2", 1e6}};
  if (with_period) named.columns.push_back({"T_us", "us", "3", 0});
  for (std::size_t i = 0; i < kReadings; ++i) {
    LogChannel channel = kChannels[i];
    if (i == kTemperature) channel.unit = "0.1 degC";  // the unit of the numbers in the file
    named.columns.push_back(channel_choice(channel, columns - kReadings + i + 1));
  }
  return open_text(std::move(stream), named, "uquad-log");
}

}  // namespace quadtune::internal
