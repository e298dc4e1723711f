// SPDX-License-Identifier: Apache-2.0
#include "report/plots/loop_panels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "report/page/decimate.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {
namespace {

using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The phase crossovers that determine the gain margins: the nearest above and below.
std::vector<PhaseCrossover> smallest_gain_margins(const LoopMargins& margins) {
  std::vector<PhaseCrossover> all;
  for (const PhaseCrossover& at : margins.phase_crossovers)
    if (at.gain_margin == margins.gain_margin || at.gain_margin == margins.gain_reduction)
      all.push_back(at);
  return all;
}

/// The frequencies where |S| or |T| peaks and where L crosses 1 or -180 degrees; if there are none,
/// the modes of the loop [rad/s].
std::vector<double> landmarks(const OpenLoop& loop, const LoopMargins& margins) {
  constexpr double kLevel = 1.01;  // a maximum of |S| or |T| up to this value is not a peak
  std::vector<double> all;
  if (margins.Ms > kLevel) all.push_back(margins.w_Ms);
  if (margins.Mt > kLevel) all.push_back(margins.w_Mt);
  for (const GainCrossover& at : margins.gain_crossovers) all.push_back(at.w);
  for (const PhaseCrossover& at : smallest_gain_margins(margins)) all.push_back(at.w);
  const auto is_none = [](double w) { return !(w > 0) || !std::isfinite(w); };
  std::erase_if(all, is_none);
  if (!all.empty()) return all;
  for (const Eigen::VectorXcd& roots : {loop.poles(), loop.closed_loop_poles()})
    for (const Complex& root : roots)
      all.push_back(std::abs(loop.discrete() ? std::log(root) / loop.dt() : root));
  std::erase_if(all, is_none);
  return all.empty() ? std::vector<double>{1} : all;
}

/// The range of frequencies: a decade beyond the landmarks on both sides, landmarks included.
std::vector<double> frequencies(const OpenLoop& loop, const LoopMargins& margins) {
  constexpr int kEven = 400;
  const std::vector<double> marks = landmarks(loop, margins);
  const auto [first, last] = std::minmax_element(marks.begin(), marks.end());
  const double nyquist = loop.discrete() ? kPi / loop.dt() : kInfinity;
  const double low = std::min(*first / 10, nyquist / 10);
  const double high = std::min(*last * 10, nyquist);
  std::vector<double> all = frequency_grid(loop);
  all.insert(all.end(), marks.begin(), marks.end());
  for (int i = 0; i <= kEven; ++i) all.push_back(low * std::pow(high / low, double(i) / kEven));
  std::erase_if(all, [&](double w) { return w < low || w > high; });
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

/// The phase at the lowest frequency [deg]: as many quarter turns downward as the slope of |L|
/// indicates, and half a turn more if the gain is negative.
double first_phase(const LoopCurves& curves) {
  const double here = degrees(std::arg(curves.L.front()));
  if (curves.w.size() < 2) return here;
  const double slope =
      std::log(std::abs(curves.L[1] / curves.L[0])) / std::log(curves.w[1] / curves.w[0]);
  const double expected = std::isfinite(slope) ? 90 * slope : 0;
  const double turns = std::round((here - expected) / 360 - 1e-6);
  const double phase = here - 360 * turns;
  return phase - expected > 120 ? phase - 360 : phase;
}

void unwrap(LoopCurves& curves) {
  curves.phase = {first_phase(curves)};
  for (std::size_t i = 1; i < curves.L.size(); ++i) {
    double turn = degrees(std::arg(curves.L[i] / curves.L[i - 1]));
    if (turn > 179) turn -= 360;  // it decreases past a pole on the axis
    curves.phase.push_back(curves.phase.back() + turn);
  }
}

const LoopCurves& worst(const std::vector<LoopCurves>& loops) {
  return *std::min_element(loops.begin(), loops.end(),
                           [](const LoopCurves& a, const LoopCurves& b) {
                             return a.margins.disk.alpha < b.margins.disk.alpha;
                           });
}

/// "11.1"; "0.0" for a negative value that rounds to zero.
std::string tenths(double value) {
  return fmt::format("{:.1f}", std::round(10 * value) / 10 + 0.0);
}

/// " (name)" of the worst loop if there are several.
std::string whose(const std::vector<LoopCurves>& loops) {
  return loops.size() > 1 ? fmt::format(" ({})", worst(loops).name) : "";
}

/// The value at the frequency of the curve that is nearest to w.
std::size_t nearest(const LoopCurves& curves, double w) {
  const auto at = std::lower_bound(curves.w.begin(), curves.w.end(), w * (1 - 1e-12));
  return std::min(static_cast<std::size_t>(at - curves.w.begin()), curves.w.size() - 1);
}

/// A panel over frequency with one curve for each loop; other panels state the names.
template <typename Value>  // of the curves of a loop at an index
Panel over_frequency(const std::string& title, const Axis& y, const std::vector<LoopCurves>& loops,
                     const Value& value) {
  double low = kInfinity;
  double high = 0;
  Panel panel{.title = title, .x = {}, .y = y, .series = {}};
  for (const LoopCurves& curves : loops) {
    low = std::min(low, curves.w.front());
    high = std::max(high, curves.w.back());
    Series series{.x = curves.w, .style = line_style(panel.series.size())};
    for (std::size_t i = 0; i < curves.w.size(); ++i) series.y.push_back(value(curves, i));
    panel.series.push_back(std::move(series));
  }
  panel.x = {.label = "frequency [rad/s]",
             .logarithmic = true,
             .range = fmt::format("[{:.6g}:{:.6g}]", low, high)};
  return panel;
}

Series circle(double center, double radius, const std::string& style) {
  constexpr int kArc = 180;
  Series series{.style = style};
  for (int i = 0; i <= kArc; ++i) {
    series.x.push_back(center + radius * std::cos(2 * kPi * i / kArc));
    series.y.push_back(radius * std::sin(2 * kPi * i / kArc));
  }
  return series;
}

/// The edge of the disk and the side on which L remains; nothing without a margin.
std::vector<Series> edge_of(const ForbiddenDisk& disk) {
  constexpr const char* kEdge = "lines lw 2 lc rgb '#D55E00'";
  constexpr const char* kArea =
      "filledcurves closed fc rgb '#D55E00' fs transparent solid 0.22 border lc rgb '#D55E00'";
  constexpr double kFar = 100;  // a larger circle is drawn as a straight line
  const double center = disk.left + (disk.right - disk.left) / 2;
  const bool outside = disk.kind == ForbiddenDisk::Kind::outside;
  if (disk.kind == ForbiddenDisk::Kind::none) return {};
  if (!outside && disk.left < -kFar)
    return {{"L stays to the right", {disk.right, disk.right}, {-kFar, kFar}, kEdge}};
  Series edge = circle(center, disk.right - center, outside ? kEdge : kArea);
  edge.name = outside ? "L stays inside" : "L stays outside";
  return {edge};
}

struct TimeUnit {
  double seconds;
  const char* name;
};

TimeUnit time_unit(double duration) {
  if (duration < 1e-6) return {1e-9, "ns"};
  if (duration < 1e-3) return {1e-6, "µs"};
  if (duration < 1) return {1e-3, "ms"};
  return {1, "s"};
}

}  // namespace

void add_level(Panel& panel, const std::vector<double>& x, double value) {
  panel.series.push_back({.x = {x.front(), x.back()}, .y = {value, value}, .style = kFaintStyle});
}

LoopCurves loop_curves(const OpenLoop& loop, const LoopMargins& margins, const std::string& name) {
  LoopCurves curves;
  curves.name = name;
  curves.margins = margins;
  for (const double w : frequencies(loop, margins)) {
    const Complex L = loop.at(w)(0, 0);
    if (!std::isfinite(L.real()) || !std::isfinite(L.imag()) || L == 0.0) continue;
    curves.w.push_back(w);
    curves.L.push_back(L);
    curves.S.push_back(loop.sensitivity(w)(0, 0));
  }
  if (curves.w.empty()) {  // a loop that is 0 is a line at the bottom
    curves.w = {0.1, 10};
    curves.L = {1e-12, 1e-12};
    curves.S = {1, 1};
  }
  unwrap(curves);
  const Complex at_rest = loop.at(0)(0, 0);
  const bool finite = std::isfinite(at_rest.real()) && std::isfinite(at_rest.imag());
  curves.at_rest = finite ? at_rest : curves.L.front();
  return curves;
}

Panel step_panel(const std::string& title, const std::string& output,
                 const std::vector<NamedResponse>& responses) {
  constexpr double kMaxSteps = 400;
  constexpr std::size_t kMaxPoints = 1000;
  double duration = 0;
  for (const NamedResponse& named : responses)
    if (!named.response.t.empty()) duration = std::max(duration, named.response.t.back());
  const TimeUnit unit = time_unit(duration);
  Panel panel{.title = title,
              .x = {.label = fmt::format("time [{}]", unit.name),
                    .range = fmt::format("[0:{:.6g}]", duration > 0 ? duration / unit.seconds : 1)},
              .y = {.label = output},
              .series = {}};
  for (const NamedResponse& named : responses) {
    const bool steps = named.dt > 0 && duration < kMaxSteps * named.dt;
    const std::size_t i = panel.series.size();
    Decimated shown = decimate(named.response.t, {&named.response.y}, kMaxPoints);
    panel.series.push_back({.name = responses.size() > 1 ? named.name : "",
                            .x = std::move(shown.time),
                            .y = std::move(shown.values[0]),
                            .style = steps ? step_style(i) : line_style(i)});
    for (double& t : panel.series.back().x) t /= unit.seconds;
  }
  return panel;
}

Panel magnitude_panel(const std::vector<LoopCurves>& loops) {
  const Axis y{.label = "magnitude [dB]", .range = "[-100<*<-10:10<*<100]", .tick = 20};
  Panel panel = over_frequency(
      "Bode magnitude of L", y, loops,
      [](const LoopCurves& curves, std::size_t i) { return decibels(std::abs(curves.L[i])); });
  add_level(panel, loops[0].w, 0);
  for (const PhaseCrossover& at : smallest_gain_margins(worst(loops).margins))
    panel.series.push_back(
        {.name = fmt::format("GM {} dB", tenths(decibels(at.gain_margin))) + whose(loops),
         .x = {at.w, at.w},
         .y = {0, -decibels(at.gain_margin)},
         .style = kMarkStyle});
  return panel;
}

Panel phase_panel(const std::vector<LoopCurves>& loops) {
  constexpr double kLowest = -900;  // [deg]; the phase of a delay is unbounded
  double lowest = 0;
  for (const LoopCurves& curves : loops)
    lowest = std::min(lowest, *std::min_element(curves.phase.begin(), curves.phase.end()));
  const double turns = std::max(lowest, kLowest) / 360;
  const Axis y{.label = "phase [deg]",
               .range = fmt::format("[{}<*<-190:-90<*]", kLowest),
               .tick = 45 * std::ceil(-turns)};
  Panel panel =
      over_frequency("Bode phase of L", y, loops,
                     [](const LoopCurves& curves, std::size_t i) { return curves.phase[i]; });
  add_level(panel, loops[0].w, -180);
  const LoopCurves& of = worst(loops);
  const double w = of.margins.crossover;
  if (!(w > 0)) return panel;
  const double phase = of.phase[nearest(of, w)];
  // Down to -180 degrees, or up to it if too much lead destabilizes the loop.
  const auto& all = of.margins.gain_crossovers;
  const auto at = std::find_if(all.begin(), all.end(),
                               [&](const GainCrossover& crossover) { return crossover.w == w; });
  const double turn = at == all.end() ? of.margins.phase_margin : at->phase_margin;
  panel.series.push_back(
      {.name = fmt::format("PM {}°", tenths(degrees(of.margins.phase_margin))) + whose(loops),
       .x = {w, w},
       .y = {phase, phase - degrees(turn)},
       .style = kMarkStyle});
  return panel;
}

Panel sensitivity_panel(const std::vector<LoopCurves>& loops) {
  const bool one = loops.size() == 1;
  // On the stability boundary the peak is unbounded.
  const Axis y{.label = one ? "|S|, |T|" : "|S|", .logarithmic = true, .range = "[0.01:2<*<1e3]"};
  Panel panel =
      over_frequency(one ? "Sensitivity S and its complement T" : "Sensitivity S", y, loops,
                     [](const LoopCurves& curves, std::size_t i) { return std::abs(curves.S[i]); });
  for (std::size_t k = 0; k < loops.size(); ++k)
    panel.series[k].name =
        fmt::format("{}, Ms {:.3g}", one ? "|S|" : loops[k].name, loops[k].margins.Ms);
  if (one) {
    const LoopCurves& curves = loops[0];
    Series T{.name = fmt::format("|T|, Mt {:.3g}", curves.margins.Mt),
             .x = curves.w,
             .style = line_style(1)};
    for (std::size_t i = 0; i < curves.S.size(); ++i)
      T.y.push_back(std::abs(curves.S[i] * curves.L[i]));
    panel.series.push_back(std::move(T));
  }
  add_level(panel, loops[0].w, 1);
  return panel;
}

ForbiddenDisk forbidden_disk(const DiskMargin& disk) {
  using Kind = ForbiddenDisk::Kind;
  if (!(disk.alpha > 0)) return {};
  if (disk.gain_low < 0)  // factors outside a circle, which include 0 and all large ones
    return {Kind::outside, -disk.gain_low, -1 / disk.gain_low};
  if (disk.gain_low == 0) return {Kind::half_plane, -kInfinity, -1 / disk.gain_high};
  return {Kind::inside, -1 / disk.gain_low, -1 / disk.gain_high};
}

Panel nyquist_panel(const std::vector<LoopCurves>& loops) {
  const LoopCurves& of = worst(loops);
  const ForbiddenDisk disk = forbidden_disk(of.margins.disk);
  Panel panel{.title = disk.kind == ForbiddenDisk::Kind::none
                           ? "Nyquist"
                           : fmt::format("Nyquist, disk margin {:.3f}", of.margins.disk.alpha) +
                                 whose(loops),
              .x = {.label = "real part of L", .range = "[-3<*<-1.5:1.2<*<3]", .tick = 1},
              .y = {.label = "imaginary part of L", .range = "[-3<*<-1.2:1.2<*<3]", .tick = 1},
              .series = edge_of(disk),
              .equal = true};
  panel.series.push_back(circle(0, 1, kFaintStyle));
  for (std::size_t k = 0; k < loops.size(); ++k) {
    const LoopCurves& curves = loops[k];
    Series positive{
        .x = {curves.at_rest.real()}, .y = {curves.at_rest.imag()}, .style = line_style(k)};
    for (const Complex& L : curves.L) {
      positive.x.push_back(L.real());
      positive.y.push_back(L.imag());
    }
    Series negative{.x = positive.x, .y = positive.y, .style = line_style(k, 1)};
    for (double& y : negative.y) y = -y;
    panel.series.push_back(std::move(positive));
    panel.series.push_back(std::move(negative));
  }
  panel.series.push_back({.name = "-1", .x = {-1}, .y = {0}, .style = cross_style(6)});
  return panel;
}

Panel pole_panel(const std::string& title, const std::vector<PointSet>& sets, double dt) {
  constexpr double kNear = 0.4;  // distance from z = 1
  Panel panel{.title = title,
              .x = {.label = "real part [1/s]", .range = "[*:0<*]"},
              .y = {.label = "imaginary part [rad/s]"},
              .series = {}};
  double far = 0;
  for (const PointSet& set : sets) {
    Series series{.name = set.name, .style = set.style};
    for (const Complex& point : set.points) {
      far = std::max(far, std::abs(point - 1.0));
      series.x.push_back(point.real());
      series.y.push_back(point.imag());
    }
    panel.series.push_back(std::move(series));
  }
  if (dt == 0) return panel;
  panel.equal = far == 0 || far > kNear;
  panel.x.label = "real part of z";
  panel.y.label = "imaginary part of z";
  panel.series.push_back(circle(0, 1, kFaintStyle));
  if (!panel.equal) {
    panel.x.range = fmt::format("[{:.6g}:{:.6g}]", 1 - 1.2 * far, 1 + 0.6 * far);
    panel.y.range = fmt::format("[{:.6g}:{:.6g}]", -1.2 * far, 1.2 * far);
  }
  return panel;
}

}  // namespace quadtune::report
