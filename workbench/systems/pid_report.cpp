// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/systems/pid_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <utility>
#include <vector>

#include "design/positive_option.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/synthesis/pid/pid_loop.hpp"
#include "quadtune/synthesis/pid/pid_rules.hpp"
#include "quadtune/synthesis/pid/ultimate_rules.hpp"

namespace quadtune {
namespace {

/// Gains with a description of their method.
struct Found {
  PidGains gains;
  std::string how;
};

const std::vector<std::string> kRules = {"amigo",          "simc",         "ziegler-nichols",
                                         "cohen-coon",     "lambda",       "pessen",
                                         "some-overshoot", "no-overshoot", "tyreus-luyben"};

/// Formats a number for messages.
std::string short_number(double value) { return fmt::format("{:.6g}", value); }

Found by_crossover(const ContinuousTransferFunction& plant, const PidRequest& request,
                   const PidCrossover& asked) {
  require_positive_option("crossover", asked.crossover, "rad/s");
  if (!(asked.phase_margin > 0 && asked.phase_margin < 180))
    throw OptionError("phase-margin", fmt::format("phase-margin is {} deg, expected more than 0 "
                                                  "and less than 180",
                                                  short_number(asked.phase_margin)));
  LoopRequirement requirement;
  requirement.type = request.type;
  requirement.crossover = asked.crossover;
  requirement.phase_margin = asked.phase_margin * std::numbers::pi / 180;
  requirement.Tf = request.Tf;
  const PidLoopDesign design = pid_for_crossover(plant, requirement);
  if (!design.solved())
    throw NoSolution(fmt::format("pid: {}: {}", to_string(design.status), design.culprit),
                     "--crossover");
  // The gain of a P is determined by the crossover alone.
  return {design.gains, fmt::format("{} for a crossover of {} rad/s and a phase margin of {}{} deg",
                                    to_string(request.type), short_number(asked.crossover),
                                    request.type == PidType::P ? "at least " : "",
                                    short_number(asked.phase_margin))};
}

template <class Model>
Model require_fitted(const LagFit<Model>& fit) {
  if (!fit.fitted())
    throw NoSolution("pid: the rule requires a first-order model with delay: " + fit.culprit,
                     "--rule");
  return fit.model;
}

std::string model_text(const FopdtModel& model) {
  return fmt::format("{} e^(-{} s)/({} s + 1)", short_number(model.gain), short_number(model.delay),
                     short_number(model.time_constant));
}

double tau_c_or_delay(const std::optional<double>& tau_c, double delay) {
  if (!tau_c && delay == 0)
    throw OptionError("tau-c",
                      "tau-c is missing, expected a positive number, because its default for rule "
                      "simc is the delay of the plant, which has none");
  return tau_c.value_or(delay);
}

/// SIMC uses a second lag for its PID, according to its half rule.
Found by_simc(const ContinuousTransferFunction& plant, PidType type,
              const std::optional<double>& tau_c) {
  if (type == PidType::PID) {
    const LagFit<SopdtModel> fit = half_rule_sopdt(plant);
    if (!fit.fitted())
      throw NoSolution(fmt::format("pid: the rule simc requires a second-order model with delay "
                                   "for a PID: {}; a PI requires only one lag",
                                   fit.culprit),
                       "--rule");
    const SopdtModel& model = fit.model;
    const double used = tau_c_or_delay(tau_c, model.delay);
    return {simc(model, used),
            fmt::format("PID by SIMC for {} e^(-{} s)/(({} s + 1)({} s + 1)), tau_c {} s",
                        short_number(model.gain), short_number(model.delay),
                        short_number(model.time_constant), short_number(model.second),
                        short_number(used))};
  }
  if (type != PidType::PI)
    throw OptionError("type", "rule simc supports PI and PID; expected one of them as --type");
  const LagFit<FopdtModel> half = half_rule_fopdt(plant);
  const FopdtModel model = half.fitted() ? half.model : require_fitted(fit_fopdt(plant));
  const double used = tau_c_or_delay(tau_c, model.delay);
  return {simc(model, used),
          fmt::format("PI by SIMC for {}, tau_c {} s", model_text(model), short_number(used))};
}

/// A rule from the gain and the period of the plant's oscillation at the limit of stability.
Found by_ultimate_point(const ContinuousTransferFunction& plant, PidType type,
                        const std::string& rule) {
  const UltimatePoint point = ultimate_point(plant);
  if (!point.exists()) throw NoSolution("pid: " + point.culprit, "--rule");
  return {ultimate_rule(rule, type, point.gain, point.period),
          fmt::format("{} by {} for an ultimate gain of {} and a period of {} s", to_string(type),
                      rule, short_number(point.gain), short_number(point.period))};
}

Found by_rule(const ContinuousTransferFunction& plant, PidType type, const PidRule& asked) {
  const std::string& rule = asked.rule;
  if (std::find(kRules.begin(), kRules.end(), rule) == kRules.end())
    throw OptionError(
        "rule", fmt::format("rule is '{}', expected one of {}{}", rule,
                            internal::joined(kRules, ", "), internal::did_you_mean(rule, kRules)));
  if (asked.tau_c && rule != "simc" && rule != "lambda")
    throw OptionError("tau-c", "tau-c is only for the rules simc and lambda");
  if (asked.tau_c) require_positive_option("tau-c", *asked.tau_c, "seconds");
  if (rule == "pessen" || rule == "some-overshoot" || rule == "no-overshoot" ||
      rule == "tyreus-luyben")
    return by_ultimate_point(plant, type, rule);
  if (rule == "simc") return by_simc(plant, type, asked.tau_c);
  const FopdtModel model = require_fitted(fit_fopdt(plant));
  if (rule != "lambda" && model.delay == 0)
    throw OptionError("rule", fmt::format("rule {} divides by the delay, and the plant has none; "
                                          "expected a plant with a delay, or the rule lambda",
                                          rule));
  const double lambda = asked.tau_c.value_or(std::max(model.delay, model.time_constant / 3));
  PidGains gains;
  try {
    gains = rule == "amigo"             ? amigo(type, model)
            : rule == "ziegler-nichols" ? ziegler_nichols_step(type, model)
            : rule == "cohen-coon"      ? cohen_coon(type, model)
                                        : lambda_tuning(type, model, lambda);
  } catch (const InvalidInput& error) {
    throw OptionError(
        "rule", fmt::format("rule {} with --type {}: {}", rule, to_string(type), error.message()));
  }
  return {gains,
          fmt::format("{} by {} for {}{}", to_string(type), rule, model_text(model),
                      rule == "lambda" ? fmt::format(", lambda {} s", short_number(lambda)) : "")};
}

Found by_bounds(const ContinuousTransferFunction& plant, const PidRequest& request,
                const PidBounds& bounds) {
  if (request.type != PidType::PI && request.type != PidType::PID)
    throw OptionError("type", "Ms-max maximizes the integral gain; expected --type PI or PID");
  const PidOptimum optimum = max_integral_gain(plant, request.type, bounds, request.Tf);
  if (!optimum.solved())
    throw NoSolution(fmt::format("pid: {}: {}", to_string(optimum.status), optimum.culprit),
                     "--Ms-max");
  return {optimum.gains,
          fmt::format("{} with maximum Ki; active bounds: {}", to_string(request.type),
                      optimum.binding.empty() ? "none" : internal::joined(optimum.binding, ", "))};
}

Found found_for(const ContinuousTransferFunction& plant, const PidRequest& request) {
  if (const auto* crossover = std::get_if<PidCrossover>(&request.by))
    return by_crossover(plant, request, *crossover);
  if (const auto* rule = std::get_if<PidRule>(&request.by))
    return by_rule(plant, request.type, *rule);
  return by_bounds(plant, request, std::get<PidBounds>(request.by));
}

}  // namespace

PidType pid_type(const std::string& word) {
  for (const PidType type : {PidType::P, PidType::PI, PidType::PD, PidType::PID})
    if (word == to_string(type)) return type;
  throw OptionError("type", fmt::format("type is '{}', expected P, PI, PD or PID", word));
}

PidReport pid_report(const ContinuousTransferFunction& plant, const PidRequest& request) {
  Found found = found_for(plant, request);
  PidReport report{request.type, plant, found.gains, std::move(found.how)};
  const ContinuousTransferFunction loop = loop_of(plant, report.gains);
  report.needs_filter = loop.num.size() > loop.den.size();
  if (!report.needs_filter) report.margins = margins_report(OpenLoop(loop), {});
  return report;
}

}  // namespace quadtune
