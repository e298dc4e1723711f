// SPDX-License-Identifier: Apache-2.0
/// Is a loop stable for every value of its uncertain numbers and delay? A proof, not a sample.
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
  unstable,    ///< not stable at the middle of `where`, as far as computed poles tell
  not_proved,  ///< neither, within the budget
  interrupted,
};

/// "not run", "proved", "unstable", "not proved", "interrupted".
[[nodiscard]] std::string to_string(StabilityProofStatus status);

/// How hard it tries.
struct StabilityProofOptions {
  int most_boxes = 20000;  ///< that are looked at, ≥ 1; not proved beyond
  /// A proof is given up before its budget is spent where, by the share of a part's box that is
  /// proved, the part would take more than this many times the budget. Infinite: never.
  double give_up = std::numeric_limits<double>::infinity();
  std::size_t threads = 0;            ///< at most so many at once; 0: one for each processor
  std::function<bool()> interrupted;  ///< asked now and then, by any thread; empty: never
};

/// The answer with its evidence.
struct StabilityProof {
  StabilityProofStatus status = StabilityProofStatus::not_run;
  int boxes = 0;         ///< looked at, each with one Lyapunov function where it is proved
  int proved_boxes = 0;  ///< of these
  /// The loops that do not know of one another but by rounding, by the names of their states.
  std::vector<std::string> parts;
  /// By how much every loop contracts a period at least, in the norm of its box: ‖x⁺‖ ≤ (1 -
  /// gap)‖x‖.
  double gap = std::numeric_limits<double>::quiet_NaN();
  double coupling = 0;  ///< bound, in the same norms, of what rounding couples the parts by; < gap
  std::string part;     ///< of the box that is not proved, or unstable
  LoopBox where;        ///< that box: the numbers that move the part, and the delay
  std::vector<std::string> numbers;  ///< names of where's numbers
  std::string culprit;               ///< in words; empty when proved

  [[nodiscard]] bool proved() const { return status == StabilityProofStatus::proved; }
};

/// Proves that the closed loop's poles are inside the unit circle for all numbers and delays of a
/// box, each constant: the loop is split into parts, the box of each into smaller ones, and on each
/// one quadratic Lyapunov function is shown to fall at all corners, with what lies between the
/// corners, the matrix exponential's truncation and every rounding bounded.
///
/// A box that is stable with some distance is proved after enough splitting; how far the splitting
/// gets is the budget's question. The answer does not depend on the number of threads.
///
/// @param loop  at most ten numbers of some width in a part
/// @throws InvalidInput  for a loop or a box that is none
/// Theory: "Certified stability".
[[nodiscard]] StabilityProof prove_stability(const UncertainLoop& loop, const LoopBox& box,
                                             const StabilityProofOptions& options = {});

}  // namespace quadtune
