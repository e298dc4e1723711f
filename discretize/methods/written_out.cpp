// SPDX-License-Identifier: Apache-2.0
#include "methods/written_out.hpp"

#include "methods/period.hpp"

namespace quadtune::internal {

using Eigen::MatrixXd;

DiscreteLti with_explicit_outputs(const ContinuousLti& plant, double dt) {
  const Eigen::Index nx = plant.A.rows();
  DiscreteLti result;
  result.C = plant.C.size() ? plant.C : MatrixXd::Identity(nx, nx);
  result.D = plant.D.size() ? plant.D : MatrixXd::Zero(result.C.rows(), plant.B.cols());
  result.dt = dt;
  result.states = plant.states;
  result.inputs = plant.inputs;
  result.outputs = plant.C.size() ? plant.outputs : plant.states;
  return result;
}

void refuse_overflow(const DiscreteLti& result, const std::string& where) {
  if (!result.A.allFinite() || !result.B.allFinite() || !result.C.allFinite() ||
      !result.D.allFinite())
    refuse_long_period(result.dt, where);
}

}  // namespace quadtune::internal
