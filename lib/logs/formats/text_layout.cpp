// SPDX-License-Identifier: Apache-2.0
#include "logs/formats/text_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <unordered_set>

#include "logs/log_titles.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::internal {
namespace {

// Names such as "nan" and "inf" do not count as numbers.
bool is_number(std::string_view field) {
  if (field.empty() || field.find_first_of("0123456789") == std::string_view::npos) return false;
  if (field.starts_with('+')) field.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  // 1e400 is a number although a double cannot represent it.
  return error != std::errc::invalid_argument && end == field.data() + field.size();
}

std::vector<std::string> split_at_blanks(std::string_view line) {
  std::vector<std::string> fields;
  bool open = false;  // within the brackets of a unit, as in "z [m s^-1]"
  for (line = trimmed(line); !line.empty(); line = trimmed(line)) {
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    const std::string_view word = line.substr(0, end);
    const bool bracket = word.starts_with('[') || word.starts_with('(');
    if (!fields.empty() && (open || bracket))
      fields.back().append(" ").append(word);
    else
      fields.emplace_back(word);
    if (bracket || open) open = !word.ends_with(']') && !word.ends_with(')');
    line.remove_prefix(end);
  }
  return fields;
}

// Determines the role of each column.
class Chooser {
 public:
  Chooser(const std::vector<std::string>& names, std::size_t count, const LogOptions& options,
          const std::string& where)
      : options_(options), where_(where), named_(!names.empty()) {
    for (std::size_t i = 0; i < count; ++i)
      titles_.push_back(named_ ? title_of(i < names.size() ? names[i] : "")
                               : LogTitle{fmt::format("c{}", i + 1), "", 0, false});
    for (LogTitle& title : titles_)
      if (title.unit == "1" && is_indexed(title.name, names))
        title = {title.name + "[1]", "", 0, false};
    layout_.roles.resize(count);
  }

  TextLayout layout(TextSeparator separator) {
    layout_.separator = separator;
    choose_time();
    if (options_.columns.empty())
      add_others();
    else
      for (std::size_t i = 0; i < options_.columns.size(); ++i)
        if (options_.columns[i].name.empty())
          add_others();
        else if (options_.columns[i].ticks == 0)
          add_channel(columns_[i], options_.columns[i].name, options_.columns[i].unit);
    return std::move(layout_);
  }

 private:
  // If there is an x[0] or x[2], x[1] is an entry of the same vector, and "1" is not a unit.
  static bool is_indexed(const std::string& stem, const std::vector<std::string>& names) {
    return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      const std::string_view text = trimmed(name);
      return text == stem + "[0]" || text == stem + "[2]";
    });
  }

  struct TimePart {
    std::size_t column;
    double ticks;
    bool stated;
  };

  void choose_time() {
    std::vector<TimePart> parts;
    for (const LogColumnChoice& choice : options_.columns) {
      columns_.push_back(choice.name.empty() ? 0 : find(choice));
      if (!choice.name.empty()) chosen_.insert(columns_.back());
      if (choice.ticks == 0) continue;
      const double said = stated_ticks(titles_[columns_.back()]);
      const bool by_title = choice.unit.empty() && said > 0;
      if (choice.unit.empty() && said == 0) refuse_other_unit(titles_[columns_.back()]);
      if (said > 0 && said != choice.ticks) note_other_unit(titles_[columns_.back()], choice.unit);
      parts.push_back(
          {columns_.back(), by_title ? said : choice.ticks, by_title || !choice.unit.empty()});
    }
    if (!parts.empty() && options_.rate_hz > 0)
      throw InvalidInput(where_, "has a time column and a rate, expected one of them");
    if (const std::optional<std::size_t> clock = clock_of_names(); parts.empty() && clock) {
      if (options_.rate_hz == 0)
        parts.push_back({*clock, titles_[*clock].ticks, !titles_[*clock].guessed});
      else
        layout_.notes.push_back(
            fmt::format("the rate of {:.6g} Hz determines the times, and the times in the column "
                        "{} are not used",
                        options_.rate_hz, unstated(*clock).name));
    }
    // Largest unit first, since the epoch is taken from its digits.
    std::sort(parts.begin(), parts.end(),
              [](const TimePart& a, const TimePart& b) { return a.ticks < b.ticks; });
    for (const TimePart& part : parts) {
      layout_.roles[part.column] = {TextRole::Kind::kTime, layout_.ticks.size()};
      layout_.ticks.push_back(part.ticks);
    }
    if (parts.size() == 1 && !parts[0].stated) layout_.unstated = unstated(parts[0].column);
    if (parts.empty() && options_.rate_hz == 0)
      layout_.notes.push_back(
          "no column is recognized as a time in s, ms, us or ns: name it with --columns, such as "
          "'t_s:1, *', or give --rate");
  }

  /// Notes that the user chose a unit for a column that states another one.
  void note_other_unit(const LogTitle& title, const std::string& chosen) {
    if (chosen.empty() || title.unit.empty() || chosen == title.unit) return;
    layout_.notes.push_back(
        fmt::format("the line of names gives the unit {} of '{}'; the unit {} of "
                    "--columns replaces it",
                    printable(title.unit), printable(title.name), printable(chosen)));
  }

  /// Rejects a column that was selected as the time and is in another unit, such as min.
  void refuse_other_unit(const LogTitle& title) const {
    if (title.unit.empty()) return;
    throw InvalidInput(
        where_, fmt::format("the time column '{}' is in '{}', expected s, ms, us or "
                            "ns; state the unit with --time-unit or --columns 't_s:N, *', or "
                            "give --rate if the samples are equally spaced",
                            printable(title.name), printable(title.unit)));
  }

  static double stated_ticks(const LogTitle& title) {
    if (title.unit.empty()) return 0;
    return title.ticks > 0 ? title.ticks : ticks_of(title.unit);
  }

  std::optional<std::size_t> clock_of_names() const {
    for (std::size_t i = 0; i < titles_.size(); ++i)
      if (titles_[i].ticks > 0 && !chosen_.contains(i)) return i;
    return std::nullopt;
  }

  [[nodiscard]] UnstatedClock unstated(std::size_t column) const {
    const std::string& name = titles_[column].name;
    const std::string number = std::to_string(column + 1);
    const bool plain = named_ && !name.empty() &&
                       name.find_first_not_of("0123456789") != std::string::npos &&
                       name.find_first_of(",:*[]' ") == std::string::npos;
    return {plain ? fmt::format("'{}'", printable(name)) : "column " + number,
            plain ? printable(name) : number, name == "t" || name == "T"};
  }

  std::size_t find(const LogColumnChoice& choice) {
    std::size_t number = 0;
    const std::string& column = choice.column;
    if (column.empty() && !named_) {
      number = last_ + 1;
    } else if (!column.empty() && std::all_of(column.begin(), column.end(),
                                              [](char c) { return c >= '0' && c <= '9'; })) {
      std::from_chars(column.data(), column.data() + column.size(), number);
    } else {
      return find_name(column.empty() ? choice.name : column);
    }
    if (number < 1 || number > titles_.size())
      throw InvalidInput(where_,
                         fmt::format("has no column {} for '{}', expected 1 to {}",
                                     column.empty() ? std::to_string(number) : printable(column),
                                     printable(choice.name), titles_.size()));
    last_ = number;
    return number - 1;
  }

  std::size_t find_name(const std::string& name) const {
    std::vector<std::string> known;
    for (std::size_t i = 0; i < titles_.size(); ++i) {
      if (named_ && titles_[i].name == name) return i;
      if (named_) known.push_back(titles_[i].name);
    }
    constexpr std::size_t kListed = 12;
    const std::string near = did_you_mean(name, known);
    throw InvalidInput(
        where_, named_ ? fmt::format("has no column '{}'{}", printable(name),
                                     near.empty() && known.size() <= kListed
                                         ? fmt::format(", expected one of {}",
                                                       printable(joined(known, ", ")))
                                         : near)
                       : fmt::format("has no line of column names to look up '{}', expected the "
                                     "column's number",
                                     printable(name)));
  }

  void add_others() {
    for (std::size_t i = 0; i < titles_.size(); ++i)
      if (!chosen_.contains(i) && layout_.roles[i].kind == TextRole::Kind::kPassedOver)
        add_channel(i, titles_[i].name, titles_[i].unit);
  }

  void add_channel(std::size_t column, const std::string& name, const std::string& unit) {
    if (layout_.roles[column].kind != TextRole::Kind::kPassedOver)
      throw InvalidInput(where_,
                         fmt::format("column {} is selected twice, expected once", column + 1));
    std::string distinct = name.empty() ? fmt::format("c{}", column + 1) : name;
    while (!taken_.insert(distinct).second) distinct += fmt::format("#{}", column + 1);
    note_other_unit(titles_[column], unit);
    layout_.roles[column] = {TextRole::Kind::kChannel, layout_.channels.size()};
    layout_.channels.push_back({distinct, unit.empty() ? titles_[column].unit : unit, column + 1});
  }

  const LogOptions& options_;
  const std::string& where_;
  bool named_;
  std::vector<LogTitle> titles_;
  std::vector<std::size_t> columns_;  // one per choice
  std::unordered_set<std::size_t> chosen_;
  std::unordered_set<std::string> taken_;
  std::size_t last_ = 0;  // number of the column that was chosen last
  TextLayout layout_;
};

}  // namespace

TextSeparator separator_of_numbers(std::string_view line) {
  if (line.find(';') != std::string_view::npos) return TextSeparator::kSemicolon;
  if (line.find(',') != std::string_view::npos) return TextSeparator::kComma;
  return TextSeparator::kBlanks;
}

TextSeparator separator_of_names(std::string_view line) {
  const TextSeparator separator = separator_of_numbers(line);
  // If tabs are the only separators, names may contain blanks.
  const auto holds = [&](std::string_view part) {
    return line.find(part) != std::string_view::npos;
  };
  const bool tabs = holds("\t") && !holds("\t ") && !holds(" \t") && !holds("\t\t");
  return separator == TextSeparator::kBlanks && tabs ? TextSeparator::kTab : separator;
}

std::vector<std::string> split_names(std::string_view line, TextSeparator separator) {
  if (separator == TextSeparator::kBlanks) return split_at_blanks(line);
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == static_cast<char>(separator) && !quoted)
      fields.emplace_back();
    else
      fields.back() += c;
  }
  if (fields.size() > 1 && trimmed(fields.back()).empty()) fields.pop_back();
  return fields;
}

bool holds_a_number(std::string_view line, TextSeparator separator) {
  const std::vector<std::string> fields = split_names(line, separator);
  return std::any_of(fields.begin(), fields.end(),
                     [](const std::string& field) { return is_number(trimmed(field)); });
}

TextLayout text_layout(const std::vector<std::string>& names, std::size_t count,
                       TextSeparator separator, const LogOptions& options,
                       const std::string& where) {
  return Chooser(names, count, options, where).layout(separator);
}

}  // namespace quadtune::internal
