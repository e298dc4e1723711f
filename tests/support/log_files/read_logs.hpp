// SPDX-License-Identifier: Apache-2.0
/// Logs in memory, read completely.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "logs/open_log.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune::testing {

/// All rows of one group.
struct WholeGroup {
  LogGroup group;
  std::vector<double> time;
  std::vector<std::vector<double>> rows;

  /// The column of that name; fails the test if it does not exist.
  [[nodiscard]] std::vector<double> column(const std::string& name) const {
    for (std::size_t k = 0; k < group.channels.size(); ++k) {
      if (group.channels[k].name != name) continue;
      std::vector<double> values;
      for (const std::vector<double>& row : rows) values.push_back(row[k]);
      return values;
    }
    ADD_FAILURE() << "no channel " << name;
    return {};
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const LogChannel& channel : group.channels) names.push_back(channel.name);
    return names;
  }
  [[nodiscard]] std::vector<std::string> units() const {
    std::vector<std::string> units;
    for (const LogChannel& channel : group.channels) units.push_back(channel.unit);
    return units;
  }
};

struct WholeLog {
  std::vector<WholeGroup> groups;
  LogCondition condition;
  std::int64_t epoch_s = 0;
  std::string format;
  std::vector<std::size_t> order;  ///< the groups of the blocks in the order of reading

  [[nodiscard]] const WholeGroup& group(const std::string& name) const {
    for (const WholeGroup& one : groups)
      if (one.group.name == name) return one;
    ADD_FAILURE() << "no group " << name;
    static const WholeGroup none;
    return none;
  }
};

inline WholeLog read_whole(LogReader& reader) {
  WholeLog log;
  LogBlock block;
  while (reader.next(block)) {
    log.groups.resize(reader.groups().size());
    log.order.push_back(block.group);
    WholeGroup& group = log.groups.at(block.group);
    const std::size_t columns = reader.groups()[block.group].channels.size();
    EXPECT_EQ(block.values.size(), block.rows() * columns);
    group.time.insert(group.time.end(), block.time.begin(), block.time.end());
    for (std::size_t i = 0; i < block.rows(); ++i) {
      const double* const row = block.values.data() + i * columns;
      group.rows.emplace_back(row, row + columns);
    }
  }
  log.groups.resize(reader.groups().size());
  for (std::size_t i = 0; i < log.groups.size(); ++i) log.groups[i].group = reader.groups()[i];
  log.condition = reader.condition();
  log.epoch_s = reader.epoch_s();
  log.format = reader.format();
  return log;
}

/// @param bytes  contents of the file, which messages call "f.log".
inline WholeLog read_bytes(const std::string& bytes, const LogOptions& options = {}) {
  return read_whole(*internal::open_log(internal::ByteStream(bytes, "f.log"), options));
}

inline LogOptions with_columns(const std::string& columns, double rate_hz = 0) {
  LogOptions options;
  options.columns = parse_log_columns(columns, "--columns");
  options.rate_hz = rate_hz;
  return options;
}

}  // namespace quadtune::testing
