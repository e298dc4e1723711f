// SPDX-License-Identifier: Apache-2.0
/// Pictures as panels with axes and curves, and the gnuplot script that draws them.
#pragma once

#include <string>
#include <vector>

namespace quadtune::report {

/// Points to draw. Points that are not finite are omitted; a line has a gap there.
struct Series {
  std::string name = {};  ///< name in the legend; empty: not in the legend
  std::vector<double> x = {}, y = {};
  std::string style = {};  ///< the style after gnuplot's `with`, e.g. one of those below
};

/// The style of the i-th of several curves, in colours that colour-blind readers can distinguish.
[[nodiscard]] std::string line_style(std::size_t i, double width = 2.5);
[[nodiscard]] std::string step_style(std::size_t i);
[[nodiscard]] std::string cross_style(std::size_t i);
[[nodiscard]] std::string circle_style(std::size_t i);
/// For curves that serve only as a comparison.
inline constexpr const char* kFaintStyle = "lines lw 2 dt 3 lc rgb '#8C8C8C'";
/// For marks on a curve.
inline constexpr const char* kMarkStyle = "linespoints lw 2.5 pt 7 ps 0.8 lc rgb '#000000'";

struct Axis {
  std::string label = {};  ///< with its unit, e.g. "time [s]"
  bool logarithmic = false;
  std::string range = "[*:*]";  ///< in the syntax of gnuplot's xrange; * is chosen from the data
  double tick = 0;              ///< spacing of the ticks; 0: gnuplot chooses it
};

struct Panel {
  std::string title;
  Axis x, y;
  std::vector<Series> series;
  bool equal = false;  ///< whether the units of x and y have equal length
};

struct Figure {
  std::string title;     ///< a line above all panels
  std::string subtitle;  ///< a second line; may be empty
  int columns = 3;
  std::vector<Panel> panels;  ///< row by row
};

enum class PictureFormat { svg, png };

/// A script for run_gnuplot(). It depends only on the figure.
[[nodiscard]] std::string gnuplot_script(const Figure& figure, PictureFormat format);

}  // namespace quadtune::report
