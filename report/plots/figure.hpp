// SPDX-License-Identifier: Apache-2.0
/// Pictures as panels with axes and curves, and the gnuplot script that draws them.
#pragma once

#include <string>
#include <vector>

namespace quadtune::report {

/// Points to draw. Those that are not finite are left out; a line has a gap there.
struct Series {
  std::string name = {};  ///< in the legend; empty to leave it out there
  std::vector<double> x = {}, y = {};
  std::string style = {};  ///< as behind gnuplot's `with`, e.g. one of those below
};

/// The style of the i-th of several curves, in colours that colour-blind people can tell apart.
[[nodiscard]] std::string line_style(std::size_t i, double width = 2.5);
[[nodiscard]] std::string step_style(std::size_t i);
[[nodiscard]] std::string cross_style(std::size_t i);
[[nodiscard]] std::string circle_style(std::size_t i);
/// For what is only there to compare with.
inline constexpr const char* kFaintStyle = "lines lw 2 dt 3 lc rgb '#8C8C8C'";
/// For what a curve is marked with.
inline constexpr const char* kMarkStyle = "linespoints lw 2.5 pt 7 ps 0.8 lc rgb '#000000'";

struct Axis {
  std::string label = {};  ///< with its unit, e.g. "time [s]"
  bool logarithmic = false;
  std::string range = "[*:*]";  ///< as gnuplot's xrange: * is chosen from the data
  double tick = 0;              ///< distance of the ticks; 0: gnuplot chooses
};

struct Panel {
  std::string title;
  Axis x, y;
  std::vector<Series> series;
  bool equal = false;  ///< one unit of x is as long as one of y
};

struct Figure {
  std::string title;     ///< one line over all
  std::string subtitle;  ///< another one; may be empty
  int columns = 3;
  std::vector<Panel> panels;  ///< row by row
};

enum class PictureFormat { svg, png };

/// A script for run_gnuplot(). The same figure always gives the same script.
[[nodiscard]] std::string gnuplot_script(const Figure& figure, PictureFormat format);

}  // namespace quadtune::report
