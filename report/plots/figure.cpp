// SPDX-License-Identifier: Apache-2.0
#include "report/plots/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "quadtune/internal/joined.hpp"
#include "report/plots/label_placement.hpp"

namespace quadtune::report {
namespace {

// All sizes are pixels of a picture of this size.
constexpr double kWidth = 1600;
constexpr double kHeight = 1000;
constexpr double kFont = 20;
constexpr double kSmallFont = 18;
constexpr double kTitleBand = 48;
constexpr double kSubtitleBand = 40;
constexpr double kLegendRow = 31;
constexpr std::size_t kMostInRow = 5;

/// What one character takes, and one line: a little more than in the usual sans-serif fonts.
constexpr double kCharacter = 0.62;
constexpr double kLine = 1.35;

double text_width(const std::string& text, double font = kFont) {
  const auto characters = std::count_if(  // of UTF-8, bytes that start one
      text.begin(), text.end(),
      [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
  return kCharacter * font * static_cast<double>(characters);
}

/// For gnuplot: single quotes keep everything as it is but themselves.
std::string in_quotes(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += '\'';
    result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return result + "'";
}

std::string digits(double value) { return fmt::format("{:.9g}", value == 0 ? 0.0 : value); }

// Okabe and Ito 2008.
constexpr std::array<const char*, 7> kPalette = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                 "#E69F00", "#56B4E9", "#000000"};
constexpr std::array<const char*, 5> kDashes = {"solid", "(16,7)", "(4,5)", "(16,6,4,6)", "(28,8)"};

std::string color(int index) {
  if (index == Look::kInk) return "#000000";
  if (index == Look::kFaint) return "#8C8C8C";
  return kPalette[static_cast<std::size_t>(index) % kPalette.size()];
}

// --- axes ----------------------------------------------------------------------------------------

/// An axis with its ends, and how values lie between them.
struct Scale {
  double low, high;
  bool logarithmic;

  /// 0 at the low end, 1 at the high one.
  [[nodiscard]] double operator()(double value) const {
    if (!logarithmic) return (value - low) / (high - low);
    return std::log(value / low) / std::log(high / low);
  }
  [[nodiscard]] bool shows(double value) const {
    return std::isfinite(value) && (!logarithmic || value > 0);
  }
};

void widen(Scale& scale, double factor) {
  const double middle = scale.low + (scale.high - scale.low) / 2;
  const double half = factor * (scale.high - scale.low) / 2;
  scale.low = middle - half;
  scale.high = middle + half;
}

/// The ends that are given, or those of the data with some room.
Scale scale_of(const Axis& axis, const std::vector<Series>& all,
               std::vector<double> Series::*values) {
  Scale scale{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
              axis.logarithmic};
  for (const Series& series : all) {
    for (const double value : series.*values) {
      if (!scale.shows(value)) continue;
      scale.low = std::min(scale.low, value);
      scale.high = std::max(scale.high, value);
    }
  }
  if (!(scale.low <= scale.high)) scale.low = scale.high = 1;  // no data
  if (axis.logarithmic) {
    if (!(scale.high > 1.001 * scale.low)) scale = {scale.low / 3, scale.high * 3, true};
  } else if (!(scale.high - scale.low >
               1e-9 * std::max(std::abs(scale.low), std::abs(scale.high)))) {
    const double room = scale.low == 0 ? 1 : 0.5 * std::abs(scale.low);
    scale = {scale.low - room, scale.high + room, false};
  } else {
    widen(scale, 1.12);
  }
  scale.low = axis.low.value_or(scale.low);
  scale.high = axis.high.value_or(scale.high);
  return scale;
}

std::vector<Tick> decades(const Scale& scale, double most) {
  const double first = std::ceil(std::log10(scale.low) - 1e-9);
  const double last = std::floor(std::log10(scale.high) + 1e-9);
  const double stride = std::max(1.0, std::ceil((last - first + 1) / most));
  const double span = std::log10(scale.high / scale.low);
  std::vector<double> mantissas = {1};
  if (span < 3.2) mantissas = {1, 3};
  if (span < 1.4) mantissas = {1, 2, 5};
  std::vector<Tick> ticks;
  const auto count = static_cast<int>((last - first) / stride) + 2;
  for (int i = -1; i <= count; ++i) {
    const double exponent = first + i * stride;
    for (const double mantissa : mantissas) {
      const double at = mantissa * std::pow(10, exponent);
      if (at < scale.low * (1 - 1e-9) || at > scale.high * (1 + 1e-9)) continue;
      ticks.push_back({at, std::abs(exponent) <= 3 ? fmt::format("{:.4g}", at)
                                                   : fmt::format("{:g}e{:g}", mantissa, exponent)});
    }
  }
  return ticks;
}

/// A round number: 1, 2 or 5 times a power of ten, or a doubled `unit`.
double round_step(double wanted, double unit) {
  if (unit > 0) {
    double step = unit;
    while (step < wanted) step *= 2;
    return step;
  }
  const double decade = std::pow(10, std::floor(std::log10(wanted)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * decade >= wanted * (1 - 1e-9)) return factor * decade;
  return 10 * decade;
}

std::vector<Tick> linear_ticks(const Scale& scale, double most, double unit) {
  const double span = scale.high - scale.low;
  const double step = round_step(span / most, span < 2.5 * unit ? 0 : unit);
  std::vector<Tick> ticks;
  const double first = std::ceil(scale.low / step - 1e-9);
  const auto count = static_cast<int>(std::floor(scale.high / step + 1e-9) - first) + 1;
  for (int i = 0; i < std::min(count, 50); ++i) {
    const double at = (first + i) * step;
    ticks.push_back({at, fmt::format("{:.6g}", at == 0 ? 0.0 : at)});
  }
  return ticks;
}

std::vector<Tick> ticks_of(const Axis& axis, const Scale& scale, double most) {
  if (!axis.ticks.empty()) return axis.ticks;
  return axis.logarithmic ? decades(scale, most) : linear_ticks(scale, most, axis.step);
}

std::string tick_list(const std::vector<Tick>& ticks) {
  std::string text;
  for (const Tick& tick : ticks)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", in_quotes(tick.text), digits(tick.at));
  return "(" + text + ")";
}

// --- one panel -----------------------------------------------------------------------------------

/// The rectangle within the axes [px], from the picture's lower left corner.
struct Room {
  double left, right, bottom, top;
};

/// A panel with everything chosen.
struct Layout {
  Room room;
  Scale x, y;
  std::vector<Tick> x_ticks, y_ticks;
  double room_for_ticks;  ///< [px] left of the y axis
};

constexpr double kMostX = 5;  // ticks
constexpr double kMostY = 6;

/// What the texts of the y axis' ticks take [px].
double tick_room(const Panel& panel) {
  double widest = 30;
  for (const Tick& tick : ticks_of(panel.y, scale_of(panel.y, panel.series, &Series::y), kMostY))
    widest = std::max(widest, text_width(tick.text));
  return widest;
}

/// @param room_for_ticks  [px] of the panels above and below, so that they are in line
Layout lay_out(const Panel& panel, const Room& cell, double room_for_ticks) {
  Layout layout{cell,
                scale_of(panel.x, panel.series, &Series::x),
                scale_of(panel.y, panel.series, &Series::y),
                {},
                {},
                room_for_ticks};
  layout.room.left += 3.3 * kFont + room_for_ticks;
  layout.room.right -= 1.7 * kFont;
  layout.room.bottom += 4.1 * kFont;
  layout.room.top -= 2.3 * kFont;
  if (panel.equal) {
    const double x_unit = (layout.room.right - layout.room.left) / (layout.x.high - layout.x.low);
    const double y_unit = (layout.room.top - layout.room.bottom) / (layout.y.high - layout.y.low);
    widen(x_unit > y_unit ? layout.x : layout.y, std::max(x_unit / y_unit, y_unit / x_unit));
  }
  layout.x_ticks = ticks_of(panel.x, layout.x, kMostX);
  layout.y_ticks = ticks_of(panel.y, layout.y, kMostY);
  return layout;
}

/// The points of a series as they lie in the panel.
struct Point {
  double x, y;
  Spot spot;
};

/// True of three points beyond the same edge, far enough that no line between them is seen.
bool beyond(const Spot& a, const Spot& b, const Spot& c) {
  constexpr double kFar = 0.5;
  const auto all = [](double p, double q, double r) {
    return std::max({p, q, r}) < -kFar || std::min({p, q, r}) > 1 + kFar;
  };
  return all(a.x, b.x, c.x) || all(a.y, b.y, c.y);
}

double distance(const Spot& point, const Spot& from, const Spot& to) {
  const double x = to.x - from.x;
  const double y = to.y - from.y;
  const double length = std::hypot(x, y);
  if (length == 0) return std::hypot(point.x - from.x, point.y - from.y);
  return std::abs(x * (point.y - from.y) - y * (point.x - from.x)) / length;
}

/// The points without which the line would be seen to be another one, so that files stay small:
/// Douglas and Peucker 1973.
std::vector<Point> simplified(const std::vector<Point>& line) {
  constexpr double kSeen = 0.0004;  // of the panel, less than a fifth of a pixel
  if (line.size() < 3) return line;
  std::vector<bool> kept(line.size(), false);
  kept.front() = kept.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> open = {{0, line.size() - 1}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    double farthest = kSeen;
    std::size_t at = first;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double d = distance(line[i].spot, line[first].spot, line[last].spot);
      if (!(d > farthest)) continue;
      farthest = d;
      at = i;
    }
    if (at == first) continue;
    kept[at] = true;
    open.emplace_back(first, at);
    open.emplace_back(at, last);
  }
  std::vector<Point> result;
  result.reserve(line.size());
  for (std::size_t i = 0; i < line.size(); ++i)
    if (kept[i]) result.push_back(line[i]);
  return result;
}

/// Without the points that are out of sight.
std::vector<Point> in_sight(const std::vector<Point>& line) {
  std::vector<Point> result;
  result.reserve(line.size());
  for (std::size_t i = 0; i < line.size(); ++i) {
    // Beside the last one kept, so that what is drawn instead is out of sight, too.
    const bool inner = i > 0 && i + 1 < line.size();
    if (!inner || !beyond(result.back().spot, line[i].spot, line[i + 1].spot))
      result.push_back(line[i]);
  }
  return result;
}

/// Stretches without a gap.
std::vector<std::vector<Point>> stretches(const Series& series, const Layout& layout) {
  std::vector<std::vector<Point>> all(1);
  const std::size_t count = std::min(series.x.size(), series.y.size());
  for (std::size_t i = 0; i < count; ++i) {
    const double x = series.x[i];
    const double y = series.y[i];
    if (layout.x.shows(x) && layout.y.shows(y))
      all.back().push_back({x, y, {layout.x(x), layout.y(y)}});
    else if (!all.back().empty())
      all.emplace_back();
  }
  if (all.back().empty()) all.pop_back();
  if (series.shape == Shape::line)
    for (std::vector<Point>& line : all) line = simplified(in_sight(line));
  return all;
}

std::string data_block(const std::string& name, const std::vector<std::vector<Point>>& lines) {
  std::string text = fmt::format("${} << EOD\n", name);
  for (const std::vector<Point>& line : lines) {
    for (const Point& point : line)
      text += fmt::format("{} {}\n", digits(point.x), digits(point.y));
    text += "\n";
  }
  return text + "EOD\n";
}

std::string drawn(const Series& series, PictureFormat format) {
  // The terminals differ in what a point of size 1 is.
  const bool svg = format == PictureFormat::svg;
  const double mark = svg ? 1.4 : 1.7;
  const double dot = svg ? 0.65 : 1.1;
  const std::string ink = fmt::format("lc rgb '{}'", color(series.look.color));
  const std::string line =
      fmt::format("lw {} dt {} {}", series.look.width,
                  kDashes[static_cast<std::size_t>(series.look.dash) % kDashes.size()], ink);
  switch (series.shape) {
    case Shape::line:
      return "with lines " + line;
    case Shape::stairs:
      return "with steps " + line;
    case Shape::crosses:
      return fmt::format("with points pt 2 ps {:g} lw 3 {}", mark, ink);
    case Shape::circles:
      return fmt::format("with points pt 6 ps {:g} lw 2.5 {}", mark, ink);
    case Shape::dots:
      return fmt::format("with points pt 7 ps {:g} {}", dot, ink);
    case Shape::area:
      break;
  }
  return fmt::format("with filledcurves closed fc rgb '{}' fs transparent solid 0.22 noborder",
                     color(series.look.color));
}

/// A text in the middle of this point of the picture [px].
std::string text_at(const std::string& text, double x, double y, double font = kFont,
                    const std::string& how = "") {
  if (text.empty()) return "";
  return fmt::format("set label {} at screen {:.5f},{:.5f} center {} font ',{}'\n", in_quotes(text),
                     x / kWidth, y / kHeight, how, font);
}

/// Title and names of the axes. The terminals place their own at different distances.
std::string axis_texts(const Panel& panel, const Layout& layout) {
  const Room& room = layout.room;
  const double x = (room.left + room.right) / 2;
  const double y = (room.bottom + room.top) / 2;
  return text_at(panel.title, x, room.top + 1.1 * kFont) +
         text_at(panel.x.label, x, room.bottom - 3.1 * kFont) +
         text_at(panel.y.label, room.left - layout.room_for_ticks - 2.1 * kFont, y, kFont,
                 "rotate by 90");
}

/// Size of the legend in the panel; empty without names.
Spot legend_size(const Panel& panel, const Room& room) {
  double widest = 0;
  double lines = 0;
  for (const Series& series : panel.series) {
    if (series.name.empty()) continue;
    widest = std::max(widest, text_width(series.name, kSmallFont));
    ++lines;
  }
  if (lines == 0) return {0, 0};
  return {(widest + 4 * kSmallFont) / (room.right - room.left),
          (lines * kLine * kSmallFont + 6) / (room.top - room.bottom)};
}

std::string legend(const Panel& panel, const Room& room, Placement& placement) {
  const Spot size = legend_size(panel, room);
  if (size.y == 0) return "unset key\n";
  const Box box = placement.in_corner(size.x, size.y);
  return fmt::format(
      "set key at graph {:.4f},{:.4f} left top Left reverse samplen 2.2 spacing 1.15 opaque font "
      "',{}'\n",
      box.x, box.y + box.height, kSmallFont);
}

std::string labels(const Panel& panel, const Layout& layout, Placement& placement) {
  std::string text;
  for (const Label& label : panel.labels) {
    if (!layout.x.shows(label.x) || !layout.y.shows(label.y)) continue;
    const Spot anchor{layout.x(label.x), layout.y(label.y)};
    if (anchor.x < 0 || anchor.x > 1 || anchor.y < 0 || anchor.y > 1) continue;
    const double width =
        text_width(label.text, kSmallFont) / (layout.room.right - layout.room.left);
    const double height = kLine * kSmallFont / (layout.room.top - layout.room.bottom);
    const Box box = placement.beside(anchor, width, height);
    text += fmt::format(
        "set object rectangle from graph {:.4f},{:.4f} to graph {:.4f},{:.4f} front fc rgb "
        "'#ffffff' fs solid noborder\n"
        "set label {} at graph {:.4f},{:.4f} center front font ',{}'\n",
        box.x, box.y, box.x + box.width, box.y + box.height, in_quotes(label.text),
        box.x + box.width / 2, box.y + box.height / 2, kSmallFont);
  }
  return text;
}

std::string panel_script(const Panel& panel, const Layout& layout, std::size_t number,
                         PictureFormat format, bool with_legend) {
  const Room& room = layout.room;
  std::string text = fmt::format(
      "unset label\nunset object\nset lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\n"
      "set bmargin at screen {:.5f}\nset tmargin at screen {:.5f}\n",
      room.left / kWidth, room.right / kWidth, room.bottom / kHeight, room.top / kHeight);
  text += axis_texts(panel, layout);
  text += fmt::format("{} logscale x\n{} logscale y\n", panel.x.logarithmic ? "set" : "unset",
                      panel.y.logarithmic ? "set" : "unset");
  text += fmt::format(
      "set xrange [{}:{}]\nset yrange [{}:{}]\nset xtics nomirror out scale 0.5 {}\nset ytics "
      "nomirror out scale 0.5 {}\n",
      digits(layout.x.low), digits(layout.x.high), digits(layout.y.low), digits(layout.y.high),
      tick_list(layout.x_ticks), tick_list(layout.y_ticks));
  Placement placement;
  std::string blocks;
  std::string plots = "NaN notitle";  // so that a panel without data has its axes
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    const Series& series = panel.series[i];
    const std::vector<std::vector<Point>> lines = stretches(series, layout);
    if (lines.empty()) continue;
    for (const std::vector<Point>& line : lines) {
      std::vector<Spot> spots;
      spots.reserve(line.size());
      for (const Point& at : line) spots.push_back(at.spot);
      placement.avoid(spots);
    }
    const std::string name = fmt::format("p{}s{}", number, i);
    blocks += data_block(name, lines);
    plots += fmt::format(", ${} using 1:2 {} {}", name, drawn(series, format),
                         series.name.empty() ? "notitle" : "title " + in_quotes(series.name));
  }
  text += labels(panel, layout, placement);
  text += with_legend ? legend(panel, room, placement) : "unset key\n";
  return text + blocks + "plot " + plots + "\n";
}

/// The legend entries of an empty plot: of all panels, each name once.
std::vector<std::string> shared_entries(const Figure& figure, PictureFormat format) {
  std::vector<std::string> seen;
  std::vector<std::string> entries;
  for (const Panel& panel : figure.panels) {
    for (const Series& series : panel.series) {
      if (series.name.empty() || std::find(seen.begin(), seen.end(), series.name) != seen.end())
        continue;
      seen.push_back(series.name);
      Series entry = series;
      if (entry.shape == Shape::stairs) entry.shape = Shape::line;
      entries.push_back(
          fmt::format(", keyentry {} title {}", drawn(entry, format), in_quotes(entry.name)));
    }
  }
  return entries;
}

std::string terminal(PictureFormat format) {
  const std::string size =
      fmt::format("size {},{} noenhanced background '#ffffff'", kWidth, kHeight);
  if (format == PictureFormat::svg)
    return fmt::format("set terminal svg {} font 'sans-serif,{}' name 'quadtune'\n", size, kFont);
  // This terminal counts in points, of which there are three to four of a pixel.
  return fmt::format("set terminal pngcairo {} font 'Sans,{}' fontscale 0.75\n", size, kFont);
}

}  // namespace

Look nth_look(std::size_t i) {
  const int n = static_cast<int>(i);
  return {n, n, 3.5};
}

std::string gnuplot_script(const Figure& figure, PictureFormat format) {
  std::string text = "set encoding utf8\n" + terminal(format);
  text +=
      "set multiplot\n"
      "set grid xtics ytics lw 1 lc rgb '#D0D0D0'\nset clip two\n";
  text += text_at(figure.title, kWidth / 2, kHeight - 26, 1.15 * kFont);
  double top = kHeight - kTitleBand;
  if (!figure.subtitle.empty()) {
    text += text_at(figure.subtitle, kWidth / 2, top - 14);
    top -= kSubtitleBand;
  }
  std::vector<std::string> entries;
  std::string key = "unset key\n";
  if (figure.shared_legend) {
    entries = shared_entries(figure, format);
    const std::size_t rows_of_key = (entries.size() + kMostInRow - 1) / kMostInRow;
    key = fmt::format(
        "set key at screen 0.5,{:.5f} center top horizontal Left reverse maxrows {} samplen "
        "2.2 width 1 font ',{}'\n",
        top / kHeight, rows_of_key, kSmallFont);
    top -= kLegendRow * static_cast<double>(rows_of_key);
  }
  const auto columns = static_cast<std::size_t>(std::max(figure.columns, 1));
  const std::size_t rows = (figure.panels.size() + columns - 1) / columns;
  const double width = kWidth / static_cast<double>(columns);
  const double height = top / static_cast<double>(std::max<std::size_t>(rows, 1));
  std::vector<double> room_for_ticks(columns, 0);
  for (std::size_t i = 0; i < figure.panels.size(); ++i)
    room_for_ticks[i % columns] =
        std::max(room_for_ticks[i % columns], tick_room(figure.panels[i]));
  // The titles are labels of an empty plot: multiplot's own would move the panels.
  text += key +
          "unset border\nunset tics\nset xrange [0:1]\nset yrange [0:1]\nset margins 0,0,0,0\n"
          "plot NaN notitle" +
          fmt::format("{}", internal::joined(entries, "")) +
          "\nset border 15 lw 1.5 lc rgb '#404040'\nset tics nomirror out scale 0.5\n";
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const double left = width * static_cast<double>(i % columns);
    const std::size_t row = i / columns;
    const double upper = top - height * static_cast<double>(row);
    const Layout layout = lay_out(figure.panels[i], {left, left + width, upper - height, upper},
                                  room_for_ticks[i % columns]);
    text += panel_script(figure.panels[i], layout, i, format, !figure.shared_legend);
  }
  return text + "unset multiplot\n";
}

}  // namespace quadtune::report
