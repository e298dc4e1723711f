// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/margins_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/internal/suggest.hpp"

namespace quadtune {
namespace {

constexpr double kMinGain = 6;    ///< [dB]
constexpr double kMinPhase = 30;  ///< [deg]
constexpr double kMinDelay = 1;   ///< [samples]

double decibels(double gain) { return 20 * std::log10(gain); }
double degrees(double angle) { return angle * 180 / std::numbers::pi; }

/// A value below `bound` with as many decimals, at least `decimals`, as show that it is below.
std::string below(double value, double bound, int decimals) {
  constexpr int kMost = 9;
  std::string text = fmt::format("{:.{}f}", value, decimals);
  while (decimals < kMost && std::stod(text) >= bound)
    text = fmt::format("{:.{}f}", value, ++decimals);
  return text;
}

}  // namespace

MarginsEvidence margins_evidence(const std::string& word) {
  if (word == "none") return MarginsEvidence::none;
  if (word == "essential") return MarginsEvidence::essential;
  if (word == "full") return MarginsEvidence::full;
  throw OptionError("evidence",
                    fmt::format("evidence is '{}', expected none, essential or full{}", word,
                                internal::did_you_mean(word, {"none", "essential", "full"})));
}

MarginsReport margins_report(const OpenLoop& loop, std::vector<std::string> names,
                             MarginsEvidence evidence) {
  MarginsReport report;
  report.dt = loop.dt();
  report.names = std::move(names);
  if (report.names.empty()) report.names = {"loop"};
  if (evidence == MarginsEvidence::none) return report;
  report.loops.reserve(report.names.size());
  for (Eigen::Index i = 0; i < loop.size(); ++i)
    report.loops.push_back(loop_margins(loop.channel(i)));
  if (evidence == MarginsEvidence::full) report.together = simultaneous_disk_margin(loop);
  return report;
}

MarginsEvidence affordable_evidence(Eigen::Index states, Eigen::Index channels) {
  const auto n = static_cast<double>(states);
  const auto m = static_cast<double>(channels);
  // The grid has about twenty frequencies per pole of the open and of the closed loop.
  const double frequencies = 250 + 40 * n;
  const double one_at_a_time = m * (frequencies * 2 * n * n + 100 * n * n * n);
  const double all_at_once = frequencies * (n * n * m + 30 * m * m * m);
  constexpr double kAffordable = 4e8;  // complex multiplications
  if (one_at_a_time > kAffordable) return MarginsEvidence::none;
  return one_at_a_time + all_at_once > kAffordable ? MarginsEvidence::essential
                                                   : MarginsEvidence::full;
}

std::vector<std::string> numbered(const std::string& letter, Eigen::Index count) {
  std::vector<std::string> names = names_or_numbers({}, count);
  for (std::string& name : names) name.insert(0, letter);
  return names;
}

std::vector<std::string> margin_notes(const MarginsReport& report) {
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < report.loops.size(); ++i) {
    const LoopMargins& m = report.loops[i];
    const std::string who = report.loops.size() > 1 ? "loop " + report.names[i] : "the loop";
    const bool at_rest = std::any_of(m.gain_crossovers.begin(), m.gain_crossovers.end(),
                                     [](const GainCrossover& at) { return at.w == 0; });
    if (at_rest) notes.push_back(who + ": |L(0)| is 1, which counts as a crossover at 0 rad/s");
    if (m.far_phase_crossovers > 0)
      notes.push_back(
          fmt::format("{}: {} phase crossover{} with |L| below 1e-6 or above 1e6 {} not "
                      "listed",
                      who, m.far_phase_crossovers, m.far_phase_crossovers == 1 ? "" : "s",
                      m.far_phase_crossovers == 1 ? "is" : "are"));
  }
  return notes;
}

std::vector<std::string> margin_warnings(const MarginsReport& report) {
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < report.loops.size(); ++i) {
    const LoopMargins& m = report.loops[i];
    const std::string name =
        report.loops.size() > 1 ? fmt::format("loop {}", report.names[i]) : "the loop";
    const auto warn = [&](const std::string& what) {
      warnings.push_back(fmt::format("{}: {}", name, what));
    };
    if (!m.stable) {
      warnings.push_back(name + " is unstable when it is closed");
      continue;
    }
    const double up = decibels(m.gain_margin);
    const double down = decibels(1 / m.gain_reduction);
    if (up < kMinGain)
      warn(fmt::format("gain margin {} dB, less than {} dB", below(up, kMinGain, 1), kMinGain));
    if (down < kMinGain)
      warn(fmt::format("gain may decrease by only {} dB, less than {} dB", below(down, kMinGain, 1),
                       kMinGain));
    if (degrees(std::abs(m.phase_margin)) < kMinPhase)
      warn(fmt::format("phase margin {} deg, less than {} deg",
                       below(degrees(m.phase_margin), kMinPhase, 1), kMinPhase));
    if (report.dt > 0 && m.delay_margin < kMinDelay * report.dt)
      warn(fmt::format("delay margin {} ms, less than a sample of {:.4g} ms",
                       below(1e3 * m.delay_margin, 1e3 * report.dt, 2), 1e3 * report.dt));
  }
  return warnings;
}

}  // namespace quadtune
