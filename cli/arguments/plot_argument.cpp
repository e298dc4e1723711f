// SPDX-License-Identifier: Apache-2.0
#include "arguments/plot_argument.hpp"

#include <filesystem>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "report/plots/gnuplot.hpp"

namespace quadtune::cli {
namespace {

std::string ending(const PlotArgument& argument) {
  return std::filesystem::path(argument.file).extension().string();
}

}  // namespace

void add_plot_option(CommandLine& line, PlotArgument& argument) {
  line.add_option("--plot FILE", argument.file,
                  "draw a picture with gnuplot: a name that ends in .svg or .png");
}

void require_picture(const PlotArgument& argument, const std::string& verb) {
  if (argument.file.empty() || ending(argument) == ".svg" || ending(argument) == ".png") return;
  refuse(verb, "--plot", "--plot is '{}', expected a name that ends in .svg or .png",
         argument.file);
}

void draw(const PlotArgument& argument, const std::function<report::Figure()>& figure,
          Context& context) {
  if (argument.file.empty()) return;
  const PictureFormat format = ending(argument) == ".png" ? PictureFormat::png : PictureFormat::svg;
  context.write(argument.file,
                run_gnuplot(gnuplot_script(figure(), format), argument.file, interrupted));
}

}  // namespace quadtune::cli
