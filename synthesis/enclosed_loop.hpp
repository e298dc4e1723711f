// SPDX-License-Identifier: Apache-2.0
/// The closed loop of an UncertainLoop as an enclosure: at one point, over a box, and how far it
/// bends in between.
#pragma once

#include <vector>

#include "enclosure.hpp"
#include "quadtune/synthesis/uncertain_loop.hpp"

namespace quadtune::internal {

/// A box on which the loop has the same states: the delay is `past` periods less `ahead`, so that
/// u[k-past] acts first and u[k-past+1] for the last `ahead` of each period. past = 0: no delay.
struct EnclosedBox {
  Eigen::VectorXd low;    ///< of the numbers
  Eigen::VectorXd high;   ///< likewise
  double ahead_low = 0;   ///< [s], 0 ≤ ahead ≤ dt; of no meaning where past = 0
  double ahead_high = 0;  ///< [s]
  int past = 0;           ///< outputs of the law that are states
};

/// The parts of a delay's interval with as many past outputs each, in order.
[[nodiscard]] std::vector<EnclosedBox> same_states(const LoopBox& box, double dt);

/// One period of the closed loop at a point, every rounding bounded.
[[nodiscard]] Enclosure enclosed_loop(const UncertainLoop& loop, const Eigen::VectorXd& numbers,
                                      double ahead, int past);

/// R ≥ 0 with M(p) within R, entry by entry, of the multilinear interpolation between the corners
/// of the box, for every p in it: R = Σ_j (width_j)²/8 sup |∂²M/∂p_j²|.
[[nodiscard]] Eigen::MatrixXd interpolation_error(const UncertainLoop& loop,
                                                  const EnclosedBox& box);

/// Bounds of |M(p)| over the box, those of what is zero in all plants and in the law nearly zero.
[[nodiscard]] Eigen::MatrixXd loop_size(const UncertainLoop& loop, const EnclosedBox& box);

}  // namespace quadtune::internal
