// SPDX-License-Identifier: Apache-2.0
/// Pictures as data: panels with axes, curves and labels, and the gnuplot script that draws them.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace quadtune::report {

/// How a series is drawn.
enum class Shape { line, stairs, crosses, circles, dots, area };

/// What tells series apart: a colour that colour-blind people can tell from the others, and dashes.
struct Look {
  static constexpr int kInk = -1;    ///< black, for marks
  static constexpr int kFaint = -2;  ///< grey, for what is only there to compare with

  int color = 0;       ///< 0, 1, … of the palette, kInk or kFaint
  int dash = 0;        ///< 0 a full line, 1, … dashes
  double width = 3.5;  ///< [px]
};

/// The look of the i-th of several curves.
[[nodiscard]] Look nth_look(std::size_t i);

/// Points to draw. What is not finite, or not positive on a logarithmic axis, is left out; there a
/// line is broken.
struct Series {
  std::string name = {};  ///< in the legend; empty to leave it out there
  std::vector<double> x = {}, y = {};
  Shape shape = Shape::line;
  Look look = {};
};

/// A mark on an axis.
struct Tick {
  double at;
  std::string text;
};

struct Axis {
  std::string label = {};  ///< with its unit, e.g. "time [s]"
  bool logarithmic = false;
  std::optional<double> low = {}, high = {};  ///< where it ends; chosen from the data otherwise
  std::vector<Tick> ticks = {};               ///< chosen when empty
  double step = 0;  ///< of chosen ticks a multiple of this, e.g. 45 for degrees; 0 for any
};

/// A short text near a point, where it covers as little as can be.
struct Label {
  double x, y;
  std::string text;
};

struct Panel {
  std::string title;
  Axis x, y;
  std::vector<Series> series;
  std::vector<Label> labels = {};
  bool equal = false;  ///< one unit of x is as long as one of y; widens the shorter axis
};

struct Figure {
  std::string title;     ///< one line over all
  std::string subtitle;  ///< another, smaller; may be empty
  int columns = 3;
  bool shared_legend = false;  ///< one for all panels, each name once, above them; else one in each
  std::vector<Panel> panels;   ///< row by row
};

enum class PictureFormat { svg, png };

/// A script for run_gnuplot(). The same figure always gives the same script.
[[nodiscard]] std::string gnuplot_script(const Figure& figure, PictureFormat format);

}  // namespace quadtune::report
