// SPDX-License-Identifier: Apache-2.0
/// How far the parameters of a loop may be from their nominal values: what is proved below, what a
/// search found above.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/synthesis/robust_stability.hpp"

namespace quadtune {

/// One thing that is not known of a loop: constant, somewhere between two bounds.
struct UncertainParameter {
  std::string name;  ///< e.g. "mass"
  std::string unit;  ///< "" of a ratio
  double low = 1;
  double nominal = 1;  ///< low ≤ nominal ≤ high
  double high = 1;
};

/// Numbers and delay of a loop for one value of each parameter.
struct LoopPoint {
  Eigen::VectorXd numbers;
  double delay = 0;  ///< [s]
};

/// A loop whose numbers and delay follow from parameters, and the box that these are in.
struct LoopFamily {
  UncertainLoop loop;
  std::vector<UncertainParameter> parameters;
  /// The loop of one value of each parameter.
  std::function<LoopPoint(const Eigen::VectorXd&)> at;
  /// Bounds of at() over low … high; they may be wide, not narrow.
  std::function<LoopBox(const Eigen::VectorXd& low, const Eigen::VectorXd& high)> over;
  /// How far the box can be scaled about the nominal values until it means nothing any more, > 0.
  double greatest_scale = 1;
  std::string greatest_scale_reason;  ///< why not further, e.g. "the vehicle cannot hover"
};

/// Checks bounds in order, at least one parameter, both functions.
/// @throws InvalidInput  naming the parameter, what came and what was expected.
void validate(const LoopFamily& family, const std::string& where);

/// The box scaled about the nominal values: low and high ends of each parameter.
struct ParameterBox {
  Eigen::VectorXd low, high;
};
[[nodiscard]] ParameterBox scaled_box(const LoopFamily& family, double scale);

/// A point of the box with what the loop does there.
struct WorstCase {
  double radius = 0;           ///< spectral radius, computed; ≥ 1 + 1e-8 counts as unstable
  Eigen::VectorXd parameters;  ///< empty where there is none

  [[nodiscard]] bool unstable() const { return radius >= 1 + 1e-8; }
};

/// How hard the search and the proofs try.
struct RobustnessOptions {
  StabilityProofOptions proof;  ///< of the box as it is
  int bracket_boxes = 1000;     ///< of each of the proofs of scaled boxes
  double tolerance = 0.02;  ///< the bracket is left alone when narrower than this share, in (0, 1)
  std::uint64_t seed = 1;   ///< of the points that the search draws
};

/// proved_scale ≤ the scale at which the loop first loses stability ≤ found_scale.
struct Robustness {
  StabilityProof proof;     ///< of the box as it is
  WorstCase worst;          ///< the largest radius that the search found in that box
  double proved_scale = 0;  ///< of the largest scaled box that was proved; 0: not even nominal
  /// Of the smallest with an unstable loop that was found; infinite where none was found up to the
  /// family's greatest scale.
  double found_scale = std::numeric_limits<double>::infinity();
  WorstCase found;  ///< at that scale
  int boxes = 0;    ///< looked at by all proofs together
};

/// Proves the box, searches it, and brackets the scale at which stability is lost.
/// @throws InvalidInput  as validate() and prove_stability().
[[nodiscard]] Robustness assess_robustness(const LoopFamily& family,
                                           const RobustnessOptions& options = {});

}  // namespace quadtune
