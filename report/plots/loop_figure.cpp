// SPDX-License-Identifier: Apache-2.0
#include "report/plots/loop_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "report/plots/loop_panels.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {
namespace {

/// Maximum number of curves that can be distinguished.
constexpr std::size_t kMaxLoops = 6;

/// The channels that are drawn, in order: those with the smallest disk margins.
std::vector<std::size_t> drawn_channels(const MarginsReport& report) {
  std::vector<std::size_t> all(report.loops.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::stable_sort(all.begin(), all.end(), [&](std::size_t a, std::size_t b) {
    return report.loops[a].disk.alpha < report.loops[b].disk.alpha;
  });
  all.resize(std::min(all.size(), kMaxLoops));
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<LoopCurves> curves_of(const OpenLoop& loop, const MarginsReport& report,
                                  const std::vector<std::size_t>& channels) {
  std::vector<LoopCurves> curves;
  curves.reserve(channels.size());
  for (const std::size_t i : channels)
    curves.push_back(
        loop_curves(loop.channel(static_cast<Eigen::Index>(i)), report.loops[i], report.names[i]));
  return curves;
}

/// All responses over the duration of the slowest one.
std::vector<NamedResponse> responses_of(const OpenLoop& loop, const MarginsReport& report,
                                        const std::vector<std::size_t>& channels) {
  std::vector<NamedResponse> responses;
  responses.reserve(channels.size());
  double longest = 0;
  for (const std::size_t i : channels) {
    responses.push_back(
        {report.names[i], step_response(loop, static_cast<Eigen::Index>(i)), loop.dt()});
    longest = std::max(longest, responses.back().response.t.back());
  }
  if (channels.size() > 1 && longest > 0)
    for (std::size_t k = 0; k < channels.size(); ++k)
      responses[k].response = step_response(loop, static_cast<Eigen::Index>(channels[k]), longest);
  return responses;
}

/// A delay gives the closed loop infinitely many poles; those of L are shown instead.
Panel poles_of(const OpenLoop& loop) {
  std::vector<PointSet> sets;
  const bool open = loop.delay() > 0;
  sets.push_back({"pole", cross_style(0), open ? loop.poles() : loop.closed_loop_poles()});
  if (loop.size() == 1) sets.push_back({"zero", circle_style(1), loop.zeros()});
  return pole_panel(open ? "Open loop without its delay" : "Closed loop", sets, loop.dt());
}

std::string margin_line(const LoopMargins& m, double dt) {
  if (!m.stable) return "UNSTABLE when closed";
  std::string text = "stable";
  if (std::isfinite(m.phase_margin))
    text +=
        fmt::format(", phase margin {:.1f}° at {:.3g} rad/s", degrees(m.phase_margin), m.crossover);
  if (std::isfinite(m.gain_margin))
    text += fmt::format(", gain margin {:.1f} dB", decibels(m.gain_margin));
  if (std::isfinite(m.delay_margin))
    text += (m.delay_margin < 1 ? fmt::format(", delay margin {:.3g} ms", 1e3 * m.delay_margin)
                                : fmt::format(", delay margin {:.3g} s", m.delay_margin)) +
            (dt > 0 ? fmt::format(" ({:.1f} samples)", m.delay_margin / dt) : "");
  return text;
}

std::string summary(const MarginsReport& report, std::size_t drawn) {
  if (report.loops.size() == 1) return margin_line(report.loops[0], report.dt);
  const DiskMargin all = report.together ? report.together->guaranteed : DiskMargin{};
  std::string text = all.alpha > 0 ? fmt::format("all at once: disk margin {:.3f} at {:.3g} rad/s",
                                                 all.alpha, all.w)
                                   : "UNSTABLE when closed";
  if (drawn < report.loops.size())
    text += fmt::format("; the worst {} of {} loops", drawn, report.loops.size());
  return text;
}

std::string shortened(std::string text) {
  constexpr std::size_t kMax = 110;
  if (text.size() <= kMax) return text;
  std::size_t end = kMax;  // must not be within a character
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  text.resize(end);
  return text + "…";
}

}  // namespace

Figure margins_figure(const std::string& title, const OpenLoop& loop, const MarginsReport& report) {
  const std::vector<std::size_t> channels = drawn_channels(report);
  const std::vector<LoopCurves> curves = curves_of(loop, report, channels);
  return {.title = shortened(title),
          .subtitle = summary(report, channels.size()),
          .panels = {step_panel("Step of the set point", "output / set point",
                                responses_of(loop, report, channels)),
                     magnitude_panel(curves), nyquist_panel(curves), sensitivity_panel(curves),
                     phase_panel(curves), poles_of(loop)}};
}

Figure pid_figure(const std::string& title, const ContinuousTransferFunction& plant,
                  const PidGains& gains, const MarginsReport& report) {
  const OpenLoop loop(loop_of(plant, gains));
  Figure figure = margins_figure(title, loop, report);
  figure.panels[3] = step_panel("Step of load at the plant's input", "output / load",
                                {{"", load_step_response(plant, gains)}});
  return figure;
}

}  // namespace quadtune::report
