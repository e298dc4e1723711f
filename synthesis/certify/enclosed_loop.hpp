// SPDX-License-Identifier: Apache-2.0
/// The closed loop of an UncertainLoop as an enclosure: at one point, over a box, and how far it
/// bends in between.
#pragma once

#include <vector>

#include "certify/enclosure.hpp"
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

/// R_j ≥ 0, one for each number and then one for `ahead`: for every p in the box M(p) is within
/// R = Σ R_j, entry by entry, of the multilinear interpolation between the corners of the box.
/// R_j = (width_j)²/8 sup |∂²M/∂p_j²|.
[[nodiscard]] std::vector<Eigen::MatrixXd> interpolation_errors(const UncertainLoop& loop,
                                                                const EnclosedBox& box);

/// Bounds of |M(p)| over the box, those of what is zero in all plants and in the law nearly zero.
[[nodiscard]] Eigen::MatrixXd loop_size(const UncertainLoop& loop, const EnclosedBox& box);

/// To which part of a loop each belongs, by the parts' numbers.
struct PartNumbers {
  Eigen::VectorXi states;  ///< of the plant (nx)
  Eigen::VectorXi memory;  ///< of the law (ni)
  Eigen::VectorXi inputs;  ///< of the plant (nu)
};

/// Bounds, over the box, of what the ways through other parts add to the blocks of M(p) that lead
/// from a part to itself: those blocks are within them of the M(p) of the part alone. Of no meaning
/// in the other blocks.
[[nodiscard]] Eigen::MatrixXd detour_size(const UncertainLoop& loop, const EnclosedBox& box,
                                          const PartNumbers& part);

}  // namespace quadtune::internal
