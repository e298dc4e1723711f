// SPDX-License-Identifier: Apache-2.0
/// Smoother: all states of a record given all its measurements, from one sparse Gaussian system.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/filter_record.hpp"

namespace quadtune {

/// Outcome of the smoother.
enum class SmootherStatus {
  not_run,
  solved,
  singular,    ///< a state is known exactly, or not observable, so that the system has no inverse
  overflowed,  ///< a value exceeded the range of a double
};

/// The states of a record given all its measurements.
struct SmoothedStates {
  SmootherStatus status = SmootherStatus::not_run;  ///< solved, or why there are no states
  Eigen::MatrixXd x;                                ///< (nx × N) means; NaN unless solved
  Eigen::MatrixXd P;  ///< (nx × nx N) their covariances, side by side
  /// As Likelihood::value: that of the filter, computed from the determinant and the residual of
  /// the system.
  double log_likelihood = std::numeric_limits<double>::quiet_NaN();
  std::string culprit;  ///< why it is not solved; empty if it is

  /// Whether there are states.
  [[nodiscard]] bool solved() const { return status == SmootherStatus::solved; }
};

/// Minimizes Σ |y - C x|²_R + Σ |x[k+1] - F x[k] - B u[k]|²_Q + |x[0] - x0|²_P0, where |e|²_S is
/// eᵀ S⁻¹ e and Q is the covariance of G w per step. The multipliers of the dynamics are unknowns
/// too, so that Q may be singular. The system, ordered by time, is
/// factored as L D Lᵀ without pivoting by CHOLMOD: its pivots are the negative predicted
/// covariances and the filtered information matrices. Theory: "Covariances from logs".
///
/// @param model   P0 positive definite on the states that are not diffuse
/// @param theta   as start_of(model)
/// @param record  accepted by validate()
/// @throws InvalidInput  as InnovationLikelihood's constructor.
[[nodiscard]] SmoothedStates smooth(const FilterModel& model,
                                    const Eigen::Ref<const Eigen::VectorXd>& theta,
                                    const FilterRecord& record);

}  // namespace quadtune
