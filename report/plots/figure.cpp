// SPDX-License-Identifier: Apache-2.0
#include "report/plots/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace quadtune::report {
namespace {

const char* color(std::size_t i) {
  constexpr std::array<const char*, 7> kPalette = {
      // Okabe and Ito 2008
      "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"};
  return kPalette[i % kPalette.size()];
}

/// Quotes a text for gnuplot. In single quotes only the quote itself is special.
std::string in_quotes(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += '\'';
    result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return result + "'";
}

std::string terminal(PictureFormat format) {
  constexpr const char* kCommon = "size 1600,1000 noenhanced background '#ffffff'";
  if (format == PictureFormat::svg)
    return fmt::format("set terminal svg {} font 'sans-serif,18' name 'quadtune'\n", kCommon);
  // This terminal uses points; a point is three to four pixels.
  return fmt::format("set terminal pngcairo {} font 'Sans,18' fontscale 0.75\n", kCommon);
}

/// An empty line below the label of the x axis keeps it clear of the legend.
std::string axis_script(char axis, const Axis& a) {
  return fmt::format(
             "{1} logscale {0}\nset format {0} '%g'\nset {0}range {2}\nset {0}tics nomirror out "
             "{3}\n",
             axis, a.logarithmic ? "set" : "unset", a.range,
             a.tick > 0 ? fmt::format("{:g}", a.tick) : "autofreq") +
         fmt::format("set {}label {}{}\n", axis, in_quotes(a.label), axis == 'x' ? ".\"\\n\"" : "");
}

bool shows(const Axis& axis, double value) {
  return std::isfinite(value) && (!axis.logarithmic || value > 0);
}

/// The points as a data block of gnuplot, with an empty line for a gap; empty without points.
std::string data_of(const Series& series, const Panel& panel) {
  std::string text;
  const std::size_t count = std::min(series.x.size(), series.y.size());
  for (std::size_t i = 0; i < count; ++i) {
    if (shows(panel.x, series.x[i]) && shows(panel.y, series.y[i]))
      text += fmt::format("{:.7g} {:.7g}\n", series.x[i], series.y[i]);
    else if (!text.empty())
      text += "\n";
  }
  return text;
}

std::string panel_script(const Panel& panel, std::size_t number) {
  std::string text =
      fmt::format("set title {}\nset size {}\n{} offsets{}\n", in_quotes(panel.title),
                  panel.equal ? "ratio -1" : "noratio", panel.equal ? "set" : "unset",
                  panel.equal ? " graph 0.05,graph 0.05,graph 0.05,graph 0.05" : "");
  text += axis_script('x', panel.x) + axis_script('y', panel.y);
  std::string plots;
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    const Series& series = panel.series[i];
    const std::string data = data_of(series, panel);
    if (data.empty()) continue;
    const std::string name = fmt::format("$p{}s{}", number, i);
    text += fmt::format("{} << EOD\n{}EOD\n", name, data);
    plots += fmt::format("{}{} with {} {}", plots.empty() ? "" : ", ", name, series.style,
                         series.name.empty() ? "notitle" : "title " + in_quotes(series.name));
  }
  if (!plots.empty()) return text + "plot " + plots + "\n";
  return text + "set xrange [1:2]\nset yrange [1:2]\nplot NaN notitle\n";  // axes without data
}

}  // namespace

std::string line_style(std::size_t i, double width) {
  return fmt::format("lines lw {:g} dt {} lc rgb '{}'", width, i % 5 + 1, color(i));
}

std::string step_style(std::size_t i) { return fmt::format("steps lw 2.5 lc rgb '{}'", color(i)); }

std::string cross_style(std::size_t i) {
  return fmt::format("points pt 2 ps 1.4 lw 2.5 lc rgb '{}'", color(i));
}

std::string circle_style(std::size_t i) {
  return fmt::format("points pt 6 ps 1.4 lw 2.5 lc rgb '{}'", color(i));
}

std::string gnuplot_script(const Figure& figure, PictureFormat format) {
  const std::size_t count = std::max<std::size_t>(figure.panels.size(), 1);
  const auto columns = static_cast<std::size_t>(std::max(figure.columns, 1));
  std::string title = in_quotes(figure.title);
  if (!figure.subtitle.empty()) title += ".\"\\n\"." + in_quotes(figure.subtitle);
  std::string text = "set encoding utf8\n" + terminal(format);
  text += fmt::format("set multiplot layout {},{} title {}\n", (count + columns - 1) / columns,
                      columns, title);
  text +=
      "set border 3 lc rgb '#404040'\nset grid lt 1 lc rgb '#E4E4E4'\nset zeroaxis lc rgb "
      "'#8C8C8C'\n"
      "set key below samplen 3.5 reverse Left\nset clip two\n";
  for (std::size_t i = 0; i < figure.panels.size(); ++i) text += panel_script(figure.panels[i], i);
  return text + "unset multiplot\n";
}

}  // namespace quadtune::report
