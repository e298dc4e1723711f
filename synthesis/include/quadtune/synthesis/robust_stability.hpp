// SPDX-License-Identifier: Apache-2.0
/// Proves that a loop is stable for all values of its uncertain parameters and its delay.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/synthesis/uncertain_loop.hpp"

namespace quadtune {

/// How a proof ended.
enum class StabilityProofStatus {
  not_run,
  proved,      ///< stable at every point of the box
  unstable,    ///< unstable at the midpoint of `where`, according to its computed poles
  not_proved,  ///< neither was shown within the budget
  interrupted,
};

/// "not run", "proved", "unstable", "not proved", "interrupted".
[[nodiscard]] std::string to_string(StabilityProofStatus status);

/// Options of prove_stability().
struct StabilityProofOptions {
  int max_boxes = 20000;  ///< maximum number of boxes to examine, ≥ 1
  /// The proof is aborted early if one part, extrapolated from the fraction of its box that is
  /// proved, would need more than this multiple of the budget. Infinite: never.
  double abort_factor = std::numeric_limits<double>::infinity();
  std::size_t threads = 0;            ///< maximum number of threads; 0: one per processor
  std::function<bool()> interrupted;  ///< polled from any thread; true aborts; empty: never
};

/// The verdict with its evidence.
struct StabilityProof {
  /// Proved, unstable, or why it is undecided.
  StabilityProofStatus status = StabilityProofStatus::not_run;
  int boxes = 0;         ///< examined; each proved box has one Lyapunov function
  int proved_boxes = 0;  ///< number of boxes that are proved
  /// The parts of the loop that are decoupled up to rounding, described by the names of their
  /// states.
  std::vector<std::string> parts;
  /// Minimum contraction in one period over all boxes: in the norm of the box,
  /// ‖x⁺‖ ≤ (1 - gap) ‖x‖.
  double gap = std::numeric_limits<double>::quiet_NaN();
  double coupling = 0;  ///< upper bound of the coupling between parts in these norms; < gap
  std::string part;     ///< the part of the loop that is unstable or not proved in `where`
  LoopBox where;        ///< that box: the parameters that affect the part, and the delay
  std::vector<std::string> numbers;  ///< names of the parameters of `where`
  std::string culprit;               ///< description; empty when proved

  /// Whether the loop is stable for all values in the box.
  [[nodiscard]] bool proved() const { return status == StabilityProofStatus::proved; }
};

/// Proves that all poles of the closed loop are inside the unit circle for all constant values of
/// the parameters and the delay in a box. The loop is split into decoupled parts and the box of
/// each part into smaller boxes. For each box, one quadratic Lyapunov function is shown to decrease
/// at all corners; the deviation between the corners, the truncation of the matrix exponential and
/// all rounding errors are bounded.
///
/// A box in which the loop is stable with a positive margin is proved after sufficiently many
/// splits; the budget limits their number. The result does not depend on the number of threads.
///
/// @param loop     at most ten parameters with an interval of positive width in each part
/// @param box      bounds of the parameters and of the delay
/// @param options  number of boxes and of threads
/// @throws InvalidInput  if the loop or the box is invalid; see their validate()
/// Theory: "Certified stability".
[[nodiscard]] StabilityProof prove_stability(const UncertainLoop& loop, const LoopBox& box,
                                             const StabilityProofOptions& options = {});

}  // namespace quadtune
