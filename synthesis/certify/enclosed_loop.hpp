// SPDX-License-Identifier: Apache-2.0
/// Enclosures of the closed loop of an UncertainLoop: at one point, over a box, and the deviation
/// from multilinear interpolation.
#pragma once

#include <vector>

#include "certify/enclosure.hpp"
#include "quadtune/synthesis/uncertain_loop.hpp"

namespace quadtune::internal {

/// A box in which the loop has the same states: the delay is `past` periods minus `ahead`, so that
/// u[k-past] is applied first in each period, and u[k-past+1] during the last `ahead`. past = 0: no
/// delay.
struct EnclosedBox {
  Eigen::VectorXd low;    ///< lower bounds of the parameters
  Eigen::VectorXd high;   ///< upper bounds of the parameters
  double ahead_low = 0;   ///< [s], 0 ≤ ahead ≤ dt; ignored if past = 0
  double ahead_high = 0;  ///< [s]
  int past = 0;           ///< number of past outputs of the law that are states
};

/// Splits a box at multiples of the control period in the delay, in increasing order; each result
/// has a fixed number of past outputs.
[[nodiscard]] std::vector<EnclosedBox> same_states(const LoopBox& box, double dt);

/// Encloses the matrix of one period of the closed loop at a point.
[[nodiscard]] Enclosure enclosed_loop(const UncertainLoop& loop, const Eigen::VectorXd& numbers,
                                      double ahead, int past);

/// Computes R_j ≥ 0, one for each parameter and then one for `ahead`: for every p in the box, M(p)
/// differs from the multilinear interpolation between the corners of the box by at most R = Σ R_j,
/// entry by entry.
/// R_j = (width_j)²/8 sup |∂²M/∂p_j²|.
[[nodiscard]] std::vector<Eigen::MatrixXd> interpolation_errors(const UncertainLoop& loop,
                                                                const EnclosedBox& box);

/// Computes upper bounds of |M(p)| over the box. They are nearly zero for entries that are zero in
/// all plants and in the law.
[[nodiscard]] Eigen::MatrixXd loop_size(const UncertainLoop& loop, const EnclosedBox& box);

/// The index of the part to which each state and input of a loop belongs.
struct PartNumbers {
  Eigen::VectorXi states;  ///< states of the plant (nx)
  Eigen::VectorXi memory;  ///< states of the law (ni)
  Eigen::VectorXi inputs;  ///< inputs of the plant (nu)
};

/// Computes upper bounds, over the box, of the contribution of paths through other parts to the
/// diagonal blocks of M(p), which lead from a part to itself: each block differs from the M(p) of
/// the part alone by at most this. The other blocks of the result have no meaning.
[[nodiscard]] Eigen::MatrixXd detour_size(const UncertainLoop& loop, const EnclosedBox& box,
                                          const PartNumbers& part);

}  // namespace quadtune::internal
