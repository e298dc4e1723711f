// SPDX-License-Identifier: Apache-2.0
/// How far the parameters of a loop may deviate from their nominal values: a proved lower bound,
/// and an upper bound by a search for unstable loops.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/synthesis/robust_stability.hpp"

namespace quadtune {

/// An uncertain parameter of a loop: a constant between two bounds.
struct UncertainParameter {
  std::string name;    ///< e.g. "mass"
  std::string unit;    ///< "" for a ratio
  double low = 1;      ///< lower bound
  double nominal = 1;  ///< low ≤ nominal ≤ high
  double high = 1;     ///< upper bound
};

/// The plant parameters and the delay of a loop at one point.
struct LoopPoint {
  Eigen::VectorXd numbers;  ///< θ of the UncertainLoop
  double delay = 0;         ///< [s]
};

/// A loop whose plant parameters and delay are functions of uncertain parameters, with their
/// bounds.
struct LoopFamily {
  UncertainLoop loop;                          ///< with constant terms and terms in θ
  std::vector<UncertainParameter> parameters;  ///< at least one
  /// The loop for given values of the parameters.
  std::function<LoopPoint(const Eigen::VectorXd&)> at;
  /// Bounds of at() over the box low … high. They may be conservative, but must contain all values.
  std::function<LoopBox(const Eigen::VectorXd& low, const Eigen::VectorXd& high)> over;
  /// The maximum factor, > 0, by which the box can be scaled about the nominal values and remain
  /// meaningful.
  double max_scale = 1;
  std::string max_scale_reason;  ///< reason of the limit, e.g. "the vehicle cannot hover"
};

/// Checks that there is at least one parameter, that bounds are in order, and that both functions
/// are set.
/// @throws InvalidInput  naming the parameter, its value and the expected value.
void validate(const LoopFamily& family, const std::string& where);

/// A box of parameter values: the lower and upper bound of each parameter.
struct ParameterBox {
  Eigen::VectorXd low,  ///< (n) lower bounds
      high;             ///< (n) upper bounds
};
/// Scales the box of a family about the nominal values.
[[nodiscard]] ParameterBox scaled_box(const LoopFamily& family, double scale);

/// A point of the box and the spectral radius of the loop there.
struct WorstCase {
  double radius = 0;           ///< computed spectral radius; unstable if ≥ 1 + 1e-8
  Eigen::VectorXd parameters;  ///< empty if there is no such point

  /// Whether a closed-loop pole is outside the unit circle.
  [[nodiscard]] bool unstable() const { return radius >= 1 + 1e-8; }
};

/// Options of assess_robustness().
struct RobustnessOptions {
  StabilityProofOptions proof;  ///< for the unscaled box
  int bracket_boxes = 1000;     ///< maximum number of boxes per proof of a scaled box
  double tolerance = 0.02;      ///< relative width at which the bracket is accepted, in (0, 1)
  std::uint64_t seed = 1;       ///< of the random points of the search
};

/// The result: proved_scale ≤ the smallest scale at which the loop is unstable ≤ found_scale.
struct Robustness {
  StabilityProof proof;  ///< of the unscaled box
  WorstCase worst;       ///< the largest radius that the search found in that box
  /// The largest scale that was proved, at most LoopFamily::max_scale; 0: not even nominal.
  double proved_scale = 0;
  /// The smallest scale at which an unstable loop was found; infinite if none was found up to
  /// LoopFamily::max_scale.
  double found_scale = std::numeric_limits<double>::infinity();
  WorstCase found;  ///< the unstable loop at that scale
  int boxes = 0;    ///< examined by all proofs together
};

/// Tries to prove the box, searches it for the worst loop, and brackets the scale at which
/// stability is lost.
/// @throws InvalidInput  for the reasons of validate() and prove_stability().
[[nodiscard]] Robustness assess_robustness(const LoopFamily& family,
                                           const RobustnessOptions& options = {});

}  // namespace quadtune
