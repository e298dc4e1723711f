// SPDX-License-Identifier: Apache-2.0
#include "logs/formats/replay_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "logs/formats/log_lines.hpp"
#include "logs/log_clock.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::internal {
namespace {

constexpr double kTicks = 1e6;           // microseconds
constexpr std::size_t kMaxGroups = 256;  // a replay has about ten sensors
constexpr std::size_t kMaxValues = 256;  // per line
constexpr std::size_t kBlockValues = 4096;

// Channels that the estimator's simulated sensors write, in their order.
const std::vector<LogChannel>* known_channels(std::string_view sensor) {
  static const std::map<std::string, std::vector<LogChannel>, std::less<>> known = {
      {"imu",
       {{"accel_x", "m/s^2"},
        {"accel_y", "m/s^2"},
        {"accel_z", "m/s^2"},
        {"gyro_x", "rad/s"},
        {"gyro_y", "rad/s"},
        {"gyro_z", "rad/s"}}},
      {"mag", {{"x", "gauss"}, {"y", "gauss"}, {"z", "gauss"}}},
      {"baro", {{"height", "m"}}},
      {"gps",
       {{"altitude", "mm"},
        {"lon", "1e-7 deg"},
        {"lat", "1e-7 deg"},
        {"v_north", "m/s"},
        {"v_east", "m/s"},
        {"v_down", "m/s"}}},
      {"airspeed", {{"true_airspeed", "m/s"}, {"equivalent_airspeed", "m/s"}}},
      {"landed", {{"landed", "1"}}}};
  const auto found = known.find(sensor);
  return found == known.end() ? nullptr : &found->second;
}

bool is_sensor(std::string_view word) {
  const auto fits = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
  return !word.empty() && word.size() <= 64 && std::isalpha(static_cast<unsigned char>(word[0])) &&
         std::all_of(word.begin(), word.end(), fits);
}

class ReplayReader final : public LogReader {
 public:
  ReplayReader(ByteStream stream, const LogOptions& options)
      : LogReader("replay"), lines_(std::move(stream)), clock_(options.epoch_s) {}

  // A block ends at the first row of another sensor, to keep the order of the file.
  bool next(LogBlock& block) override {
    block = {waiting_.group, std::move(block.time), std::move(block.values)};
    block.time.clear();
    block.values.clear();
    if (waiting_.full) take(block);
    while (block.values.size() < kBlockValues && read_row()) {
      if (block.time.empty()) block.group = waiting_.group;
      if (waiting_.group != block.group) return true;
      take(block);
    }
    if (block.time.empty() && condition_.skipped > 0 && groups().empty())
      throw InvalidInput("", condition_.first_skipped + "; no other line can be read either");
    return !block.time.empty();
  }

  [[nodiscard]] std::int64_t epoch_s() const override { return clock_.epoch_s(); }

 private:
  struct Row {
    bool full = false;
    std::size_t group = 0;
    double time = 0;
    std::vector<double> values;
  };

  void take(LogBlock& block) {
    block.time.push_back(waiting_.time);
    block.values.insert(block.values.end(), waiting_.values.begin(), waiting_.values.end());
    waiting_.full = false;
  }

  // Reads the next valid line into waiting_.
  bool read_row() {
    while (const std::optional<std::string_view> line = lines_.next(condition_)) {
      std::string_view rest = *line;
      if (rest.empty() || rest.front() == '#') continue;
      std::string_view time_word = next_word(rest, ',');
      const LogTicks ticks = leading_ticks(time_word);
      const std::string_view sensor = next_word(rest, ',');
      if (std::isnan(ticks.rest) || !time_word.empty() || !is_sensor(sensor) || rest.empty()) {
        skip("is not a sample, expected t_us,sensor,values");
        continue;
      }
      if (!read_values(rest)) continue;
      const std::optional<std::size_t> group = group_of(sensor);
      if (!group) continue;
      waiting_.group = *group;
      waiting_.time = clock_.seconds(ticks, kTicks);
      waiting_.full = true;
      return true;
    }
    return false;
  }

  bool read_values(std::string_view rest) {
    waiting_.values.clear();
    while (!rest.empty()) {
      const std::string_view word = next_word(rest, ',');
      const std::optional<double> value = number_of(word);
      if (!value || waiting_.values.size() == kMaxValues) {
        skip(fmt::format("'{}' is not a number in the range of a double, or more than {} values",
                         printable(word), kMaxValues));
        return false;
      }
      waiting_.values.push_back(*value);
    }
    return true;
  }

  std::optional<std::size_t> group_of(std::string_view sensor) {
    const std::size_t count = waiting_.values.size();
    const auto found = by_name_.find(sensor);
    if (found == by_name_.end()) {
      if (groups().size() == kMaxGroups) {
        skip(fmt::format("sensor '{}' exceeds the limit of {} sensors", sensor, kMaxGroups));
        return std::nullopt;
      }
      add_group(group(sensor, count));
      by_name_.emplace(sensor, groups().size() - 1);
      return groups().size() - 1;
    }
    const std::size_t expected = groups()[found->second].channels.size();
    if (count == expected) return found->second;
    skip(fmt::format("{} has {}, expected {} as in previous lines", sensor,
                     internal::counted(count, "value"), expected));
    return std::nullopt;
  }

  static LogGroup group(std::string_view sensor, std::size_t count) {
    LogGroup group{std::string(sensor), {}, true};
    const std::vector<LogChannel>* const known = known_channels(sensor);
    if (known != nullptr && known->size() == count)
      group.channels = *known;
    else
      for (std::size_t i = 1; i <= count; ++i)
        group.channels.push_back({fmt::format("v[{}]", i), ""});
    return group;
  }

  void skip(const std::string& what) { skip_record(condition_, lines_.where() + ": " + what); }

  LogLines lines_;
  LogClock clock_;
  std::map<std::string, std::size_t, std::less<>> by_name_;
  Row waiting_;  // read; belongs to the next block
};

}  // namespace

bool is_replay(std::string_view line) {
  std::string_view word = next_word(line, ',');
  const LogTicks ticks = leading_ticks(word);
  return !std::isnan(ticks.rest) && word.empty() && is_sensor(next_word(line, ','));
}

std::unique_ptr<LogReader> open_replay(ByteStream stream, const LogOptions& options) {
  return std::make_unique<ReplayReader>(std::move(stream), options);
}

}  // namespace quadtune::internal
