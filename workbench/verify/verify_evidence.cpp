// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/verify/verify_evidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"
#include "quadtune/synthesis/actuator_lqi.hpp"
#include "quadtune/synthesis/state_feedback.hpp"
#include "quadtune/workbench/export/export_content.hpp"
#include "quadtune/workbench/flown/flying_loop.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Checks that Q has separate blocks for the states and the integrals.
void require_weights(const Manifest& manifest) {
  const Gains& gains = *manifest.gains;
  const Index nx = std::ssize(gains.states), ni = std::ssize(gains.integrals);
  const Index nu = std::ssize(gains.inputs);
  const std::string where = kManifestName;
  require_shape(manifest.Q, nx + ni, nx + ni, where, "weights.Q", "states, then integrals");
  require_shape(manifest.R, nu, nu, where, "weights.R", "inputs");
  if (!manifest.Q.topRightCorner(nx, ni).isZero(0) ||
      !manifest.Q.bottomLeftCorner(ni, nx).isZero(0))
    throw InvalidInput(where, "weights.Q couples states and integrals; expected separate blocks");
}

/// The LQR problem with a manifest's weights, in the order of the plant's states.
LqrDesign problem_of(const Manifest& manifest, const ContinuousLti& plant) {
  const Gains& gains = *manifest.gains;
  const Index nx = std::ssize(gains.states);
  const Index ni = std::ssize(gains.integrals);
  require_weights(manifest);
  const std::string where = kManifestName;
  LqrDesign design;
  design.convention = gains.convention;
  design.input_kind = gains.input_kind;
  design.dt = gains.dt;
  const std::string& method = manifest.evidence.method;
  design.method = lqr_method(method.substr(0, method.find(" LQR")), where + ": evidence.method");
  std::vector<Index> order;
  for (const Signal& state : plant.states) {
    design.states.push_back(state.name);
    for (Index i = 0; i < nx; ++i)
      if (gains.states[static_cast<std::size_t>(i)].name == state.name) order.push_back(i);
  }
  design.Q = manifest.Q.topLeftCorner(nx, nx)(order, order);
  design.Q_integral = manifest.Q.bottomRightCorner(ni, ni);
  design.R = manifest.R;
  for (const Signal& input : gains.inputs) design.inputs.push_back(input.name);
  for (const Signal& integral : gains.integrals) design.integrals.push_back(integral.name);
  return design;
}

/// Largest difference relative to the largest entry of its row, because each row has its own unit.
double difference(const Gains& gains, const std::vector<Signal>& states,
                  const StateFeedback& found) {
  const double law = gains.sign_law == SignLaw::set_point_minus_state ? 1 : -1;
  MatrixXd K(gains.K.rows(), gains.K.cols());
  for (Index j = 0; j < std::ssize(states); ++j)
    for (Index i = 0; i < std::ssize(gains.states); ++i)
      if (gains.states[static_cast<std::size_t>(i)].name ==
          states[static_cast<std::size_t>(j)].name)
        K.col(i) = found.K.col(j);
  MatrixXd given(K.rows(), K.cols() + gains.K_int.cols());
  MatrixXd solved(K.rows(), K.cols() + gains.K_int.cols());
  given << gains.K, gains.K_int;
  solved << law * K, law * found.K_int;
  double worst = 0;
  for (Index i = 0; i < given.rows(); ++i) {
    const double scale = given.row(i).cwiseAbs().maxCoeff();
    const double max = (given.row(i) - solved.row(i)).cwiseAbs().maxCoeff();
    worst = std::max(worst, scale > 0 ? max / scale : max);
  }
  return worst;
}

constexpr char kOfWeights[] = "the recorded evidence agrees with the weights";

VerifyCheck check_told(const ExportEvidence& told, const RiccatiResult& solved) {
  VerifyCheck check{kOfWeights, false, ""};
  const double poles = pole_distance(told.poles, solved.poles);
  // Both are estimates of rounding errors, which differ slightly between machines.
  constexpr double kSmallResidual = 1e-9;
  const bool residual = told.residual <= kSmallResidual && solved.residual <= kSmallResidual;
  const bool rcond = std::abs(std::log10(told.rcond / solved.rcond)) <= 1;
  check.ok =
      told.status == to_string(solved.status) && residual && rcond && poles <= kPoleTolerance;
  check.detail =
      told.status != to_string(solved.status)
          ? fmt::format("status '{}', solved again '{}'", told.status, to_string(solved.status))
          : fmt::format(
                "poles apart by {:.3g}, at most {:g}; residual {:.2g}, anew {:.2g}; "
                "reciprocal condition {:.2g}, anew {:.2g}",
                poles, kPoleTolerance, told.residual, solved.residual, told.rcond, solved.rcond);
  return check;
}

/// The same for gains of flown_lqi(), from the 12 states of ned to the wrench.
std::vector<VerifyCheck> check_lqi(const Vehicle& vehicle, const Manifest& manifest,
                                   VerifyCheck check) {
  const Gains& gains = *manifest.gains;
  if (gains.states != ned_convention().states || gains.inputs != ned_convention().wrench)
    throw InvalidInput(kManifestName,
                       "the gains of an LQI have unexpected states or inputs; expected "
                       "the 12 states of ned and the wrench");
  require_weights(manifest);
  const Index ni = std::ssize(gains.integrals);
  ActuatorLqiWeights weights;
  weights.Q = manifest.Q.topLeftCorner(12, 12);
  weights.Q_integral = manifest.Q.bottomRightCorner(ni, ni);
  weights.R = manifest.R;
  ActuatorLqiOptions options;
  options.dt = gains.dt;
  options.past = gains.memory ? gains.memory->past : 0;
  for (const Signal& integral : gains.integrals) options.integrals.push_back(integral.name);
  const ActuatorLqi found = actuator_lqi(vehicle, weights, options);
  if (!found.solved()) {
    check.detail = "solved again: " + found.riccati.culprit;
    return {check};
  }
  const auto all = [](const Gains& of) {
    const Index memory = of.memory ? of.memory->K_lag.cols() + of.memory->K_past.cols() : 0;
    MatrixXd K(of.K.rows(), of.K.cols() + of.K_int.cols() + memory);
    if (of.memory)
      K << of.K, of.K_int, of.memory->K_lag, of.memory->K_past;
    else
      K << of.K, of.K_int;
    return K;
  };
  const MatrixXd given = all(gains), solved = all(found.gains);
  if (given.cols() != solved.cols()) {
    check.detail = fmt::format("the law has {} gains for each command, solved again {}",
                               given.cols(), solved.cols());
    return {check};
  }
  // The law omits couplings between axes of the size of rounding.
  constexpr double kRounding = 1e-7;
  double worst = 0;
  for (Index i = 0; i < given.rows(); ++i)
    worst = std::max(worst, (given.row(i) - solved.row(i)).cwiseAbs().maxCoeff() /
                                solved.row(i).cwiseAbs().maxCoeff());
  check.ok = worst <= kRounding;
  check.detail = fmt::format(
      "solved again: entries differ by at most {:.3g} times the largest of their row, expected "
      "at most {:.2g}",
      worst, kRounding);
  return {check, check_told(manifest.evidence, found.riccati)};
}

}  // namespace

std::vector<VerifyCheck> check_evidence(const Vehicle& vehicle, const Manifest& manifest) {
  if (!manifest.gains || manifest.Q.size() == 0 || manifest.R.size() == 0) {
    const ExportEvidence& told = manifest.evidence;
    if (told.method.empty() && told.status.empty() && std::isnan(told.residual) &&
        std::isnan(told.rcond) && told.iterations == 0 && told.poles.size() == 0)
      return {};
    return {{kOfWeights, false, "the manifest has evidence, but not the weights it belongs to"}};
  }
  VerifyCheck check{"weights give the gains", false, ""};
  try {
    if (manifest.evidence.method == kFlownLqiMethod) return check_lqi(vehicle, manifest, check);
    const Linearization model = linearization_of(vehicle, *manifest.gains);
    const StateFeedback found = state_feedback(model.plant, problem_of(manifest, model.plant));
    if (!found.solved()) {
      check.detail = "solved again: " + found.riccati.culprit;
      return {check};
    }
    const double worst = difference(*manifest.gains, model.plant.states, found);
    // Effect of rounding on a problem with this condition number.
    const double tolerance =
        std::max(1e-9, 100 * std::numeric_limits<double>::epsilon() / found.riccati.rcond);
    check.ok = worst <= tolerance;
    check.detail = fmt::format(
        "solved again: entries differ by at most {:.3g} times the largest of their row, expected "
        "at "
        "most {:.2g}",
        worst, tolerance);
    return {check, check_told(manifest.evidence, found.riccati)};
  } catch (const InvalidInput& error) {
    check.detail = error.what();
    return {check};
  }
}

}  // namespace quadtune
