// SPDX-License-Identifier: Apache-2.0
/// The option --plot FILE, which several verbs share.
#pragma once

#include <functional>
#include <string>

#include "report/plots/figure.hpp"

namespace quadtune::cli {

class CommandLine;

struct Context;

/// The file of a picture; empty if none is requested.
struct PlotArgument {
  std::string file;
};

/// Adds --plot FILE.
void add_plot_option(CommandLine& line, PlotArgument& argument);

/// Validates the file name. Call it before any work.
/// @throws UsageError  if the name does not end in .svg or .png
void require_picture(const PlotArgument& argument);

/// Draws the figure and writes it completely or not at all. Without a file it does nothing and does
/// not compute the figure.
/// @throws FileError   if gnuplot is missing or fails, or the file cannot be written
void draw(const PlotArgument& argument, const std::function<report::Figure()>& figure,
          Context& context);

}  // namespace quadtune::cli
