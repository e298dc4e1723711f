// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/lqg_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "quadtune/errors.hpp"
#include "quadtune/internal/in_parallel.hpp"
#include "quadtune/synthesis/flown_plant.hpp"
#include "quadtune/workbench/flown/flown_messages.hpp"

namespace quadtune {
namespace {

/// The margins at each estimate that the law reads, with all others closed.
MarginsReport margins_at_estimates(const PlannedFlight& plan, const FlownLoopOptions& at) {
  const DiscreteLti law = flown_law(plan.setup);
  const FlownPlant plant = flown_plant(plan.setup, plant_options(plan.setup, at));
  const PeriodicLti cut = loop_part(cut_at_outputs(plant.plant, law));
  MarginsReport report;
  report.dt = cut.dt;
  std::vector<Eigen::Index> read;
  for (Eigen::Index i = 0; i < cut.C.rows(); ++i) {
    if (law.B.col(i).isZero(0) && law.D.col(i).isZero(0)) continue;
    read.push_back(i);
    report.names.push_back(cut.inputs[static_cast<std::size_t>(i)].name);
  }
  report.loops.resize(read.size());
  const auto one = [&](std::size_t i) { report.loops[i] = loop_margins(channel(cut, read[i])); };
  internal::in_parallel(read.size(), internal::thread_count(0), [&] { return one; }, {});
  return report;
}

/// The smallest share over all channels.
double share_of(const FlownLoop& loop, const FlownMargins& asked) {
  double min = std::numeric_limits<double>::infinity();
  for (const LoopMargins& margins : loop.margins.loops)
    min = std::min(min, quadtune::share_of(margins, asked));
  return loop.grows() ? 0 : min;
}

GeneralFilterSettings with_noise(GeneralFilterSettings settings, double factor) {
  settings.gyroscope.density *= factor;
  settings.accelerometer.density *= factor;
  return settings;
}

/// Tries more noise in the filter, and selects the largest margins within the noise budget.
/// @param plan  receives the chosen filter
void recover(LqgReport& report, PlannedFlight& plan, const LqgOptions& options,
             const FlownLoopOptions& at) {
  if (plan.estimator != "general" || !plan.setup.real_sensors)
    throw OptionError("recover",
                      fmt::format("recover does not support the estimator {} with {} sensors; "
                                  "expected the general filter and real sensors",
                                  plan.estimator, plan.sensors));
  const GeneralFilterSettings settings = general_filter_settings(plan.setup);
  const FlownMargins& asked = options.design.margins;
  const Eigen::VectorXd usual = predicted_rms(plan, options.time, at).command;
  report.recoveries = {{1, share_of(report.lqi.flown, asked), 1, true}};
  FlownLoop best = report.lqi.flown;
  const std::vector<double> factors = {2, 4, 8, 16, 32, 64};
  std::vector<FlownLoop> loops(factors.size());
  std::vector<Eigen::VectorXd> commands(factors.size());
  const auto one = [&](std::size_t i) {
    PlannedFlight other = plan;
    other.setup.general_filter = with_noise(settings, factors[i]);
    loops[i] = flown_loop(other, at);
    commands[i] = predicted_rms(other, options.time, at).command;
  };
  internal::in_parallel(factors.size(), internal::thread_count(0), [&] { return one; }, {});
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const double factor = factors[i];
    const FlownLoop& loop = loops[i];
    Recovery tried{factor, share_of(loop, asked), commands[i].cwiseQuotient(usual).maxCoeff()};
    tried.affordable = tried.noise <= options.noise_budget;
    const auto chosen =
        std::find_if(report.recoveries.begin(), report.recoveries.end(),
                     [&](const Recovery& recovery) { return recovery.factor == report.recovery; });
    // An improvement of the margins by 0.1 % does not justify more noise.
    if (tried.affordable && tried.share > 1.001 * chosen->share) {
      report.recovery = factor;
      best = loop;
    }
    report.recoveries.push_back(tried);
  }
  report.lqi.flown = best;
  if (report.recovery > 1) {
    plan.setup.general_filter = with_noise(settings, report.recovery);
    report.lqi.estimator = StoredEstimator{"general", plan.setup.general_filter};
  }
}

std::vector<std::string> messages_of(const LqgReport& report, bool recovering) {
  std::vector<std::string> messages = report.lqi.messages;
  const std::string& estimator = report.lqi.flown.estimator;
  if (estimator != "general" && estimator != "truth")
    messages.push_back(
        fmt::format("note: the deviations are predicted by a linear model, which agrees with "
                    "flights with the general "
                    "filter; with the estimator {} they may be larger",
                    estimator));
  if (recovering && report.recovery == 1)
    messages.emplace_back(
        "note: no other filter noise gives larger margins within the budget; they are limited by "
        "the delay of the loop");
  return messages;
}

}  // namespace

LqgReport lqg_report(const Vehicle& vehicle, const LqgOptions& options, const FlightOptions& flight,
                     const FlownLoopOptions& at) {
  if (!(options.noise_budget >= 1) || !std::isfinite(options.noise_budget))
    throw OptionError(
        "noise-budget",
        fmt::format("noise-budget is {}, expected a number of at least 1", options.noise_budget));
  LqgReport report;
  report.lqi = lqi_report(vehicle, options.design, flight, at);
  PlannedFlight plan = hover_under(vehicle, report.lqi.design.lqi.gains, flight);
  if (options.recover) recover(report, plan, options, at);
  report.at_estimates = margins_at_estimates(plan, at);
  report.rms = predicted_rms(plan, options.time, at);
  report.lqi.messages = flown_messages(report.lqi.design.notes, report.lqi.flown);
  report.messages = messages_of(report, options.recover);
  return report;
}

}  // namespace quadtune
