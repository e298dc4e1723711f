// SPDX-License-Identifier: Apache-2.0
#include "logs/mat/mat_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>
#include <utility>

#include "logs/formats/log_lines.hpp"
#include "logs/log_clock.hpp"
#include "logs/mat/mat_content.hpp"

namespace quadtune::internal {
namespace {

constexpr std::size_t kBlockValues = 4096;

class MatReader final : public LogReader {
 public:
  MatReader(ByteStream stream, const LogOptions& options)
      : LogReader("mat"), name_(stream.name()), clock_(options.epoch_s) {
    MatContent content = decode_mat(stream, options.memory_limit);
    condition_ = std::move(content.condition);
    tables_ = std::move(content.tables);
    for (const MatTable& table : tables_) add_group(table.group);
  }

  bool next(LogBlock& block) override {
    block.time.clear();
    block.values.clear();
    while (block.time.empty() && table_ < tables_.size()) {
      const MatTable& table = tables_[table_];
      if (row_ == table.rows()) {
        ++table_;
        row_ = 0;
      } else {
        block.group = table_;
        read_rows(table, block);
      }
    }
    return !block.time.empty();
  }

  [[nodiscard]] std::int64_t epoch_s() const override { return clock_.epoch_s(); }

 private:
  void read_rows(const MatTable& table, LogBlock& block) {
    const std::size_t step =
        std::max<std::size_t>(1, kBlockValues / std::max<std::size_t>(1, table.columns.size()));
    for (const std::size_t end = std::min(row_ + step, table.rows()); row_ < end; ++row_) {
      double time = std::numeric_limits<double>::quiet_NaN();
      if (table.group.timed) {
        time = clock_.seconds(table.time[row_]);
        if (std::isnan(time)) {
          skip_record(condition_, fmt::format("{}: a row of '{}' has no time, expected a number",
                                              name_, groups()[table_].name));
          continue;
        }
      }
      block.time.push_back(time);
      for (const std::vector<double>& column : table.columns) block.values.push_back(column[row_]);
    }
  }

  std::string name_;
  LogClock clock_;
  std::vector<MatTable> tables_;
  std::size_t table_ = 0;  // index of the current table
  std::size_t row_ = 0;    // index of its next row
};

}  // namespace

bool is_mat(std::string_view bytes) {
  constexpr std::size_t kOrder = 126;
  return bytes.starts_with("MATLAB ") || bytes.starts_with("\x89HDF") ||
         (bytes.size() >= kOrder + 2 &&
          (bytes.substr(kOrder, 2) == "IM" || bytes.substr(kOrder, 2) == "MI") &&
          (bytes[kOrder - 1] == 1 || bytes[kOrder - 2] == 1));
}

std::unique_ptr<LogReader> open_mat(ByteStream stream, const LogOptions& options) {
  return std::make_unique<MatReader>(std::move(stream), options);
}

}  // namespace quadtune::internal
