// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/state_feedback.hpp"

#include <fmt/format.h>

#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/synthesis/lqr.hpp"

namespace quadtune {
namespace {

/// Solves the Riccati problem of the selected method.
RiccatiResult solve_augmented(const ContinuousLti& augmented, const LqrWeights& weights,
                              LqrMethod method, double dt, const RiccatiOptions& options) {
  switch (method) {
    case LqrMethod::continuous:
      return lqr(augmented, weights, options);
    case LqrMethod::discrete:
      return lqr(discretize_zoh(augmented, dt), weights, options);
    case LqrMethod::sampled: {
      const SampledLqr sampled = sample(augmented, weights, dt);
      return lqr(sampled.plant, sampled.weights, options);
    }
  }
  return {};
}

}  // namespace

StateFeedback state_feedback(const ContinuousLti& plant, const LqrDesign& design,
                             const RiccatiOptions& options) {
  if (design.method != LqrMethod::continuous && !(design.dt > 0))
    throw InvalidInput("state_feedback",
                       fmt::format("dt is {} s, expected a positive number", design.dt));
  const ContinuousLti augmented = with_integrals(plant, design.integrals);
  LqrWeights weights = {design.Q, design.R, {}};
  if (!design.integrals.empty()) weights = with_integral_weights(weights, design.Q_integral);
  StateFeedback feedback;
  feedback.riccati = solve_augmented(augmented, weights, design.method, design.dt, options);
  feedback.K = feedback.riccati.K.leftCols(plant.A.rows());
  feedback.K_int = feedback.riccati.K.rightCols(static_cast<Eigen::Index>(design.integrals.size()));
  return feedback;
}

}  // namespace quadtune
