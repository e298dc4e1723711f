// SPDX-License-Identifier: Apache-2.0
#include "report/text/fold_text.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

#include "quadtune/internal/utf8.hpp"

namespace quadtune::report {
namespace {

/// A line as a list of characters, each of which takes one column of the terminal.
using Line = std::vector<std::string_view>;

Line line_of(std::string_view text) {
  Line line;
  while (!text.empty()) {
    const std::size_t length = internal::first_character(text).length;
    line.push_back(text.substr(0, length));
    text.remove_prefix(length);
  }
  return line;
}

bool is_blank(const Line& line, std::size_t at) { return at >= line.size() || line[at] == " "; }

std::string text_of(const Line& line, std::size_t begin, std::size_t end) {
  std::string text;
  for (std::size_t i = begin; i < end; ++i) text += i < line.size() ? line[i] : " ";
  return text;
}

void trim(std::string& text) { text.erase(text.find_last_not_of(' ') + 1); }

struct FoldedColumn {
  std::size_t begin, end;
};

/// The text between runs of two or more blanks.
std::vector<FoldedColumn> columns_of(const std::vector<bool>& blank) {
  std::vector<FoldedColumn> columns;
  for (std::size_t i = 0; i < blank.size(); ++i) {
    if (blank[i]) continue;
    if (!columns.empty() && i < columns.back().end + 2)
      columns.back().end = i + 1;
    else
      columns.push_back({i, i + 1});
  }
  return columns;
}

std::vector<bool> blanks_of(const Line& line) {
  std::vector<bool> blank(line.size());
  for (std::size_t i = 0; i < line.size(); ++i) blank[i] = is_blank(line, i);
  return blank;
}

std::vector<bool> common_blanks(std::vector<bool> blank, const Line& line) {
  if (line.size() > blank.size()) blank.resize(line.size(), true);
  for (std::size_t i = 0; i < line.size(); ++i) blank[i] = blank[i] && is_blank(line, i);
  return blank;
}

/// The indent of continuation lines: below the text if the line has a heading.
std::size_t hanging_indent(const Line& line, std::size_t width) {
  std::size_t start = 0;
  while (start < line.size() && is_blank(line, start)) ++start;
  for (std::size_t i = start; i + 2 < line.size() && i < width / 2; ++i)
    if (!is_blank(line, i) && is_blank(line, i + 1) && is_blank(line, i + 2)) {
      std::size_t text = i + 1;
      while (text < line.size() && is_blank(line, text)) ++text;
      if (text < width / 2) return text;
    }
  return std::min(start + 2, width / 2);
}

void append_wrapped(const Line& line, std::size_t width, std::string& text) {
  const std::size_t indent = hanging_indent(line, width);
  std::size_t begin = 0;
  for (std::size_t room = width; line.size() - begin > room; room = width - indent) {
    // Breaks at the last blank that lets the line fit, or after the first word that does not fit.
    std::size_t end = begin + room;
    const std::size_t first = begin == 0 ? indent : begin;
    while (end > first && !is_blank(line, end)) --end;
    if (end <= first) {
      end = begin + room;
      while (end < line.size() && !is_blank(line, end)) ++end;
    }
    std::string row = text_of(line, begin, end);
    trim(row);
    text += row + "\n";
    begin = end;
    while (begin < line.size() && is_blank(line, begin)) ++begin;
    if (begin == line.size()) return;
    text.append(indent, ' ');
  }
  text += text_of(line, begin, line.size()) + "\n";
}

/// Lines that share their columns.
struct Table {
  std::size_t begin, end;
  std::vector<bool> blank;
};

/// The table around line `k`, not before line `least`. A line that starts in the first column among
/// lines that do not is the heading of a section: a table ends before it.
Table table_around(const std::vector<Line>& lines, std::size_t k, std::size_t min) {
  Table table{k, k + 1, blanks_of(lines[k])};
  if (columns_of(table.blank).size() < 3) return table;
  const auto is_heading = [&](std::size_t i) {
    return !lines[i].empty() && !is_blank(lines[i], 0);
  };
  const auto joins = [&](const Line& line) {
    if (columns_of(blanks_of(line)).size() < 3) return false;
    std::vector<bool> both = common_blanks(table.blank, line);
    const std::size_t columns = columns_of(both).size();
    // A line that is not part of the table would fill the gaps between columns.
    if (columns < 3 || 4 * columns < 3 * columns_of(table.blank).size()) return false;
    table.blank = std::move(both);
    return true;
  };
  const bool below_heading = !is_heading(table.end - 1);
  while (table.end < lines.size() &&
         !(is_heading(table.end) && (below_heading || !is_heading(table.end - 1))) &&
         joins(lines[table.end]))
    ++table.end;
  const bool indented = !is_heading(table.end - 1);
  while (table.begin > min && !(indented && is_heading(table.begin)) &&
         joins(lines[table.begin - 1]))
    --table.begin;
  return table;
}

void append_folded(const std::vector<Line>& lines, const Table& table, std::size_t width,
                   std::string& text) {
  const std::vector<FoldedColumn> columns = columns_of(table.blank);
  // A heading is in the first line only.
  bool heading = table.end - table.begin > 1;
  for (std::size_t k = table.begin + 1; k < table.end; ++k)
    for (std::size_t i = 0; i < columns[0].end; ++i) heading = heading && is_blank(lines[k], i);
  const std::size_t names = heading ? 1 : 0;  // the column of the rows' names
  std::size_t next = names + 1;
  while (next < columns.size()) {
    const std::size_t first = next;
    std::size_t used = columns[names].end;
    while (next < columns.size() &&
           (next == first || used + 2 + columns[next].end - columns[next].begin <= width)) {
      used += 2 + columns[next].end - columns[next].begin;
      ++next;
    }
    if (first > names + 1) text += "\n";
    for (std::size_t k = table.begin; k < table.end; ++k) {
      std::string row = text_of(lines[k], 0, columns[names].end);
      if (heading && first > names + 1)
        row = std::string(columns[0].end, ' ') +
              text_of(lines[k], columns[0].end, columns[names].end);
      for (std::size_t c = first; c < next; ++c)
        row += "  " + text_of(lines[k], columns[c].begin, columns[c].end);
      trim(row);
      append_wrapped(line_of(row), width, text);
    }
  }
}

}  // namespace

std::string folded(const std::string& text, std::size_t width) {
  if (width == 0) return text;
  std::vector<Line> lines;
  const bool ends_open = !text.empty() && text.back() != '\n';
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(line_of(std::string_view(text).substr(begin, end - begin)));
    begin = end + 1;
  }
  std::string result;
  std::size_t done = 0;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (k < done || lines[k].size() <= width) continue;
    const Table table = table_around(lines, k, done);
    const bool folds = table.end - table.begin > 1 && columns_of(table.blank).size() > 2;
    const std::size_t begin = folds ? table.begin : k;
    for (; done < begin; ++done) append_wrapped(lines[done], width, result);
    if (folds)
      append_folded(lines, table, width, result);
    else
      append_wrapped(lines[k], width, result);
    done = folds ? table.end : k + 1;
  }
  for (; done < lines.size(); ++done) append_wrapped(lines[done], width, result);
  if (ends_open) result.pop_back();
  return result;
}

}  // namespace quadtune::report
