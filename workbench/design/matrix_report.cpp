// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/matrix_report.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <cmath>
#include <utility>

#include "quadtune/convention.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/convert.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/workbench/design/linearize_or_refuse.hpp"
#include "quadtune/workbench/design/lqi_report.hpp"
#include "quadtune/workbench/design/near_hover.hpp"
#include "quadtune/workbench/flown/flown_check.hpp"
#include "quadtune/workbench/flown/flown_messages.hpp"
#include "quadtune/workbench/flown/flying_loop.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Weights by Bryson's rule, or those of the design.
StandardAxes weights_of(const Vehicle& vehicle, const LqiDesign& design) {
  StandardAxes axes = standard_axes(vehicle);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const std::vector<Index>& states = states_of(kFlownAxes[i]);
    AxisWeights& weights = axes[i];
    if (design.Q) weights.q = (*design.Q)(states);
    if (design.R) weights.r = (*design.R)(wrench_of(kFlownAxes[i]));
    if (design.Q_integral) weights.q_integral = (*design.Q_integral)(static_cast<Index>(i));
    if (!(weights.q_integral > 0) || !(weights.q(0) > 0))
      throw InvalidInput(
          vehicle.name,
          fmt::format("the weights of {0} and of its integral are {1:g} and {2:g}, expected more "
                      "than 0, because a gain with this structure uses both",
                      design.integrals[i], weights.q(0), weights.q_integral));
  }
  return axes;
}

void require(const Vehicle& vehicle, const LqiDesign& design) {
  const auto refuse = [&](const std::string& came, const std::string& expected) {
    throw InvalidInput(vehicle.name, came + ", expected " + expected);
  };
  if (design.past || design.R_change)
    refuse("a matrix law was given past commands or weights of changes",
           "none, because it has no memory of its commands");
  if (design.integrals != standard_integrals())
    refuse(fmt::format("the integrals of this matrix law are '{}'",
                       internal::joined(design.integrals, " ")),
           fmt::format("{}", internal::joined(standard_integrals(), " ")));
}

/// Removes entries that result only from rounding in the maps.
void drop_rounding(MatrixXd& K) {
  constexpr double kRounding = 1e-12;
  for (Index i = 0; i < K.rows(); ++i) {
    const double min = kRounding * K.row(i).cwiseAbs().maxCoeff();
    for (Index j = 0; j < K.cols(); ++j)
      if (std::abs(K(i, j)) < min) K(i, j) = 0;
  }
}

/// @param estimator  the requested estimator; empty: none
std::vector<std::string> matrix_messages(const MatrixReport& report, const std::string& estimator) {
  std::vector<std::string> messages;
  if (!report.estimator && !estimator.empty())
    messages.push_back(fmt::format(
        "note: gain files cannot contain the estimator '{0}': fly these gains with --estimator {0}",
        estimator));
  if (report.gains.axes == PositionAxes::world)
    messages.emplace_back(
        "note: the law uses the position error in world axes, as its flight program does: a "
        "deviation of the heading from north reduces the phase margin of the position loops by its "
        "angle");
  for (std::string& text : flown_messages(report.design.notes, report.flown))
    messages.push_back(std::move(text));
  return messages;
}

}  // namespace

Gains describe(const Gains& gains, const Vehicle& vehicle, const MatrixConvention& words) {
  if (gains.memory)
    throw InvalidInput(vehicle.name,
                       "the law feeds back its past commands, expected a matrix on the states");
  const Convention& target = convention(words.convention, "convention");
  Gains result = in_convention(gains, target, target.sign_law);
  if (words.input_kind == InputKind::wrench) return result;
  LinearizeOptions options;
  options.convention = words.convention;
  options.inputs = InputKind::wrench;
  const Linearization wrench = linearize_or_refuse(vehicle, {}, options, place_of(vehicle));
  options.inputs = words.input_kind;
  const Linearization inputs = linearize_or_refuse(vehicle, {}, options, place_of(vehicle));
  // B_inputs δu = B_wrench δw for every δu, hence δw = M δu; the inverse gives the minimum-norm δu.
  const MatrixXd M = wrench.plant.B.completeOrthogonalDecomposition().solve(inputs.plant.B);
  const MatrixXd back = M.completeOrthogonalDecomposition().pseudoInverse();
  result.K = back * result.K;
  result.K_int = back * result.K_int;
  drop_rounding(result.K);
  drop_rounding(result.K_int);
  result.inputs = inputs.plant.inputs;
  result.input_kind = words.input_kind;
  result.u0 = inputs.u0;
  return result;
}

MatrixReport matrix_report(const Vehicle& vehicle, const LqiDesign& design,
                           const FlightOptions& flight, const FlownLoopOptions& at) {
  require(vehicle, design);
  const MatrixConvention words = design.matrix.value_or(MatrixConvention{});
  FlightOptions flown = flight;
  if (flown.estimator.empty()) flown.estimator = estimator_of_program(vehicle, words.convention);
  FlownGainsOptions options;
  options.dt = design.dt;
  options.now = 1;
  options.tilt_integral = false;
  options.weights = weights_of(vehicle, design);
  options.estimator = flown.estimator;
  MatrixReport report;
  report.weights = *options.weights;
  report.design = flown_gains(vehicle, options);
  Gains gains = as_state_feedback(report.design, vehicle, design.dt);
  gains.axes = PositionAxes::world;
  report.gains = describe(gains, vehicle, words);
  // quadtune's own convention supports the features of quadtune's own law, as for other gains.
  if (words.convention == "ned") keep_near_hover(vehicle, report.gains);
  report.flown = flown_loop(hover_under(vehicle, report.gains, flown), at);
  report.ideal = margins_report(
      OpenLoop(open_loop(model_of(vehicle, report.gains).plant, report.gains)),
      names_or_numbers(report.gains.inputs, std::ssize(report.gains.inputs)), at.evidence);
  report.estimator = stored_estimator(vehicle, flown.estimator, design.dt);
  report.messages = matrix_messages(report, flight.estimator);
  return report;
}

}  // namespace quadtune
