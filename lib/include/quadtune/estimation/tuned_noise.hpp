// SPDX-License-Identifier: Apache-2.0
/// The covariances of a tuned filter model as those of a filter on board.
#pragma once

#include <Eigen/Core>
#include <string>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/lti.hpp"

namespace quadtune {

template <class T>
struct UquadFilterSettings;

struct NoisePerStep {
  Eigen::MatrixXd Q;  ///< (nw × nw) of w, each step
  Eigen::MatrixXd R;  ///< (ny × ny) of a measurement
};

/// For a filter x[k+1] = A x + B u + G w, y = C x + v whose noise acts on the same states as the
/// model's: Q is the model's density times dt, as program steps that add the noise of a period at
/// its end have it, or Q itself where the model is discrete with the same period. A measurement
/// whose row of C is the model's with the other sign, a height for a coordinate down, has the same
/// variance.
///
/// @param model   with the tuned variances as starts, see with_noise()
/// @param filter  its states by the same names, in order
/// @param G       (nx × nw) of the filter
/// @throws InvalidInput  "where: …" for other states, noises, measurements or another period.
[[nodiscard]] NoisePerStep noise_per_step(const FilterModel& model, const DiscreteLti& filter,
                                          const Eigen::MatrixXd& G, const std::string& where);

/// Takes the variances of a tuned rigid_body_model() into the uquad's filter: Q is the model's
/// density times settings.dt; R of a sensor that the model has not stays as it is.
///
/// @param model  with the tuned variances as starts, see with_noise()
/// @throws InvalidInput  "where: …" for another kind of model, or a sensor whose axes have
/// different
///                       variances, which the filter has not.
void take_noise(const FilterModel& model, const std::string& where,
                UquadFilterSettings<double>& settings);

}  // namespace quadtune
