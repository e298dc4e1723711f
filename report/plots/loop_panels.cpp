// SPDX-License-Identifier: Apache-2.0
#include "report/plots/loop_panels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "report/text/print.hpp"

namespace quadtune::report {
namespace {

using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;

// --- which frequencies ---------------------------------------------------------------------------

/// Whether the largest value of |S| or |T| is more than where it is level.
bool is_peak(double largest) { return largest > 1.01; }

/// The phase crossovers whose gains are the margins: the nearest above and below.
std::vector<PhaseCrossover> least_gain_margins(const LoopMargins& margins) {
  std::vector<PhaseCrossover> all;
  for (const PhaseCrossover& at : margins.phase_crossovers)
    if (at.gain_margin == margins.gain_margin || at.gain_margin == margins.gain_reduction)
      all.push_back(at);
  return all;
}

/// The frequencies that the margins speak of [rad/s].
std::vector<double> marked_frequencies(const LoopMargins& margins) {
  std::vector<double> all;
  all.reserve(margins.gain_crossovers.size() + 4);
  if (is_peak(margins.Ms)) all.push_back(margins.w_Ms);
  if (is_peak(margins.Mt)) all.push_back(margins.w_Mt);
  for (const GainCrossover& at : margins.gain_crossovers) all.push_back(at.w);
  for (const PhaseCrossover& at : least_gain_margins(margins)) all.push_back(at.w);
  std::erase_if(all, [](double w) { return !(w > 0) || !std::isfinite(w); });
  return all;
}

/// How fast the modes of the open and of the closed loop are [rad/s].
std::vector<double> corners(const OpenLoop& loop) {
  std::vector<double> all;
  for (const Eigen::VectorXcd& roots : {loop.poles(), loop.closed_loop_poles()}) {
    for (const Complex& root : roots) {
      const double w = std::abs(loop.discrete() ? std::log(root) / loop.dt() : root);
      if (w > 0 && std::isfinite(w)) all.push_back(w);
    }
  }
  return all;
}

struct Range {
  double low, high;
};

/// What there is to see: a decade beyond the crossovers and peaks, and what corners come near them.
Range shown_frequencies(const OpenLoop& loop, const LoopMargins& margins) {
  constexpr double kNear = 30;  // a corner within this factor is shown
  std::vector<double> seen = marked_frequencies(margins);
  const std::vector<double> modes = corners(loop);
  if (seen.empty()) seen = modes;
  if (seen.empty()) seen = {1};
  const double nyquist =
      loop.discrete() ? kPi / loop.dt() : std::numeric_limits<double>::infinity();
  const auto [first, last] = std::minmax_element(seen.begin(), seen.end());
  Range range{*first, *last};
  const Range near{range.low / kNear, range.high * kNear};
  for (const double w : modes) {
    if (w < near.low || w > near.high) continue;
    range.low = std::min(range.low, w);
    range.high = std::max(range.high, w);
  }
  range.low = std::min(range.low / 8, nyquist / 10);
  range.high = std::min(range.high * 8, nyquist);
  return range;
}

constexpr int kEven = 400;  ///< frequencies besides those of the grid

std::vector<double> frequencies(const OpenLoop& loop, const LoopMargins& margins) {
  const Range range = shown_frequencies(loop, margins);
  std::vector<double> all = frequency_grid(loop);
  all.reserve(all.size() + kEven + 1 + margins.gain_crossovers.size() + 4);
  // The grid ends where this range does not, if a pole lies at 0.
  for (int i = 0; i <= kEven; ++i)
    all.push_back(range.low * std::pow(range.high / range.low, double(i) / kEven));
  for (const double w : marked_frequencies(margins)) all.push_back(w);
  std::erase_if(all, [&](double w) { return w < range.low || w > range.high; });
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

/// The phase at the slow end [deg]: as many quarter turns as the slope of |L| says, half a turn
/// more of a negative gain, downwards.
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
  curves.phase.reserve(curves.L.size());
  for (std::size_t i = 0; i < curves.L.size(); ++i) {
    if (i == 0) {
      curves.phase.push_back(first_phase(curves));
      continue;
    }
    double turn = degrees(std::arg(curves.L[i] / curves.L[i - 1]));
    if (turn > 179) turn -= 360;  // past a pole on the axis it falls
    curves.phase.push_back(curves.phase.back() + turn);
  }
}

// --- marks ---------------------------------------------------------------------------------------

const LoopCurves& worst(const std::vector<LoopCurves>& loops) {
  return *std::min_element(loops.begin(), loops.end(),
                           [](const LoopCurves& a, const LoopCurves& b) {
                             return a.margins.disk.alpha < b.margins.disk.alpha;
                           });
}

/// A title that says whose margins are marked, where there are several loops.
std::string with_name(const std::string& title, const std::vector<LoopCurves>& loops) {
  return loops.size() > 1 ? fmt::format("{}, marks of {}", title, worst(loops).name) : title;
}

/// "11.1", and "0.0" for what rounds to it from below.
std::string tenths(double value) {
  return fmt::format("{:.1f}", std::round(10 * value) / 10 + 0.0);
}

constexpr double kLeastPhase = -900;  // [deg] below which a delay is not followed

Look mark_look() { return {Look::kInk, 0, 2.5}; }
Look faint_look() { return {Look::kFaint, 2, 2}; }

/// A segment from one height to another at x, with dots at its ends.
void mark(Panel& panel, double x, double from, double to, const std::string& text) {
  panel.series.push_back({.x = {x, x}, .y = {from, to}, .look = mark_look()});
  panel.series.push_back({.x = {x, x}, .y = {from, to}, .shape = Shape::dots, .look = mark_look()});
  panel.labels.push_back({x, from + (to - from) / 2, text});
}

void level(Panel& panel, const LoopCurves& curves, double value) {
  panel.series.push_back(
      {.x = {curves.w.front(), curves.w.back()}, .y = {value, value}, .look = faint_look()});
}

/// The value at the frequency of the curve that is nearest to w.
std::size_t nearest(const LoopCurves& curves, double w) {
  const auto at = std::lower_bound(curves.w.begin(), curves.w.end(), w * (1 - 1e-12));
  const auto i = static_cast<std::size_t>(at - curves.w.begin());
  return std::min(i, curves.w.size() - 1);
}

bool shown(const LoopCurves& curves, double w) {
  return w >= curves.w.front() && w <= curves.w.back();
}

Axis frequency_axis(const std::vector<LoopCurves>& loops) {
  Axis axis{.label = "frequency [rad/s]", .logarithmic = true};
  double low = loops[0].w.front();
  double high = loops[0].w.back();
  for (const LoopCurves& curves : loops) {
    low = std::min(low, curves.w.front());
    high = std::max(high, curves.w.back());
  }
  axis.low = low;
  axis.high = high;
  return axis;
}

/// Ends of a set of values, no further than the limits.
Range ends(const std::vector<LoopCurves>& loops, double least, double most,
           const std::function<double(const LoopCurves&, std::size_t)>& value) {
  Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const LoopCurves& curves : loops) {
    for (std::size_t i = 0; i < curves.w.size(); ++i) {
      range.low = std::min(range.low, value(curves, i));
      range.high = std::max(range.high, value(curves, i));
    }
  }
  return {std::clamp(range.low, least, most), std::clamp(range.high, least, most)};
}

// --- the complex plane ---------------------------------------------------------------------------

constexpr int kArc = 180;

Series circle(double center, double radius) {
  Series series{.look = faint_look()};
  series.x.reserve(kArc + 1);
  series.y.reserve(kArc + 1);
  for (int i = 0; i <= kArc; ++i) {
    series.x.push_back(center + radius * std::cos(2 * kPi * i / kArc));
    series.y.push_back(radius * std::sin(2 * kPi * i / kArc));
  }
  return series;
}

Series rectangle(double left, double right, double bottom, double top) {
  return {.x = {left, right, right, left, left}, .y = {bottom, bottom, top, top, bottom}};
}

/// The part of the plane that L must leave, as areas within a view of this size.
std::vector<Series> forbidden_area(const ForbiddenDisk& disk, double view) {
  const double center = disk.left + (disk.right - disk.left) / 2;
  const double radius = (disk.right - disk.left) / 2;
  Series area;
  switch (disk.kind) {
    case ForbiddenDisk::Kind::none:
      return {};
    case ForbiddenDisk::Kind::inside:
      area = radius > 100 * view ? rectangle(-2 * view, disk.right, -2 * view, 2 * view)
                                 : circle(center, radius);
      break;
    case ForbiddenDisk::Kind::half_plane:
      area = rectangle(-2 * view, disk.right, -2 * view, 2 * view);
      break;
    case ForbiddenDisk::Kind::outside: {
      area = circle(center, radius);  // all around, and back along an outer frame
      for (const double x : {2 * view, 2 * view, -2 * view, -2 * view, 2 * view, 2 * view})
        area.x.push_back(x);
      for (const double y : {0.0, -2 * view, -2 * view, 2 * view, 2 * view, 0.0})
        area.y.push_back(y);
      break;
    }
  }
  area.shape = Shape::area;
  area.look.color = 1;
  Series edge = area;
  edge.shape = Shape::line;
  edge.look = {1, 0, 2};
  if (disk.kind == ForbiddenDisk::Kind::outside) {
    edge.x.resize(kArc + 1);
    edge.y.resize(kArc + 1);
  }
  return {area, edge};
}

/// Limits of the Nyquist panel: -1, the unit circle, a disk that is not too large, and the curve
/// where it is near.
struct View {
  double left = -1.5, right = 1.15, height = 1.15;

  void include(double x, double y) {
    left = std::min(left, 1.05 * x);
    right = std::max(right, 1.05 * x);
    height = std::max(height, 1.05 * std::abs(y));
  }
};

View nyquist_view(const std::vector<LoopCurves>& loops, const ForbiddenDisk& disk) {
  constexpr double kFar = 3;
  View view;
  for (const LoopCurves& curves : loops)
    for (const Complex& L : curves.L)
      if (std::abs(L) <= kFar) view.include(L.real(), L.imag());
  if (disk.kind == ForbiddenDisk::Kind::inside && disk.left > -2 * kFar)
    view.include(disk.left, (disk.right - disk.left) / 2);
  return view;
}

// --- poles ---------------------------------------------------------------------------------------

/// Least and largest distance from the origin, of what is not there.
Range sizes(const std::vector<PointSet>& sets) {
  Range range{std::numeric_limits<double>::infinity(), 0};
  for (const PointSet& set : sets)
    for (const Complex& point : set.points) range.high = std::max(range.high, std::abs(point));
  for (const PointSet& set : sets)
    for (const Complex& point : set.points)
      if (std::abs(point) > 1e-10 * range.high) range.low = std::min(range.low, std::abs(point));
  return range;
}

std::vector<Series> point_series(const std::vector<PointSet>& sets,
                                 const std::function<double(double)>& place) {
  std::vector<Series> all;
  all.reserve(sets.size());
  for (const PointSet& set : sets) {
    Series series{.name = set.name, .shape = set.shape, .look = {set.color, 0, 3}};
    for (const Complex& point : set.points) {
      series.x.push_back(place(point.real()));
      series.y.push_back(place(point.imag()));
    }
    all.push_back(series);
  }
  return all;
}

/// 0 and, on either side, powers of ten and their threes, from the largest down where there is
/// room.
std::vector<Tick> asinh_ticks(double unit, double largest) {
  constexpr double kRoom = 0.2;  // of half the axis
  const double reach = std::asinh(largest / unit);
  std::vector<Tick> ticks = {{0, "0"}};
  double last = std::numeric_limits<double>::infinity();
  for (int e = static_cast<int>(std::floor(std::log10(largest))); e > -300; --e) {
    for (const int mantissa : {3, 1}) {
      const double value = mantissa * std::pow(10, e);
      const double at = std::asinh(value / unit);
      if (at < kRoom * reach) return ticks;
      if (at > 1.1 * reach || at > last - kRoom * reach) continue;
      last = at;
      for (const int side : {-1, 1})
        ticks.push_back({side * at, std::abs(e) <= 3 ? fmt::format("{:g}", side * value)
                                                     : fmt::format("{}e{}", side * mantissa, e)});
    }
  }
  return ticks;
}

Panel s_plane(const std::vector<PointSet>& sets) {
  constexpr double kApart = 25;  // beyond this a linear scale hides the slow poles in one blot
  const Range size = sizes(sets);
  const bool apart = size.high > kApart * size.low;
  const double unit = apart ? size.low : 1;
  const auto place = [&](double value) { return apart ? std::asinh(value / unit) : value; };
  double reach = place(size.high > 0 ? size.high : 1);
  double left = -0.1 * reach;
  double right = 0.1 * reach;
  double height = 0.3 * reach;
  for (const PointSet& set : sets) {
    for (const Complex& point : set.points) {
      left = std::min(left, place(point.real()));
      right = std::max(right, place(point.real()));
      height = std::max(height, std::abs(place(point.imag())));
    }
  }
  const double room = 0.12 * (right - left);
  Panel panel{
      .title = apart ? ", asinh scale" : "",
      .x = {.label = "real part [1/s]", .low = left - room, .high = right + room},
      .y = {.label = "imaginary part [rad/s]", .low = -1.15 * height, .high = 1.15 * height},
      .series = {}};
  panel.equal = !apart;
  if (apart) panel.x.ticks = panel.y.ticks = asinh_ticks(unit, size.high);
  reach = 4 * (reach + height);
  panel.series.push_back({.x = {0, 0}, .y = {-reach, reach}, .look = faint_look()});
  for (Series& series : point_series(sets, place)) panel.series.push_back(std::move(series));
  return panel;
}

/// The whole unit circle, or what is near z = 1 when all points are there.
Panel z_plane(const std::vector<PointSet>& sets) {
  constexpr double kNear = 0.4;
  double far = 0;
  double left = 1;
  double right = 1;
  double height = 0;
  for (const PointSet& set : sets) {
    for (const Complex& point : set.points) {
      far = std::max(far, std::abs(point - 1.0));
      left = std::min(left, point.real());
      right = std::max(right, point.real());
      height = std::max(height, std::abs(point.imag()));
    }
  }
  const bool near = far > 0 && far < kNear;
  if (!near) {
    left = std::min(left, -1.0);
    height = std::max(height, 1.0);
  }
  const double room = 0.12 * std::max(right - left, 2 * height);
  Panel panel{.title = {},
              .x = {.label = "real part of z", .low = left - room, .high = right + room},
              .y = {.label = "imaginary part of z", .low = -height - room, .high = height + room},
              .series = {circle(0, 1)},
              .labels = {},
              .equal = true};
  for (Series& series : point_series(sets, [](double value) { return value; }))
    panel.series.push_back(std::move(series));
  return panel;
}

/// The unit in which a duration is read.
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

LoopCurves loop_curves(const OpenLoop& loop, const LoopMargins& margins, const std::string& name,
                       Look look) {
  LoopCurves curves;
  curves.name = name;
  curves.look = look;
  curves.margins = margins;
  for (const double w : frequencies(loop, margins)) {
    const Complex L = loop.at(w)(0, 0);
    if (!std::isfinite(L.real()) || !std::isfinite(L.imag()) || L == 0.0) continue;
    curves.w.push_back(w);
    curves.L.push_back(L);
    curves.S.push_back(loop.sensitivity(w)(0, 0));
  }
  if (curves.w.empty()) {  // a loop that is 0: a line at the bottom
    curves.w = {0.1, 10};
    curves.L = {1e-12, 1e-12};
    curves.S = {1, 1};
  }
  unwrap(curves);
  const Complex at_rest = loop.at(0)(0, 0);
  const bool finite = std::isfinite(at_rest.real()) && std::isfinite(at_rest.imag());
  curves.at_rest = finite ? at_rest : curves.L.front();
  curves.at_end = loop.discrete() || loop.delay() > 0
                      ? curves.L.back()
                      : loop.at(std::numeric_limits<double>::infinity())(0, 0);
  return curves;
}

Panel step_panel(const std::string& title, const std::string& output,
                 const std::vector<NamedResponse>& responses) {
  constexpr double kMostStairs = 400;
  double duration = 0;
  for (const NamedResponse& named : responses)
    if (!named.response.t.empty()) duration = std::max(duration, named.response.t.back());
  const TimeUnit unit = time_unit(duration);
  Panel panel{.title = title,
              .x = {.label = fmt::format("time [{}]", unit.name),
                    .low = 0,
                    .high = duration > 0 ? duration / unit.seconds : 1},
              .y = {.label = output},
              .series = {}};
  for (const NamedResponse& named : responses) {
    Series series{
        .name = responses.size() > 1 ? named.name : "",
        .x = named.response.t,
        .y = named.response.y,
        .shape = named.dt > 0 && duration < kMostStairs * named.dt ? Shape::stairs : Shape::line,
        .look = named.look};
    for (double& t : series.x) t /= unit.seconds;
    panel.series.push_back(std::move(series));
  }
  return panel;
}

Panel magnitude_panel(const std::vector<LoopCurves>& loops) {
  constexpr double kMost = 100;  // [dB] either way
  const Range range = ends(loops, -kMost, kMost, [](const LoopCurves& curves, std::size_t i) {
    return decibels(std::abs(curves.L[i]));
  });
  const double room = std::max(3.0, 0.06 * (range.high - range.low));
  Panel panel{.title = with_name("Bode magnitude of L", loops),
              .x = frequency_axis(loops),
              .y = {.label = "magnitude [dB]",
                    .low = std::min(range.low, -6.0) - room,
                    .high = std::max(range.high, 6.0) + room,
                    .step = 20},
              .series = {}};
  level(panel, loops[0], 0);
  for (const LoopCurves& curves : loops) {
    Series series{.name = loops.size() > 1 ? curves.name : "", .x = curves.w, .look = curves.look};
    series.y.reserve(curves.L.size());
    for (const Complex& L : curves.L) series.y.push_back(decibels(std::abs(L)));
    panel.series.push_back(std::move(series));
  }
  const LoopCurves& of = worst(loops);
  for (const PhaseCrossover& at : least_gain_margins(of.margins))
    if (shown(of, at.w))
      mark(panel, at.w, 0, -decibels(at.gain_margin),
           fmt::format("GM {} dB", tenths(decibels(at.gain_margin))));
  return panel;
}

Panel phase_panel(const std::vector<LoopCurves>& loops) {
  const Range range = ends(loops, kLeastPhase, -kLeastPhase,
                           [](const LoopCurves& curves, std::size_t i) { return curves.phase[i]; });
  const double room = 12 + 0.04 * (range.high - range.low);
  Panel panel{.title = with_name("Bode phase of L", loops),
              .x = frequency_axis(loops),
              .y = {.label = "phase [deg]",
                    .low = std::min(range.low, -180.0) - room,
                    .high = std::max(range.high, -90.0) + room,
                    .step = 45},
              .series = {}};
  for (int turn = -180; turn > *panel.y.low; turn -= 360) level(panel, loops[0], turn);
  for (const LoopCurves& curves : loops)
    panel.series.push_back({.x = curves.w, .y = curves.phase, .look = curves.look});
  const LoopCurves& of = worst(loops);
  const double w = of.margins.crossover;
  if (w > 0 && shown(of, w)) {
    const double phase = of.phase[nearest(of, w)];
    // Down to -180 degrees, or up to it where lead is what ends the stability.
    const auto& all = of.margins.gain_crossovers;
    const auto at = std::find_if(all.begin(), all.end(),
                                 [&](const GainCrossover& crossover) { return crossover.w == w; });
    const double turn = at == all.end() ? of.margins.phase_margin : at->phase_margin;
    mark(panel, w, phase, phase - degrees(turn),
         fmt::format("PM {}°", tenths(degrees(of.margins.phase_margin))));
  }
  return panel;
}

Panel sensitivity_panel(const std::vector<LoopCurves>& loops) {
  const bool one = loops.size() == 1;
  Panel panel{
      .title = one ? "Sensitivity S and its complement T" : with_name("Sensitivity S", loops),
      .x = frequency_axis(loops),
      .y = {.label = one ? "|S|, |T|" : "|S|", .logarithmic = true},
      .series = {}};
  double largest = 1;
  for (const LoopCurves& curves : loops) {
    const LoopMargins& m = curves.margins;
    Series S{
        .name = one ? fmt::format("|S|, Ms {:.3g}", m.Ms) : "", .x = curves.w, .look = curves.look};
    Series T{.name = fmt::format("|T|, Mt {:.3g}", m.Mt), .x = curves.w, .look = nth_look(1)};
    S.y.reserve(curves.S.size());
    T.y.reserve(curves.S.size());
    for (std::size_t i = 0; i < curves.S.size(); ++i) {
      S.y.push_back(std::abs(curves.S[i]));
      T.y.push_back(std::abs(curves.S[i] * curves.L[i]));
      largest = std::max(largest, S.y.back());
      if (one) largest = std::max(largest, T.y.back());
    }
    panel.series.push_back(std::move(S));
    if (one) panel.series.push_back(std::move(T));
  }
  panel.y.low = 1e-2;
  panel.y.high = std::min(2 * largest, 1e3);  // on the axis of stability it has no end
  level(panel, loops[0], 1);
  const LoopCurves& of = worst(loops);
  const auto peak = [&](double value, double w) {
    if (!shown(of, w) || !is_peak(value)) return;
    panel.series.push_back({.x = {w}, .y = {value}, .shape = Shape::dots, .look = mark_look()});
    if (!one) panel.labels.push_back({w, value, fmt::format("Ms {:.3g}", value)});
  };
  peak(of.margins.Ms, of.margins.w_Ms);
  if (one) peak(of.margins.Mt, of.margins.w_Mt);
  return panel;
}

ForbiddenDisk forbidden_disk(const DiskMargin& disk) {
  using Kind = ForbiddenDisk::Kind;
  if (!(disk.alpha > 0)) return {};
  if (disk.gain_low < 0)  // factors beyond a circle, 0 and all large ones among them
    return {Kind::outside, -disk.gain_low, -1 / disk.gain_low};
  if (disk.gain_low == 0)
    return {Kind::half_plane, -std::numeric_limits<double>::infinity(), -1 / disk.gain_high};
  return {Kind::inside, -1 / disk.gain_low, -1 / disk.gain_high};
}

Panel nyquist_panel(const std::vector<LoopCurves>& loops) {
  const LoopCurves& of = worst(loops);
  const ForbiddenDisk disk = forbidden_disk(of.margins.disk);
  const View view = nyquist_view(loops, disk);
  Panel panel{.title = disk.kind == ForbiddenDisk::Kind::none
                           ? "Nyquist"
                           : fmt::format("Nyquist, disk margin {:.3f}", of.margins.disk.alpha) +
                                 (loops.size() > 1 ? fmt::format(" ({})", of.name) : ""),
              .x = {.label = "real part of L", .low = view.left, .high = view.right},
              .y = {.label = "imaginary part of L", .low = -view.height, .high = view.height},
              .series = forbidden_area(disk, std::max(view.right - view.left, 2 * view.height)),
              .labels = {},
              .equal = true};
  panel.series.push_back(circle(0, 1));
  for (const LoopCurves& curves : loops) {
    Series positive{.look = curves.look};
    positive.x.reserve(curves.L.size() + 2);
    positive.y.reserve(curves.L.size() + 2);
    positive.x.push_back(curves.at_rest.real());
    positive.y.push_back(curves.at_rest.imag());
    for (std::size_t i = 0; i < curves.L.size() && curves.phase[i] > kLeastPhase; ++i) {
      positive.x.push_back(curves.L[i].real());
      positive.y.push_back(curves.L[i].imag());
    }
    if (curves.phase.back() > kLeastPhase) {
      positive.x.push_back(curves.at_end.real());
      positive.y.push_back(curves.at_end.imag());
    }
    Series negative = positive;
    for (double& y : negative.y) y = -y;
    negative.look.width = 1.2;
    panel.series.push_back(std::move(positive));
    panel.series.push_back(std::move(negative));
  }
  panel.series.push_back(
      {.x = {-1}, .y = {0}, .shape = Shape::crosses, .look = {Look::kInk, 0, 3}});
  panel.labels.push_back({-1, 0, "-1"});
  return panel;
}

Panel pole_panel(const std::string& title, const std::vector<PointSet>& sets, double dt) {
  std::vector<PointSet> shown_sets = sets;
  std::erase_if(shown_sets, [](const PointSet& set) { return set.points.size() == 0; });
  Panel panel = dt > 0 ? z_plane(shown_sets) : s_plane(shown_sets);
  panel.title.insert(0, title);
  return panel;
}

}  // namespace quadtune::report
