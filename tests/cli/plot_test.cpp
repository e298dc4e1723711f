// SPDX-License-Identifier: Apache-2.0
/// --plot: the contents of pictures, and errors. These tests fail without gnuplot.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "quadtune/errors.hpp"
#include "report/plots/comparison_figure.hpp"
#include "report/plots/gnuplot.hpp"
#include "report/plots/loop_figure.hpp"
#include "report/plots/loop_panels.hpp"
#include "run_program.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using cli::Figure;
using cli::ForbiddenDisk;
using cli::LoopCurves;
using cli::Panel;
using cli::PictureFormat;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::ProgramResult;
using testing::run_program;
using testing::TemporaryDirectory;

const std::vector<std::string> kLoop = {"margins", "--num", "25", "--den", "1,10,10,10"};

std::vector<std::string> plotted(std::vector<std::string> args, const std::string& file) {
  args.insert(args.end(), {"--plot", file, "--quiet"});
  return args;
}

OpenLoop example_loop() {
  return OpenLoop(
      ContinuousTransferFunction{Eigen::VectorXd::Constant(1, 25), Eigen::Vector4d(1, 10, 10, 10)});
}

std::vector<LoopCurves> example_curves() {
  const OpenLoop loop = example_loop();
  return {cli::loop_curves(loop, loop_margins(loop), "loop")};
}

/// The two ends of the segment that marks a margin.
cli::Series mark_of(const Panel& panel) {
  const auto mark =
      std::find_if(panel.series.begin(), panel.series.end(),
                   [](const cli::Series& series) { return series.style == cli::kMarkStyle; });
  EXPECT_NE(mark, panel.series.end());
  return *mark;
}

/// Every element that is opened is closed, in order: enough XML for the output of gnuplot.
bool is_well_formed(const std::string& xml) {
  std::vector<std::string> open;
  for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    const std::size_t end = xml.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = xml.substr(at + 1, end - at - 1);
    if (tag.starts_with("?") || tag.starts_with("!") || tag.ends_with("/")) continue;
    const std::string name = tag.substr(0, tag.find_first_of(" \t\r\n"));
    if (!name.starts_with("/")) {
      open.push_back(name);
    } else {
      if (open.empty() || "/" + open.back() != name) return false;
      open.pop_back();
    }
  }
  return open.empty();
}

/// Not a matcher, which would print the whole picture.
bool says(const std::string& picture, const std::string& text) {
  return picture.find(text) != std::string::npos;
}

/// Sets an environment variable until the end of the test.
class Environment {
 public:
  Environment(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    ::setenv(name, value.c_str(), 1);
  }
  ~Environment() { ::setenv(name_, before_.c_str(), 1); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  const char* name_;
  std::string before_;
};

/// A directory whose gnuplot is this shell script.
std::string with_gnuplot(const TemporaryDirectory& folder, const std::string& script) {
  const std::filesystem::path file =
      folder.write("bin/gnuplot", "#!/bin/sh\nPATH=/usr/bin:/bin\n" + script);
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  return file.parent_path().string();
}

bool is_empty(const TemporaryDirectory& folder) { return std::filesystem::is_empty(folder.path()); }

TEST(Plot, DrawsAnSvgWithLabelsAndUnits) {
  const TemporaryDirectory folder;
  const ProgramResult result = run_program(plotted(kLoop, (folder.path() / "loop.svg").string()));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, run_program(kLoop).out);
  const std::string svg = folder.read("loop.svg");
  EXPECT_TRUE(is_well_formed(svg));
  for (const char* text :
       {"<svg", "Loop of num 25, den 1,10,10,10", "phase margin 29.1° at 1.78 rad/s", "time [s]",
        "frequency [rad/s]", "magnitude [dB]", "phase [deg]", "PM 29.1°", "GM 11.1 dB",
        "disk margin 0.458", "real part [1/s]", "Ms 2.49"})
    EXPECT_TRUE(says(svg, text)) << text;
  EXPECT_FALSE(says(svg, "nan"));
}

TEST(Plot, GivesTheSameBytesAgain) {
  const TemporaryDirectory folder;
  for (const char* name : {"a.svg", "b.svg", "a.png", "b.png"})
    ASSERT_EQ(run_program(plotted(kLoop, (folder.path() / name).string())).status, 0);
  EXPECT_TRUE(folder.read("a.svg") == folder.read("b.svg"));
  EXPECT_TRUE(folder.read("a.png") == folder.read("b.png"));
  EXPECT_TRUE(folder.read("a.png").starts_with("\x89PNG\r\n"));
}

/// The texts of a picture, in order.
std::vector<std::string> texts(const std::string& svg) {
  std::vector<std::string> found;
  for (std::size_t at = svg.find("<text>"); at != std::string::npos;
       at = svg.find("<text>", at + 1))
    found.push_back(svg.substr(at + 6, svg.find("</text>", at) - at - 6));
  return found;
}

// Another version of gnuplot writes other elements, but the same words and numbers.
TEST(Plot, TheOneInTheDocumentsIsWhatTheCommandDraws) {
  const TemporaryDirectory folder;
  ASSERT_EQ(run_program(plotted(kLoop, (folder.path() / "margins.svg").string())).status, 0);
  std::ifstream file(testing::source_folder() + "/docs/images/margins.svg");
  std::ostringstream document;
  document << file.rdbuf();
  EXPECT_THAT(texts(document.str()),
              ::testing::ElementsAreArray(texts(folder.read("margins.svg"))));
}

TEST(Plot, ReplacesAFileAndMakesADirectory) {
  const TemporaryDirectory folder;
  folder.write("new/loop.svg", "old");
  for (const char* name : {"new/loop.svg", "other/loop.svg"}) {
    ASSERT_EQ(run_program(plotted(kLoop, (folder.path() / name).string())).status, 0);
    EXPECT_TRUE(says(folder.read(name), "<svg"));
  }
}

TEST(Plot, OfPidShowsTheLoad) {
  const TemporaryDirectory folder;
  const std::string file = (folder.path() / "pid.svg").string();
  const ProgramResult result = run_program(
      {"pid", "--num", "1", "--den", "0.5,1", "--delay", "0.3", "--rule", "amigo", "--plot", file});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string svg = folder.read("pid.svg");
  EXPECT_TRUE(says(svg, "PID: Kp 0.95, Ki 2.13"));
  EXPECT_TRUE(says(svg, "Step of load at the plant's input"));
  EXPECT_TRUE(says(svg, "Open loop without its delay"));
}

TEST(Plot, OfACascadeShowsTheLoopsAtTheWrench) {
  const TemporaryDirectory folder;
  const std::string file = (folder.path() / "pid.svg").string();
  const ProgramResult result = run_program({"pid", "uquad", "--plot", file});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string svg = folder.read("pid.svg");
  EXPECT_TRUE(says(svg, "PID cascade of uquad every 0.005 s, cut at the wrench"));
  EXPECT_TRUE(says(svg, "tau_x"));
}

// Extreme loops: all of them can be drawn without a complaint of gnuplot.
TEST(Plot, DrawsExtremes) {
  const TemporaryDirectory folder;
  const std::string file = (folder.path() / "loop.svg").string();
  const std::vector<std::vector<std::string>> loops = {
      {"--num", "0", "--den", "1,1"},
      {"--num", "1", "--den", "1,0,0"},
      {"--num", "1e12", "--den", "1,1e9"},
      {"--num", "1e-9", "--den", "1,1e-9"},
      {"--num", "1,1", "--den", "1,2"},
      {"--num", "-0.5", "--den", "1,1"},
      {"--num", "1", "--den", "1,-1"},
      {"--num", "0.5", "--den", "1,0.5", "--dt", "1"},
      {"--num", "0.1", "--den", "1,-1", "--dt", "0.01", "--delay", "0.2"},
      {"--num", "2", "--den", "1,1,0", "--delay", "30"},
      {"--num", "1", "--den", "1,1", "--delay", "1e-6"}};
  for (std::vector<std::string> loop : loops) {
    loop.insert(loop.begin(), "margins");
    const ProgramResult result = run_program(plotted(loop, file));
    EXPECT_EQ(result.status, 0) << loop[2] << " / " << loop[4] << ": " << result.err;
    EXPECT_TRUE(is_well_formed(folder.read("loop.svg")));
  }
}

TEST(Plot, NamesWithMarkupStayText) {
  Figure figure{.title = "u_1 <&> 'x' {/Bold y} ^2 \\n",
                .subtitle = "",
                .panels = {{.title = "w_1", .x = {}, .y = {}, .series = {}}}};
  const std::string svg =
      cli::run_gnuplot(cli::gnuplot_script(figure, PictureFormat::svg), "test.svg");
  EXPECT_TRUE(is_well_formed(svg));
  EXPECT_TRUE(says(svg, "u_1 &lt;&amp;"));
  EXPECT_TRUE(says(svg, "{/Bold y} ^2"));
  EXPECT_TRUE(says(svg, "w_1"));
}

TEST(Plot, LeavesOutWhatIsNotFinite) {
  const double inf = std::numeric_limits<double>::infinity();
  const Figure figure{.title = "",
                      .subtitle = "",
                      .panels = {{.title = "",
                                  .x = {.logarithmic = true},
                                  .y = {},
                                  .series = {{.x = {-1, 0, 1, 2, 3},
                                              .y = {1, 1, std::nan(""), 2, inf},
                                              .style = cli::line_style(0)}}}}};
  const std::string script = cli::gnuplot_script(figure, PictureFormat::svg);
  EXPECT_THAT(script, HasSubstr("$p0s0 << EOD\n2 2\n\nEOD\n"));
  EXPECT_THAT(script, Not(HasSubstr("inf")));
  EXPECT_FALSE(cli::run_gnuplot(script, "test.svg").empty());
}

// Every panel labels its axes with units, and the legend is outside the axes.
TEST(Plot, ScriptHasOneLegendAPanelOutsideOfIt) {
  const OpenLoop loop = example_loop();
  const std::string script = cli::gnuplot_script(
      cli::margins_figure("title", loop, margins_report(loop, {"loop"})), PictureFormat::svg);
  EXPECT_THAT(script, HasSubstr("set multiplot layout 2,3 title 'title'.\"\\n\".'stable, "));
  EXPECT_THAT(script, HasSubstr("set key below"));
  EXPECT_THAT(script, HasSubstr("title 'GM 11.1 dB'"));
  EXPECT_THAT(script, HasSubstr("title 'PM 29.1°'"));
  for (const char* label : {"time [s]", "frequency [rad/s]", "magnitude [dB]", "phase [deg]"})
    EXPECT_THAT(script, HasSubstr(std::string("label '") + label + "'"));
  EXPECT_THAT(script, Not(HasSubstr("set label")));
}

TEST(Plot, APanelWithoutDataHasItsAxes) {
  const Figure figure{
      .title = "",
      .subtitle = "",
      .panels = {{.title = "empty", .x = {.label = "time [s]"}, .y = {}, .series = {{}}}}};
  const std::string svg =
      cli::run_gnuplot(cli::gnuplot_script(figure, PictureFormat::svg), "test.svg");
  EXPECT_TRUE(says(svg, "time [s]"));
}

// --- errors --------------------------------------------------------------------------------------

TEST(Plot, WithoutGnuplotNamesThePackage) {
  const TemporaryDirectory nothing;
  const TemporaryDirectory folder;
  const std::string file = (folder.path() / "loop.svg").string();
  const Environment path("PATH", nothing.path().string());
  const ProgramResult result = run_program(plotted(kLoop, file));
  EXPECT_EQ(result.status, 5);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(
      result.err,
      file +
          ": not drawn: gnuplot is not installed; install it, e.g. Debian's package gnuplot-nox\n");
  EXPECT_TRUE(is_empty(folder));
}

TEST(Plot, GivesTheReasonOfGnuplot) {
  const TemporaryDirectory bin;
  const TemporaryDirectory folder;
  const std::string file = (folder.path() / "loop.svg").string();
  const Environment path(
      "PATH",
      with_gnuplot(bin,
                   "echo half; cat >/dev/null; printf '\\n  ^\\n  line 3: no\\n\\n' >&2; exit 1"));
  const ProgramResult result = run_program(plotted(kLoop, file));
  EXPECT_EQ(result.status, 5);
  EXPECT_EQ(result.err, file + ": not drawn: gnuplot: line 3: no\n");
  EXPECT_TRUE(is_empty(folder));
}

// It does not read its input, which exceeds the buffer between the two processes.
TEST(Plot, OutlivesAGnuplotThatEnds) {
  const TemporaryDirectory bin;
  const Environment path("PATH", with_gnuplot(bin, "exit 0"));
  EXPECT_THROW((void)cli::run_gnuplot(std::string(4u << 20, '#'), "x.svg"), FileError);
  const Environment killed("PATH", with_gnuplot(bin, "kill -9 $$"));
  try {
    (void)cli::run_gnuplot("", "x.svg");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("ended by signal 9"));
  }
}

TEST(Plot, AnErrorOfGnuplotIsOneLine) {
  try {
    (void)cli::run_gnuplot("set terminal svg\nplot nothing\n", "x.svg");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("x.svg: not drawn: gnuplot: "));
    EXPECT_THAT(error.what(), HasSubstr("undefined variable"));
    EXPECT_THAT(error.what(), Not(HasSubstr("\n")));
  }
}

// --- data of the panels --------------------------------------------------------------------------

TEST(LoopPanels, MarkTheMarginsWhereTheyAre) {
  const std::vector<LoopCurves> curves = example_curves();
  const LoopMargins& margins = curves[0].margins;
  const cli::Series phase = mark_of(cli::phase_panel(curves));
  EXPECT_EQ(phase.x[0], margins.crossover);
  EXPECT_EQ(phase.x[1], margins.crossover);
  EXPECT_NEAR(phase.y[1], -180, 1e-6);
  EXPECT_NEAR(phase.y[0] - phase.y[1], margins.phase_margin * 180 / M_PI, 1e-9);
  const cli::Series gain = mark_of(cli::magnitude_panel(curves));
  EXPECT_NEAR(gain.x[0], margins.phase_crossovers[0].w, 1e-12);
  EXPECT_EQ(gain.y[0], 0);
  EXPECT_NEAR(gain.y[1], -20 * std::log10(margins.gain_margin), 1e-12);
}

TEST(LoopPanels, PhaseStartsWithTheIntegratorsAndDoesNotJump) {
  for (int integrators = 0; integrators <= 3; ++integrators) {
    Eigen::VectorXd den = Eigen::VectorXd::Zero(integrators + 2);
    den.head(2) << 1, 10;
    const OpenLoop loop(ContinuousTransferFunction{Eigen::VectorXd::Ones(1), den});
    const LoopCurves curves = cli::loop_curves(loop, loop_margins(loop), "");
    EXPECT_NEAR(curves.phase.front(), -90 * integrators, 10) << integrators;
    for (std::size_t i = 1; i < curves.phase.size(); ++i)
      ASSERT_LT(std::abs(curves.phase[i] - curves.phase[i - 1]), 45);
  }
}

TEST(LoopPanels, ForbiddenDiskHasTheEndsOfTheMargin) {
  using Kind = ForbiddenDisk::Kind;
  const DiskMargin disk = example_curves()[0].margins.disk;
  const ForbiddenDisk forbidden = cli::forbidden_disk(disk);
  EXPECT_EQ(forbidden.kind, Kind::inside);
  EXPECT_DOUBLE_EQ(forbidden.left, -1 / disk.gain_low);
  EXPECT_DOUBLE_EQ(forbidden.right, -1 / disk.gain_high);
  EXPECT_LT(forbidden.left, -1);
  EXPECT_GT(forbidden.right, -1);
  EXPECT_EQ(cli::forbidden_disk({}).kind, Kind::none);  // unstable
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(cli::forbidden_disk({2, 1, 0, inf, 0}).kind, Kind::half_plane);
}

// L touches the edge of the disk at the frequency of the margin, and never enters it.
TEST(LoopPanels, LTouchesTheForbiddenDisk) {
  const auto distance = [](const OpenLoop& loop, double w, const ForbiddenDisk& disk) {
    const double center = (disk.left + disk.right) / 2;
    return std::abs(loop.at(w)(0, 0) - center) - (disk.right - disk.left) / 2;
  };
  const OpenLoop inside = example_loop();
  const LoopCurves curves = example_curves()[0];
  const ForbiddenDisk disk = cli::forbidden_disk(curves.margins.disk);
  EXPECT_NEAR(distance(inside, curves.margins.disk.w, disk), 0, 1e-6);
  for (const double w : curves.w) EXPECT_GT(distance(inside, w, disk), -1e-9);
  // L = (s + 1)/(s + 2) stays stable with any large gain: everything outside a disk is allowed.
  const OpenLoop outside(ContinuousTransferFunction{Eigen::Vector2d(1, 1), Eigen::Vector2d(1, 2)});
  const LoopMargins margins = loop_margins(outside);
  const ForbiddenDisk all_but = cli::forbidden_disk(margins.disk);
  EXPECT_EQ(all_but.kind, ForbiddenDisk::Kind::outside);
  EXPECT_NEAR(distance(outside, margins.disk.w, all_but), 0, 1e-6);
  for (const double w : {0.0, 0.1, 1.0, 10.0}) EXPECT_LT(distance(outside, w, all_but), 1e-9);
}

TEST(LoopPanels, PoleMapHasAllPointsAndTheUnitCircle) {
  for (const double dt : {0.0, 0.01}) {
    Eigen::VectorXcd poles(4);
    poles.real() << -1000, -0.1, -0.1, 0.5;
    poles.imag() << 0, 3, -3, 0;
    const Panel panel = cli::pole_panel("", {{"pole", cli::cross_style(0), poles}}, dt);
    ASSERT_EQ(panel.series.size(), dt > 0 ? 2U : 1U);
    EXPECT_EQ(panel.series[0].x, std::vector<double>({-1000, -0.1, -0.1, 0.5}));
    EXPECT_EQ(panel.series[0].y, std::vector<double>({0, 3, -3, 0}));
    EXPECT_EQ(panel.equal, dt > 0);
  }
}

TEST(LoopPanels, PoleMapShowsWhatIsNearOne) {
  Eigen::VectorXcd poles(2);
  poles << std::complex(0.9, 0.05), std::complex(0.9, -0.05);
  const Panel panel = cli::pole_panel("", {{"pole", cli::cross_style(0), poles}}, 0.01);
  EXPECT_EQ(panel.x.range, "[0.865836:1.06708]");
  EXPECT_EQ(panel.y.range, "[-0.134164:0.134164]");
}

TEST(ComparisonFigure, HasEveryMethodInEveryPanel) {
  cli::Comparison comparison;
  comparison.title = "1/(s + 1) every 0.5 s";
  comparison.dt = 0.5;
  for (int k = 0; k <= 10; ++k) {
    comparison.times.push_back(0.5 * k);
    comparison.exact.push_back(1 - std::exp(-0.5 * k));
  }
  comparison.continuous = {comparison.times, comparison.exact};
  comparison.frequencies = {0.1, 1, 6};
  comparison.exact_poles = Eigen::VectorXcd::Constant(1, std::exp(-0.5));
  for (const double pole : {0.5, 0.6, 2.0 / 3}) {
    cli::SampledMethod method;
    method.name = "pole " + std::to_string(pole).substr(0, 4);
    for (int k = 0; k <= 10; ++k) method.outputs.push_back(1 - std::pow(pole, k));
    method.frequency_error = {0.01, 0.1, 0.5};
    method.poles = Eigen::VectorXcd::Constant(1, pole);
    comparison.methods.push_back(method);
  }
  const Figure figure = cli::comparison_figure(comparison);
  ASSERT_EQ(figure.panels.size(), 4U);
  for (const Panel& panel : figure.panels)
    for (const cli::SampledMethod& method : comparison.methods)
      EXPECT_EQ(
          std::count_if(panel.series.begin(), panel.series.end(),
                        [&](const cli::Series& series) { return series.name == method.name; }),
          1)
          << panel.title;
  EXPECT_FALSE(cli::run_gnuplot(cli::gnuplot_script(figure, PictureFormat::svg), "x.svg").empty());
}

}  // namespace
}  // namespace quadtune
