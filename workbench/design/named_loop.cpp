// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/named_loop.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "quadtune/control/cascade_law.hpp"
#include "quadtune/discretize/delay.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/loop_limits.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/cascade_report.hpp"
#include "quadtune/workbench/design/given_gains.hpp"
#include "quadtune/workbench/flown/flying_loop.hpp"
#include "sampling/looks_sampled.hpp"

namespace quadtune {
namespace {

DiscreteLti delayed(DiscreteLti loop, double delay) {
  if (delay == 0) return loop;
  const double exact = whole_samples(delay, loop.dt) * loop.dt;
  return with_delays(loop, {Eigen::VectorXd::Constant(loop.B.cols(), exact), {}});
}

/// The loop K (λI - A)⁻¹ B, or (λI - A)⁻¹ B K.
template <class Lti>
Lti cut(const Lti& plant, const Eigen::MatrixXd& K, bool at_states) {
  Lti loop = plant;
  if (at_states)
    loop.B = (plant.B * K).eval();
  else
    loop.C = K;
  return loop;
}

bool is_stable(const Eigen::MatrixXd& closed, bool discrete) {
  const Eigen::VectorXcd poles = closed.eigenvalues();
  return discrete ? poles.cwiseAbs().maxCoeff() < 1 : poles.real().maxCoeff() < 0;
}

/// Describes the assumed meaning of undeclared matrices, with a warning if it looks wrong because
/// the loop is stable only with the other meaning.
std::string taken_as(const ContinuousLti& plant, const Eigen::MatrixXd& K, bool discrete) {
  const Eigen::MatrixXd closed = plant.A - plant.B * K;
  const bool looks_wrong = !is_stable(closed, discrete) && is_stable(closed, !discrete);
  if (!discrete)
    return looks_wrong ? "warning: A and B are assumed continuous, but A - B K is stable only if "
                         "they are discrete: declare this with --discrete --dt T"
                       : "";
  const std::string taken = "A and B are assumed discrete because of --dt";
  if (const std::string why = why_not_sampled(plant.A); !looks_wrong && !why.empty())
    return fmt::format(
        "warning: {}, but A {}, which is impossible for a plant sampled without delays: --sampled "
        "DT "
        "declares them continuous, --discrete declares them discrete",
        taken, why);
  return looks_wrong
             ? "warning: " + taken +
                   ", but A - B K is stable only if they are continuous: --sampled DT declares "
                   "them continuous, with the input held"
             : "note: " + taken +
                   "; --discrete declares this, --sampled DT declares them continuous, with the "
                   "input held";
}

/// @param dt  control period [s]
void require_delay(double delay, double dt) {
  const double max = kMaxDelayPeriods * dt;
  if (delay > max * (1 + 1e-9))
    throw OptionError(
        "delay", fmt::format("delay is {:.6g} s, expected at most {:.6g} s, {} control periods, "
                             "because each delayed sample is a state of the loop",
                             delay, max, kMaxDelayPeriods));
}

NamedLoop vehicle_loop(const FlightOptions& options, double delay) {
  const Vehicle vehicle = load_vehicle(options.vehicle);
  const GivenLaws given = read_given_laws(options.gains);
  require_vehicle(given.laws, vehicle, options.gains);
  if (!given.laws.gains) {
    const CascadeDesign& cascade = *given.laws.cascade;
    require_delay(delay, cascade.gains.dt);
    const DiscreteLti law = cascade_law(cascade.gains, cascade.method);
    const DiscreteLti plant = cascade_plant(without_lag(vehicle), cascade, options.gains);
    return {OpenLoop(delayed(cut_at_inputs(plant, law), delay)),
            names_or_numbers(law.outputs, std::ssize(law.outputs)), "", kCascadedPid};
  }
  const Gains& gains = *given.laws.gains;
  if (!(gains.dt > 0))
    throw InvalidInput(options.gains,
                       "the gains have no sample period; it is required because the "
                       "flown loop is sampled");
  require_delay(delay, gains.dt);
  const VerifyModel model = model_of(vehicle, gains);
  try {
    return {OpenLoop(delayed(open_loop(model.plant, gains), delay)),
            names_or_numbers(gains.inputs, std::ssize(gains.inputs)), "", kStateFeedback};
  } catch (const InvalidInput& error) {
    if (error.where() != "open_loop") throw;
    throw InvalidInput(options.gains, error.message());  // the gains do not fit the vehicle
  }
}

FlownLoop flown_vehicle_loop(FlightOptions flight, const std::string& controller,
                             const FlownLoopOptions& at) {
  flight.controller = controller;
  const PlannedFlight plan = plan_flight(flight, "margins");
  require_delay(at.command_delay, control_period(plan.setup));
  return flown_loop(plan, at);
}

}  // namespace

int whole_samples(double delay, double dt) {
  const double samples = delay / dt;
  if (std::abs(samples - std::round(samples)) > 1e-9 * std::max(1.0, samples))
    throw OptionError("delay", fmt::format("delay is {:.6g} s, expected a whole number of samples "
                                           "of {:.6g} s because the loop is discrete",
                                           delay, dt));
  constexpr double kMax = 2000;
  if (samples > kMax)
    throw OptionError("delay",
                      fmt::format("delay is {:.6g} samples, expected at most {}", samples, kMax));
  return static_cast<int>(std::round(samples));
}

NamedLoop gain_loop(const ContinuousLti& plant, const Eigen::MatrixXd& K,
                    const GainLoopOptions& options) {
  std::vector<std::string> names =
      options.at_states ? numbered("x", plant.A.rows()) : numbered("u", plant.B.cols());
  std::string taken =
      options.declared ? "" : taken_as(plant, K, options.time == MatrixTime::discrete);
  if (options.time == MatrixTime::continuous)
    return {OpenLoop(cut(plant, K, options.at_states), options.delay), std::move(names),
            std::move(taken)};
  const DiscreteLti discrete = options.time == MatrixTime::sampled
                                   ? discretize_zoh(plant, options.dt)
                                   : DiscreteLti{plant.A, plant.B, {}, {}, options.dt, {}, {}, {}};
  return {OpenLoop(delayed(cut(discrete, K, options.at_states), options.delay)), std::move(names),
          std::move(taken)};
}

LoopReport loop_report(NamedLoop loop) {
  MarginsReport ideal = margins_report(loop.loop, loop.names);
  return {std::move(loop), std::move(ideal)};
}

LoopReport loop_report(const FlightOptions& flight, const FlownLoopOptions& at, bool flown) {
  LoopReport report = loop_report(vehicle_loop(flight, at.command_delay));
  if (flown) report.flown = flown_vehicle_loop(flight, report.loop.controller, at);
  return report;
}

}  // namespace quadtune
