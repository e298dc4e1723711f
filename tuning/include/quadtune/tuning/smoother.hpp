// SPDX-License-Identifier: Apache-2.0
/// All states of a record at once, given all its measurements: one sparse Gaussian system.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/filter_record.hpp"

namespace quadtune {

enum class SmootherStatus {
  not_run,
  solved,
  singular,    ///< a state is known exactly, or never seen, so that the system has no inverse
  overflowed,  ///< a number left the range of a double
};

struct SmoothedStates {
  SmootherStatus status = SmootherStatus::not_run;
  Eigen::MatrixXd x;  ///< (nx × N) means; NaN unless solved
  Eigen::MatrixXd P;  ///< (nx × nx N) their covariances, side by side
  /// As Likelihood::value: the filter's, from the determinant and the residual of the system.
  double log_likelihood = std::numeric_limits<double>::quiet_NaN();
  std::string culprit;

  [[nodiscard]] bool solved() const { return status == SmootherStatus::solved; }
};

/// Minimizes Σ |y - C x|²_R + Σ |x[k+1] - F x[k] - B u[k]|²_Q + |x[0] - x0|²_P0. With multipliers
/// of the dynamics as unknowns Q may be singular, and the system, in the order of time, is factored
/// as L D Lᵀ without pivoting by CHOLMOD: its pivots are minus the predicted covariances and the
/// filtered informations. Theory: "Covariances from logs".
///
/// @param model   P0 positive definite on the states that are not diffuse
/// @param theta   as start_of(model)
/// @throws InvalidInput  as InnovationLikelihood's constructor.
[[nodiscard]] SmoothedStates smooth(const FilterModel& model,
                                    const Eigen::Ref<const Eigen::VectorXd>& theta,
                                    const FilterRecord& record);

}  // namespace quadtune
