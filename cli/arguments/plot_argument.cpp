// SPDX-License-Identifier: Apache-2.0
#include "arguments/plot_argument.hpp"

#include <filesystem>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "report/plots/figure_data.hpp"
#include "report/plots/gnuplot.hpp"

namespace quadtune::cli {
namespace {

std::string ending(const PlotArgument& argument) {
  return std::filesystem::path(argument.file).extension().string();
}

bool is_data(const PlotArgument& argument) {
  return ending(argument) == ".csv" || ending(argument) == ".json";
}

}  // namespace

void add_plot_option(CommandLine& line, PlotArgument& argument) {
  line.add_option(
      "--plot FILE", argument.file,
      "draw a picture with gnuplot: a name that ends in .svg or .png; with .csv or .json, "
      "write its curves as numbers");
}

void require_picture(const PlotArgument& argument) {
  if (argument.file.empty() || ending(argument) == ".svg" || ending(argument) == ".png" ||
      is_data(argument))
    return;
  refuse("--plot", "--plot is '{}', expected a name that ends in .svg, .png, .csv or .json",
         argument.file);
}

void draw(const PlotArgument& argument, const std::function<report::Figure()>& figure,
          Context& context) {
  if (argument.file.empty()) return;
  if (is_data(argument)) {
    context.write(argument.file,
                  ending(argument) == ".csv" ? figure_csv(figure()) : figure_json(figure()));
    return;
  }
  const PictureFormat format = ending(argument) == ".png" ? PictureFormat::png : PictureFormat::svg;
  context.write(argument.file,
                run_gnuplot(gnuplot_script(figure(), format), argument.file, interrupted));
}

}  // namespace quadtune::cli
