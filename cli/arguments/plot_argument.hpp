// SPDX-License-Identifier: Apache-2.0
/// The option --plot FILE, which several verbs share.
#pragma once

#include <functional>
#include <string>

#include "report/plots/figure.hpp"

namespace quadtune::cli {

class CommandLine;

struct Context;

/// Where a picture goes; empty for none.
struct PlotArgument {
  std::string file;
};

/// Adds --plot FILE.
void add_plot_option(CommandLine& line, PlotArgument& argument);

/// To be called before any work.
/// @throws UsageError  for a file whose name ends otherwise than in .svg or .png
void require_picture(const PlotArgument& argument, const std::string& verb);

/// Draws the figure into the file, whole or not at all; without a file does nothing, and does not
/// ask for the figure.
/// @throws FileError   when gnuplot is missing or fails, or the file cannot be written
void draw(const PlotArgument& argument, const std::function<report::Figure()>& figure,
          Context& context);

}  // namespace quadtune::cli
