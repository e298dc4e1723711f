// SPDX-License-Identifier: Apache-2.0
/// Converts the covariances of a tuned filter model to those of a filter on board.
#pragma once

#include <Eigen/Core>
#include <string>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/lti.hpp"

namespace quadtune {

template <class T>
struct UquadFilterSettings;

/// Noise of a filter with a control period.
struct NoisePerStep {
  Eigen::MatrixXd Q;  ///< (nw × nw) covariance of w per step
  Eigen::MatrixXd R;  ///< (ny × ny) covariance per measurement
};

/// Noise for a filter x[k+1] = A x + B u + G w, y = C x + v whose noise acts on the same states as
/// that of the model. Q is the model's density times dt, for programs that add the noise of a
/// period at its end, or Q itself if the model is discrete with the same period. A measurement
/// whose row of C has the opposite sign in the model (height instead of a coordinate that points
/// down) has the same variance.
///
/// @param model   with the tuned variances as starts, see with_noise()
/// @param filter  states with the same names in the same order
/// @param G       (nx × nw) of the filter
/// @param where   beginning of messages
/// @throws InvalidInput  "where: …" if states, noises, measurements or period differ
[[nodiscard]] NoisePerStep noise_per_step(const FilterModel& model, const DiscreteLti& filter,
                                          const Eigen::MatrixXd& G, const std::string& where);

/// Copies the variances of a tuned rigid_body_model() to the settings of the uquad's filter: Q is
/// the model's density times settings.dt; the R of a sensor that the model does not have remains
/// unchanged.
///
/// @param model     with the tuned variances as starts, see with_noise()
/// @param where     beginning of messages
/// @param settings  receives the variances
/// @throws InvalidInput  "where: …" for another kind of model, or if the axes of a sensor have
///                       different variances, which the filter does not support
void copy_noise(const FilterModel& model, const std::string& where,
                UquadFilterSettings<double>& settings);

}  // namespace quadtune
