// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/pid/ultimate_rules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/synthesis/margins.hpp"

namespace quadtune {
namespace {

/// K = gain Ku, Ti = integral Tu, Td = derivative Tu.
struct Rule {
  const char* name;
  PidType type;
  double gain, integral, derivative;
};

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr std::array<Rule, 8> kRules = {Rule{"ziegler-nichols", PidType::P, 0.5, kNone, 0},
                                        Rule{"ziegler-nichols", PidType::PI, 0.45, 1 / 1.2, 0},
                                        Rule{"ziegler-nichols", PidType::PID, 0.6, 0.5, 0.125},
                                        Rule{"pessen", PidType::PID, 0.7, 0.4, 0.15},
                                        Rule{"some-overshoot", PidType::PID, 0.33, 0.5, 1.0 / 3},
                                        Rule{"no-overshoot", PidType::PID, 0.2, 0.5, 1.0 / 3},
                                        Rule{"tyreus-luyben", PidType::PI, 1 / 3.2, 2.2, 0},
                                        Rule{"tyreus-luyben", PidType::PID, 1 / 2.2, 2.2, 1 / 6.3}};

}  // namespace

const std::vector<std::string>& ultimate_rules() {
  static const std::vector<std::string> names = {"ziegler-nichols", "pessen", "some-overshoot",
                                                 "no-overshoot", "tyreus-luyben"};
  return names;
}

UltimatePoint ultimate_point(const ContinuousTransferFunction& plant) {
  const OpenLoop loop(plant);
  UltimatePoint point;
  const LoopMargins margins = loop_margins(loop);
  const auto is_stable = [&](double gain) {
    ContinuousTransferFunction scaled = plant;
    scaled.num *= gain;
    return loop_margins(OpenLoop(scaled)).stable;
  };
  // Candidates in increasing order: every gain at which L passes -1.
  std::vector<std::pair<double, double>> candidates;  // gain, w
  for (const PhaseCrossover& at : margins.phase_crossovers)
    if (std::isfinite(at.w) && at.w > 0 && std::isfinite(at.gain_margin))
      candidates.emplace_back(at.gain_margin, at.w);
  std::sort(candidates.begin(), candidates.end());
  for (const auto& [gain, w] : candidates)
    if (is_stable(gain * (1 - 1e-6)) && !is_stable(gain * (1 + 1e-6))) {
      point.gain = gain;
      point.period = 2 * std::numbers::pi / w;
      return point;
    }
  point.culprit =
      candidates.empty()
          ? "the phase of the plant never reaches -180 degrees, so that no gain makes a "
            "proportional loop oscillate"
          : "no gain makes a stable proportional loop oscillate";
  return point;
}

PidGains ultimate_rule(const std::string& rule, PidType type, double ultimate_gain,
                       double ultimate_period, double N) {
  const char* where = "ultimate_rule";
  if (ultimate_gain == 0 || !std::isfinite(ultimate_gain))
    throw InvalidInput(
        where, fmt::format("Ku is {}, expected a finite number other than 0", ultimate_gain));
  if (!(ultimate_period > 0) || !std::isfinite(ultimate_period))
    throw InvalidInput(where,
                       fmt::format("Tu is {} s, expected a positive number", ultimate_period));
  if (!(N > 0))
    throw InvalidInput(where, fmt::format("N is {}, expected more than 0 because Tf = Td/N", N));
  std::string types;
  for (const Rule& known : kRules) {
    if (rule != known.name) continue;
    if (type == known.type) {
      PidStandard standard;
      standard.K = known.gain * ultimate_gain;
      standard.Ti = known.integral * ultimate_period;
      standard.Td = known.derivative * ultimate_period;
      standard.Tf = standard.Td / N;
      return parallel_form(standard);
    }
    types += (types.empty() ? "" : " or ") + to_string(known.type);
  }
  if (types.empty())
    throw InvalidInput(where, fmt::format("rule is '{}', expected one of {}{}", rule,
                                          internal::joined(ultimate_rules(), ", "),
                                          internal::did_you_mean(rule, ultimate_rules())));
  throw InvalidInput(
      where, fmt::format("type is {}, expected {} for the rule {}", to_string(type), types, rule));
}

}  // namespace quadtune
