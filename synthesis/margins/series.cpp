// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/series.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// C and D written out, no names.
template <class Lti>
Lti explicit_outputs(Lti plant) {
  validate(plant, "series");
  const Index nx = plant.A.rows();
  if (plant.C.size() == 0) plant.C = MatrixXd::Identity(nx, nx);
  if (plant.D.size() == 0) plant.D = MatrixXd::Zero(plant.C.rows(), plant.B.cols());
  plant.states.clear();
  plant.inputs.clear();
  plant.outputs.clear();
  return plant;
}

void require_match(Index outputs, Index inputs) {
  if (outputs != inputs)
    throw InvalidInput("series", fmt::format("the first system has {} outputs and the second {} "
                                             "inputs, expected equal numbers",
                                             outputs, inputs));
}

template <class Lti>
Lti join(const Lti& given_first, const Lti& given_second) {
  const Lti first = explicit_outputs(given_first);
  const Lti second = explicit_outputs(given_second);
  require_match(first.C.rows(), second.B.cols());
  const Index n1 = first.A.rows();
  const Index n2 = second.A.rows();
  Lti both = first;
  // x1' = A1 x1 + B1 u,  x2' = A2 x2 + B2 (C1 x1 + D1 u),  y = C2 x2 + D2 (C1 x1 + D1 u)
  both.A = MatrixXd::Zero(n1 + n2, n1 + n2);
  both.A.topLeftCorner(n1, n1) = first.A;
  both.A.bottomLeftCorner(n2, n1) = second.B * first.C;
  both.A.bottomRightCorner(n2, n2) = second.A;
  both.B.resize(n1 + n2, first.B.cols());
  both.B << first.B, second.B * first.D;
  both.C.resize(second.C.rows(), n1 + n2);
  both.C << second.D * first.C, second.C;
  both.D = second.D * first.D;
  return both;
}

template <class Lti>
Lti with_output_gain(const Lti& given, const MatrixXd& gain) {
  Lti plant = explicit_outputs(given);
  require_match(plant.C.rows(), gain.cols());
  require_finite(gain, "series", "the gain");
  plant.C = (gain * plant.C).eval();
  plant.D = (gain * plant.D).eval();
  return plant;
}

template <class Lti>
Lti with_input_gain(const MatrixXd& gain, const Lti& given) {
  Lti plant = explicit_outputs(given);
  require_match(gain.rows(), plant.B.cols());
  require_finite(gain, "series", "the gain");
  plant.B = (plant.B * gain).eval();
  plant.D = (plant.D * gain).eval();
  return plant;
}

}  // namespace

ContinuousLti series(const ContinuousLti& first, const ContinuousLti& second) {
  return join(first, second);
}

DiscreteLti series(const DiscreteLti& first, const DiscreteLti& second) {
  if (std::abs(first.dt - second.dt) > 1e-9 * first.dt)
    throw InvalidInput("series", fmt::format("the sample periods are {} s and {} s, expected equal "
                                             "ones",
                                             first.dt, second.dt));
  return join(first, second);
}

ContinuousLti series(const ContinuousLti& first, const MatrixXd& second) {
  return with_output_gain(first, second);
}
DiscreteLti series(const DiscreteLti& first, const MatrixXd& second) {
  return with_output_gain(first, second);
}
ContinuousLti series(const MatrixXd& first, const ContinuousLti& second) {
  return with_input_gain(first, second);
}
DiscreteLti series(const MatrixXd& first, const DiscreteLti& second) {
  return with_input_gain(first, second);
}

}  // namespace quadtune
