// SPDX-License-Identifier: Apache-2.0
#include "logs/formats/text_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "logs/clock_unit.hpp"
#include "logs/formats/log_lines.hpp"
#include "logs/formats/text_layout.hpp"
#include "logs/log_clock.hpp"
#include "logs/log_titles.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::internal {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kTextBlockValues = 8192;  // 64 KiB: fits in the cache
constexpr std::size_t kMaxColumns = 10000;      // a file with more is not a log
// [bytes] used to infer the unit of the time
constexpr std::size_t kLookedAhead = std::size_t{1} << 18U;
constexpr std::size_t kTimesLookedAt = 64;
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
constexpr std::string_view kOwnRows = "# rows,";

bool is_blank(char c) { return c == ' ' || c == '\t'; }

// Iterates over the fields of a line.
class Fields {
 public:
  Fields(std::string_view line, TextSeparator separator)
      : at_(line.data()), end_(line.data() + line.size()), separator_(separator) {
    skip_blanks();
  }

  // Whether the field that begins here is empty.
  [[nodiscard]] bool empty() const { return at_ == end_ || is_separator(*at_); }
  [[nodiscard]] bool at_end() const { return at_ == end_; }

  // Parses the whole field as a number. The result is NaN if it is not one; `bad` is then set
  // unless the field is NaN.
  double number(bool& bad) {
    if (*at_ == '+') ++at_;
    double value = kNaN;
    const auto [stop, error] = std::from_chars(at_, end_, value);
    bad = error != std::errc();
    if (bad) value = kNaN;
    at_ = stop;
    if (!ends_field()) {
      bad = true;
      return kNaN;
    }
    return value;
  }

  LogTicks ticks() {
    std::string_view rest(at_, static_cast<std::size_t>(end_ - at_));
    const LogTicks ticks = leading_ticks(rest);
    at_ = rest.data();
    return ends_field() ? ticks : LogTicks{0, kNaN};
  }

  void pass_over() {
    while (at_ != end_ && !is_separator(*at_)) ++at_;
  }

  // Moves from the end of a field to the beginning of the next; false at the end of the line.
  bool next() {
    skip_blanks();
    if (at_ == end_) return false;
    if (separator_ != TextSeparator::kBlanks) {
      ++at_;
      skip_blanks();
    }
    return true;
  }

 private:
  [[nodiscard]] bool is_separator(char c) const {
    return separator_ == TextSeparator::kBlanks ? is_blank(c) : c == static_cast<char>(separator_);
  }
  void skip_blanks() {
    while (at_ != end_ && is_blank(*at_) && (*at_ == ' ' || separator_ != TextSeparator::kTab))
      ++at_;
  }
  // Blanks may separate a number from a comma; any other text makes the field invalid.
  bool ends_field() {
    if (at_ == end_ || is_separator(*at_)) return true;
    skip_blanks();
    if (at_ == end_ || is_separator(*at_)) return true;
    pass_over();
    return false;
  }

  const char* at_;
  const char* end_;
  TextSeparator separator_;
};

class TextReader final : public LogReader {
 public:
  TextReader(ByteStream stream, const LogOptions& options, const std::string& format)
      : LogReader(format),
        lines_(std::move(stream)),
        clock_(options.epoch_s),
        rate_hz_(options.rate_hz) {
    read_head(options);
    add_group({"", layout_.channels, !layout_.ticks.empty() || rate_hz_ > 0});
    condition_.notes.insert(condition_.notes.end(), layout_.notes.begin(), layout_.notes.end());
    if (layout_.ticks.size() == 1) settle_clock();
    ticks_.resize(layout_.ticks.size());
    bad_.resize(layout_.channels.size());
  }

  bool next(LogBlock& block) override {
    block.group = 0;
    block.time.clear();
    block.values.clear();
    if (first_row_) {
      read_row(*first_row_, block);
      first_row_.reset();
    }
    const std::size_t columns = layout_.channels.size();
    while (block.values.size() < kTextBlockValues && block.time.size() < kTextBlockValues) {
      const std::optional<std::string_view> line = lines_.next(condition_);
      if (!line) break;
      read_row(*line, block);
    }
    if (block.time.empty()) finish();
    rows_ += block.time.size();
    block.values.resize(block.time.size() * columns);
    return !block.time.empty();
  }

  [[nodiscard]] std::int64_t epoch_s() const override { return clock_.epoch_s(); }

 private:
  // Reads the comments, the line of names if there is one, and the first row.
  void read_head(const LogOptions& options) {
    std::string comment;  // the last comment, which may contain the names
    std::optional<std::string> first;
    while (const std::optional<std::string_view> line = lines_.next(condition_)) {
      std::string_view text = *line;
      if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
      if (text.find('\0') != std::string_view::npos)
        throw InvalidInput(lines_.where(),
                           "holds a zero byte, expected text; is it a binary file?");
      if (text.starts_with(kOwnRows)) read_row_count(text.substr(kOwnRows.size()));
      const std::string_view content = trimmed(text);
      if (content.empty()) continue;
      if (content.front() == '#' || content.front() == '%') {
        comment = content.substr(1);
        continue;
      }
      first = std::string(text);
      break;
    }
    if (!first) {
      const bool names = !comment.empty() && !expected_rows_ && condition_.torn.empty();
      if (names) first = comment;  // there are no rows
      if (!first)
        throw InvalidInput(lines_.name(), condition_.torn.empty()
                                              ? "is empty, expected a log"
                                              : "has no complete line, expected a log");
    }
    const TextSeparator numbers = separator_of_numbers(*first);
    if (!holds_a_number(*first, numbers)) {
      const TextSeparator separator = separator_of_names(*first);
      const std::vector<std::string> names = split_names(*first, separator);
      require_columns(names.size());
      layout_ = text_layout(names, names.size(), separator, options, lines_.name());
      return;
    }
    const std::size_t count = split_names(*first, numbers).size();
    require_columns(count);
    std::vector<std::string> names = split_names(comment, numbers);
    if (holds_a_number(comment, numbers)) names.clear();
    if (names.size() > 1 && names.size() != count)
      condition_.notes.push_back(
          fmt::format("the columns have no names: the comment before the numbers, '{}', has {} "
                      "fields, expected {}, as many as each row",
                      printable(trimmed(comment)), names.size(), count));
    if (names.size() != count) names.clear();
    layout_ = text_layout(names, count, numbers, options, lines_.name());
    first_row_ = std::move(first);
  }

  void require_columns(std::size_t count) const {
    if (count > kMaxColumns)
      throw InvalidInput(lines_.where(),
                         fmt::format("has {} columns, expected at most {}", count, kMaxColumns));
  }

  void read_row_count(std::string_view text) {
    std::uint64_t rows = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), rows);
    if (error == std::errc() && end == text.data() + text.size()) expected_rows_ = rows;
  }

  // Inspects the first rows to infer the unit of their time if it is not stated, and to decide
  // whether a time of 0 can be valid.
  void settle_clock() {
    std::vector<double> times;
    if (first_row_) add_time(*first_row_, times);
    std::string_view ahead = lines_.ahead(kLookedAhead);
    for (std::size_t feed = ahead.find('\n');
         feed != std::string_view::npos && times.size() < kTimesLookedAt;
         ahead.remove_prefix(feed + 1), feed = ahead.find('\n'))
      add_time(trimmed(ahead.substr(0, feed)), times);
    const ClockSample sample = sample_of_clock(times);
    if (layout_.unstated)
      settle_unit(*layout_.unstated, sample);
    else
      check_unit(sample);
    zero_is_stray_ = zero_is_stray(sample, layout_.ticks[0]);
    if (zero_is_stray_) typical_time_s_ = sample.time / layout_.ticks[0];
  }

  void add_time(std::string_view line, std::vector<double>& times) const {
    if (is_comment(line)) return;
    Fields fields(line, layout_.separator);
    for (const TextRole& role : layout_.roles) {
      if (role.kind == TextRole::Kind::kTime && !fields.empty()) {
        const LogTicks ticks = fields.ticks();
        const double time = static_cast<double>(ticks.whole) + ticks.rest;
        if (time != 0) times.push_back(time);
        return;
      }
      fields.pass_over();
      if (!fields.next()) return;
    }
  }

  void settle_unit(const UnstatedClock& clock, const ClockSample& sample) {
    const ClockUnit unit = unit_of_clock(sample);
    const auto remedy = [&](const char* likely) {
      return fmt::format("--columns 't_{}:{}, *'", likely, clock.remedy);
    };
    if (unit.ticks == 0) {
      layout_.ticks[0] = 1;
      condition_.unclear_time =
          fmt::format("the clock {} states no unit, and {}: state it, as in {}", clock.name,
                      unit.reason, remedy(unit.unit));
      condition_.notes.push_back(condition_.unclear_time);
      return;
    }
    layout_.ticks[0] = unit.ticks;
    if (unit.ticks == 1 && clock.usual && sample.step < kSlowStep) return;
    const std::string apart =
        sample.step > 0 ? fmt::format(", with samples {:.4g} s apart", sample.step / unit.ticks)
                        : "";
    condition_.notes.push_back(
        fmt::format("the clock {} states no unit and {}{}; if that is wrong, state it, as in {}",
                    clock.name, unit.reason, apart, remedy(unit.ticks == 1 ? "us" : "s")));
  }

  /// For a clock with a stated unit.
  void check_unit(const ClockSample& sample) {
    if (!is_no_time(sample, layout_.ticks[0])) return;
    condition_.unclear_time = fmt::format(
        "the clock is stated in {}, but its values, such as {:.6g}, would be after the year 2286: "
        "state another unit",
        name_of_ticks(layout_.ticks[0]), sample.time);
    condition_.notes.push_back(condition_.unclear_time);
  }

  static bool is_comment(std::string_view line) {
    return !line.empty() && (line.front() == '#' || line.front() == '%');
  }

  void read_row(std::string_view line, LogBlock& block) {
    if (is_comment(line)) return;
    Fields fields(line, layout_.separator);
    const std::size_t columns = layout_.channels.size();
    // An empty line is a row only if the only column may be empty.
    if (fields.at_end()) return;
    const double index = static_cast<double>(index_++);
    const std::size_t start = block.values.size();
    bad_in_row_.clear();
    block.values.resize(start + columns, kNaN);
    double* const values = block.values.data() + start;
    std::size_t count = 0;
    for (bool more = true; more; ++count) {
      if (count < layout_.roles.size())
        read_field(fields, layout_.roles[count], values);
      else if (fields.at_end())
        break;  // separator at the end of the line
      else
        fields.pass_over();
      more = fields.next();
    }
    const double time = rate_hz_ > 0 ? index / rate_hz_ : time_of_row();
    if (count != layout_.roles.size())
      skip_record(condition_, fmt::format("{}: the row has {}, expected {}", lines_.where(),
                                          internal::counted(count, "field"), layout_.roles.size()));
    else if (zero_is_stray_ && ticks_[0].whole == 0 && ticks_[0].rest == 0)
      pass_over_stray();
    else if (std::isnan(time) && groups().front().timed)
      skip_record(
          condition_,
          lines_.where() + ": the time of the row is missing or no number with a decimal point");
    else {
      block.time.push_back(time);
      if (!bad_in_row_.empty()) note_bad_fields();
      return;
    }
    block.values.resize(start);
  }

  void read_field(Fields& fields, const TextRole& role, double* values) {
    switch (role.kind) {
      case TextRole::Kind::kPassedOver:
        fields.pass_over();
        return;
      case TextRole::Kind::kTime:
        ticks_[role.index] = fields.empty() ? LogTicks{0, kNaN} : fields.ticks();
        return;
      case TextRole::Kind::kChannel:
        if (fields.empty()) return;
        bool bad = false;
        values[role.index] = fields.number(bad);
        if (bad) bad_in_row_.push_back(role.index);
    }
  }

  double time_of_row() {
    if (ticks_.empty()) return kNaN;
    if (zero_is_stray_ && ticks_[0].whole == 0 && ticks_[0].rest == 0) return 0;
    double time = clock_.seconds(ticks_[0], layout_.ticks[0]);
    for (std::size_t i = 1; i < ticks_.size(); ++i)
      time += (static_cast<double>(ticks_[i].whole) + ticks_[i].rest) / layout_.ticks[i];
    return time;
  }

  void pass_over_stray() {
    if (strays_.count++ == 0) strays_.where = lines_.where();
  }

  // Counts the invalid fields of a delivered row.
  void note_bad_fields() {
    for (const std::size_t channel : bad_in_row_)
      if (bad_[channel].count++ == 0) bad_[channel].where = lines_.where();
  }

  void finish() {
    if (finished_) return;
    finished_ = true;
    if (rows_ == 0 && condition_.skipped == 0 && strays_.count == 0)
      condition_.notes.push_back(fmt::format(
          "{}: has a header but no row, so that it holds no measurement", lines_.name()));
    if (rows_ == 0 && condition_.skipped > 0)
      throw InvalidInput("", condition_.first_skipped + "; no other row can be read either");
    const bool words_alone =
        !bad_.empty() && std::all_of(bad_.begin(), bad_.end(), [&](const BadFields& fields) {
          return fields.count == rows_;
        });
    if (rows_ > 0 && words_alone && !groups().front().timed)
      throw InvalidInput(lines_.name(), "holds no number and no time, expected a log");
    if (condition_.skipped > rows_)
      throw InvalidInput(
          lines_.name(),
          fmt::format("{} of {} cannot be read; with more than half of them unreadable, this "
                      "is not a table; the first: {}",
                      condition_.skipped, counted(rows_ + condition_.skipped, "row"),
                      condition_.first_skipped));
    if (condition_.torn.empty() && expected_rows_ &&
        *expected_rows_ != rows_ + strays_.count + condition_.skipped)
      condition_.torn = fmt::format("{}: has {}, expected {} as its header states", lines_.name(),
                                    counted(rows_, "row"), *expected_rows_);
    const char* const is_or_are = strays_.count == 1 ? "is" : "are";
    if (strays_.count > 0)
      condition_.notes.push_back(fmt::format(
          "{} of {} {} at time 0 (clock not set) and {} left out; the others are around "
          "{:.6g} s; the first at {}",
          strays_.count, counted(rows_ + strays_.count, "row"), is_or_are, is_or_are,
          typical_time_s_, strays_.where));
    for (std::size_t i = 0; i < bad_.size(); ++i)
      if (bad_[i].count > 0)
        condition_.notes.push_back(fmt::format(
            "'{}': {} of {} {} no number, or one that exceeds the range of a double, and {} as "
            "missing, the first at {}",
            printable(layout_.channels[i].name), bad_[i].count, counted(rows_, "row"),
            bad_[i].count == 1 ? "has" : "have", bad_[i].count == 1 ? "counts" : "count",
            bad_[i].where));
  }

  struct BadFields {
    std::uint64_t count = 0;
    std::string where;
  };

  LogLines lines_;
  LogClock clock_;
  double rate_hz_;
  TextLayout layout_;
  std::optional<std::string> first_row_;
  std::optional<std::uint64_t> expected_rows_;
  std::vector<LogTicks> ticks_;  // of the current row
  bool zero_is_stray_ = false;   // the clock is far from 0
  double typical_time_s_ = 0;
  BadFields strays_;            // rows at time 0 while zero_is_stray_
  std::vector<BadFields> bad_;  // per channel
  std::vector<std::size_t> bad_in_row_;
  std::uint64_t index_ = 0;  // number of the next row
  std::uint64_t rows_ = 0;   // number of delivered rows
  bool finished_ = false;
};

}  // namespace

std::unique_ptr<LogReader> open_text(ByteStream stream, const LogOptions& options,
                                     const std::string& format) {
  return std::make_unique<TextReader>(std::move(stream), options, format);
}

}  // namespace quadtune::internal
