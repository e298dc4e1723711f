// SPDX-License-Identifier: Apache-2.0
// Comment lines, a line of column titles, rows. Comment lines are also valid CSV records, so that a
// spreadsheet splits them into fields. A text never spans several lines, because programs that skip
// comments do so line by line.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>

#include "logs/log_checks.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/logs/flight_log.hpp"

namespace quadtune {
namespace {

using internal::printable;

constexpr std::string_view kFirstLine = "# quadtune-log,1";
constexpr std::string_view kNote =
    "# note,units stand in brackets after the names; 1 is a count or a truth value; an empty field "
    "is no value";
constexpr std::size_t kMaxNumber = 24;  // -1.2345678901234567e-308

// --- writing ---

// Escapes control characters of `text`, and the characters in `also`, so that it fits on one line.
std::string escaped(std::string_view text, std::string_view also) {
  std::string line;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\\')
      line += "\\\\";
    else if (c == '\n')
      line += "\\n";
    else if (byte < 0x20 || byte == 0x7f || also.find(c) != std::string_view::npos)
      line += fmt::format("\\x{:02x}", byte);
    else
      line += c;
  }
  return line;
}

// A field of a record, quoted if necessary.
std::string field(std::string_view text) {
  if (text.find_first_of(",\"") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}

// '[' ends the name, and some readers treat '#' as the beginning of a comment even within a line.
std::string title(const LogColumn& column) {
  return field(escaped(column.name, "[#") + '[' + escaped(column.unit, "#") + ']');
}

// Writes a number without a final zero at `out`; returns the end.
char* write_number(double value, char* out) {
  return std::to_chars(out, out + kMaxNumber, value).ptr;
}

std::string number_text(double value) {
  char digits[kMaxNumber];
  return std::isnan(value) ? "nan" : std::string(digits, write_number(value, digits));
}

// --- reading ---

// A line and its location.
struct Line {
  std::string_view text;
  std::string where;
};

[[noreturn]] void refuse_number(std::string_view word, const std::string& where) {
  throw InvalidInput(
      where, fmt::format("'{}' is not a number in the range of a double; expected a number, or "
                         "an empty field",
                         printable(word)));
}

// Parses the number at the beginning of `rest` and removes it. Denormal numbers are accepted by
// GCC's parser, numbers that round to 0 or infinity are rejected.
std::optional<double> leading_number(std::string_view& rest) {
  double value = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (error != std::errc()) return std::nullopt;
  rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  return value;
}

double number(std::string_view word, const std::string& where) {
  std::string_view rest = word;
  const std::optional<double> value = leading_number(rest);
  if (!value || !rest.empty()) refuse_number(word, where);
  return *value;
}

std::string unescaped(std::string_view text, const std::string& where) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\') {
      plain += text[i];
      continue;
    }
    const std::string_view rest = text.substr(i + 1);
    unsigned byte = 0;
    if (rest.starts_with('\\') || rest.starts_with('n')) {
      plain += rest[0] == 'n' ? '\n' : '\\';
      i += 1;
    } else if (rest.size() >= 3 && rest[0] == 'x' &&
               std::from_chars(rest.data() + 1, rest.data() + 3, byte, 16).ptr == rest.data() + 3) {
      plain += static_cast<char>(byte);
      i += 3;
    } else {
      throw InvalidInput(
          where, fmt::format("'{}' is not an escape sequence, expected \\\\, \\n or \\x and "
                             "two hexadecimal digits",
                             printable(text.substr(i, 4))));
    }
  }
  return plain;
}

// Splits a record into fields; quotes are removed, escape sequences are not yet replaced.
std::vector<std::string> split(const Line& line) {
  std::vector<std::string> fields(1);
  for (std::size_t i = 0; i < line.text.size();) {
    std::string& last = fields.back();
    if (line.text[i] == '"' && last.empty()) {
      for (++i;; ++i) {
        const std::size_t quote = line.text.find('"', i);
        if (quote == std::string_view::npos)
          throw InvalidInput(line.where, "a quoted field has no closing quote");
        last.append(line.text, i, quote - i);
        i = quote + 1;
        if (i == line.text.size() || line.text[i] != '"') break;
        last += '"';
      }
      if (i < line.text.size() && line.text[i] != ',')
        throw InvalidInput(line.where,
                           "unexpected text after a quoted field, expected a "
                           "comma");
    } else {
      const std::size_t comma = std::min(line.text.find(',', i), line.text.size());
      last.append(line.text, i, comma - i);
      i = comma;
    }
    if (i == line.text.size()) break;
    fields.emplace_back();
    ++i;
  }
  return fields;
}

class Reader {
 public:
  Reader(std::string_view text, const std::string& origin) : rest_(text), origin_(origin) {}

  LogTable table() {
    read_comments();
    read_titles();
    while (!rest_.empty()) read_row(next_line());
    if (rows_ && *rows_ != table_.rows())
      throw InvalidInput(origin_, fmt::format("has {}, expected {} as its header states; is it cut "
                                              "short?",
                                              internal::counted(table_.rows(), "row"), *rows_));
    internal::require_log(table_, origin_);
    return std::move(table_);
  }

 private:
  std::string_view next_line() {
    ++number_;
    const std::size_t end = rest_.find('\n');
    if (end == std::string_view::npos)
      throw InvalidInput(where(),
                         "the line does not end, expected a line feed; is the file cut "
                         "short?");
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }

  [[nodiscard]] std::string where() const { return fmt::format("{}:{}", origin_, number_); }

  void read_comments() {
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";  // of some editors
    if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
    const std::string_view first = rest_.substr(0, rest_.find_first_of("\r\n"));
    if (first != kFirstLine)
      throw InvalidInput(origin_ + ":1", fmt::format("the file begins with '{}', expected '{}'",
                                                     printable(first), kFirstLine));
    next_line();
    while (rest_.starts_with('#')) {
      const std::string_view line = next_line();
      read_comment({line.substr(1), where()});
    }
  }

  void read_comment(const Line& line) {
    std::vector<std::string> fields = split(line);
    for (std::string& text : fields) text = unescaped(text, line.where);
    const std::string& kind = fields[0];
    const auto require_fields = [&](std::size_t count) {
      if (fields.size() != count)
        throw InvalidInput(line.where,
                           fmt::format("'{}' has {} fields, expected {}", printable(kind.substr(1)),
                                       fields.size(), count));
    };
    if (kind == " note") return;
    if (kind == " about") {
      require_fields(3);
      table_.about.emplace_back(fields[1], fields[2]);
    } else if (kind == " event") {
      require_fields(4);
      table_.events.push_back({number(fields[1], line.where), fields[2], fields[3]});
    } else if (kind == " rows") {
      require_fields(2);
      read_row_count(fields[1], line.where);
    } else {
      throw InvalidInput(
          line.where,
          fmt::format("'#{}' is not known, expected '# about', '# event', '# note' "
                      "or '# rows'{}",
                      printable(kind),
                      kind.empty() ? ""
                                   : internal::did_you_mean(
                                         "#" + kind, {"# about", "# event", "# note", "# rows"})));
    }
  }

  void read_row_count(const std::string& text, const std::string& place) {
    std::size_t rows = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, rows);
    if (rows_ || error != std::errc() || stop != end)
      throw InvalidInput(place, rows_ ? "the row count is given twice, expected once"
                                      : fmt::format("'{}' is not a row count", printable(text)));
    rows_ = rows;
  }

  void read_titles() {
    if (rest_.empty())
      throw InvalidInput(origin_,
                         "has no line of column names below the comments; is it cut "
                         "short?");
    const Line line{next_line(), where()};
    if (line.text.empty()) return;  // a log without columns
    for (const std::string& title : split(line)) {
      const std::size_t bracket = title.find('[');
      if (bracket == std::string::npos || !title.ends_with(']'))
        throw InvalidInput(line.where,
                           fmt::format("'{}' is not a column title, expected a name and its "
                                       "unit in brackets, such as x.px[m]",
                                       printable(title)));
      table_.columns.push_back(
          {unescaped(title.substr(0, bracket), line.where),
           unescaped(title.substr(bracket + 1, title.size() - bracket - 2), line.where),
           {}});
    }
  }

  void read_row(std::string_view row) {
    std::size_t count = 0;
    // Rest of the record after the last field: ",…"
    for (std::string_view rest = row;; rest.remove_prefix(1)) {
      double value = std::numeric_limits<double>::quiet_NaN();
      if (!rest.empty() && rest.front() != ',') {
        const std::string_view word = rest;
        const std::optional<double> read = leading_number(rest);
        if (!read || (!rest.empty() && rest.front() != ','))
          refuse_number(word.substr(0, word.find(',')), where());
        value = *read;
      }
      if (count < table_.columns.size()) table_.columns[count].values.push_back(value);
      ++count;
      if (rest.empty()) break;
    }
    if (count != table_.columns.size())
      throw InvalidInput(where(),
                         fmt::format("the row has {}, expected {} because there are as many names",
                                     internal::counted(count, "field"), table_.columns.size()));
  }

  std::string_view rest_;
  std::string origin_;
  std::size_t number_ = 0;  // number of the line that was read last
  std::optional<std::size_t> rows_;
  LogTable table_;
};

}  // namespace

std::string csv_of(const LogTable& table) {
  internal::require_log(table, "log");
  std::string text = fmt::format("{}\n{}\n# rows,{}\n", kFirstLine, kNote, table.rows());
  for (const auto& [key, value] : table.about)
    text += fmt::format("# about,{},{}\n", field(escaped(key, "")), field(escaped(value, "")));
  for (const LogEvent& event : table.events)
    text += fmt::format("# event,{},{},{}\n", number_text(event.time),
                        field(escaped(event.name, "")), field(escaped(event.detail, "")));
  const std::size_t columns = table.columns.size();
  for (std::size_t i = 0; i < columns; ++i) text += (i > 0 ? "," : "") + title(table.columns[i]);
  text += '\n';

  std::vector<char> row(columns * (kMaxNumber + 1));
  for (std::size_t i = 0; i < table.rows(); ++i) {
    char* end = row.data();
    for (std::size_t k = 0; k < columns; ++k) {
      if (k > 0) *end++ = ',';
      const double value = table.columns[k].values[i];
      if (!std::isnan(value)) end = write_number(value, end);
    }
    // Many readers skip empty lines, so a missing value alone in its row is written explicitly.
    if (end == row.data())
      text += "nan";
    else
      text.append(row.data(), end);
    text += '\n';
  }
  return text;
}

LogTable table_of_csv(const std::string& text, const std::string& origin) {
  return Reader(text, origin).table();
}

}  // namespace quadtune
