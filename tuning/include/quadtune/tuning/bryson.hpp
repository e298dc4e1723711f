// SPDX-License-Identifier: Apache-2.0
/// LQR weights from the largest acceptable deviations: the usual first guess before a search.
#pragma once

#include <Eigen/Core>

#include "quadtune/synthesis/lqr.hpp"

namespace quadtune {

/// Bryson's rule: Q_ii = 1 / x_max,i², R_ii = 1 / u_max,i², so that a deviation at its limit costs
/// 1.
///
/// @param x_max  (nx) largest acceptable deviation of each state [its unit], > 0; infinity gives
///               weight 0
/// @param u_max  (nu) largest acceptable deviation of each input from trim [its unit], > 0, finite
/// @throws InvalidInput  naming the entry that is not positive.
/// Source: Bryson and Ho 1975, section 5.2.
[[nodiscard]] LqrWeights bryson_weights(const Eigen::Ref<const Eigen::VectorXd>& x_max,
                                        const Eigen::Ref<const Eigen::VectorXd>& u_max);

}  // namespace quadtune
