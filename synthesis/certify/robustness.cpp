// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/robustness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "certify/robustness_search.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

/// Tries to prove the scaled box.
StabilityProof prove_scaled(const LoopFamily& family, double scale,
                            const StabilityProofOptions& options) {
  const ParameterBox box = scaled_box(family, scale);
  return prove_stability(family.loop, family.over(box.low, box.high), options);
}

/// Raises proved_scale until the bracket is narrow: first tries nearly found_scale, then bisects.
/// The number of boxes increases at least with the square of the scale if two intervals of a part
/// grow. If a proof used half of the budget, no larger scale is tried.
void narrow_bracket(const LoopFamily& family, const RobustnessOptions& options,
                    Robustness& result) {
  StabilityProofOptions proof_options = options.proof;
  proof_options.max_boxes = options.bracket_boxes;
  proof_options.abort_factor = 2;
  int taken = result.proof.boxes;
  double beyond = std::min(result.found_scale, family.max_scale);
  if (!result.proof.proved()) beyond = std::min(beyond, 1.0);
  double scale =
      result.found_scale <= family.max_scale ? beyond * (1 - 0.5 * options.tolerance) : beyond;
  constexpr int kMaxProofs = 12;
  for (int i = 0; i < kMaxProofs && result.proved_scale < beyond * (1 - options.tolerance); ++i) {
    if (result.proved_scale > 0 && 2 * taken > options.bracket_boxes) return;
    if (scale <= result.proved_scale) scale = 0.5 * (result.proved_scale + beyond);
    const StabilityProof proof = prove_scaled(family, scale, proof_options);
    result.boxes += proof.boxes;
    if (proof.status == StabilityProofStatus::interrupted) {
      result.proof.status = StabilityProofStatus::interrupted;
      return;
    }
    (proof.proved() ? result.proved_scale : beyond) = scale;
    if (proof.proved()) taken = proof.boxes;
    scale = 0.5 * (result.proved_scale + beyond);
  }
}

}  // namespace

void validate(const LoopFamily& family, const std::string& where) {
  validate(family.loop, where);
  if (!family.at || !family.over)
    throw InvalidInput(where, "the functions at() and over() are not set, expected both");
  if (family.parameters.empty())
    throw InvalidInput(where, "there are no parameters, expected at least one");
  for (const UncertainParameter& p : family.parameters)
    if (!(p.low <= p.nominal) || !(p.nominal <= p.high) || !std::isfinite(p.low) ||
        !std::isfinite(p.high))
      throw InvalidInput(where, fmt::format("{} is in {} … {} with the nominal value {}, expected "
                                            "finite bounds around the nominal value",
                                            p.name, p.low, p.high, p.nominal));
  if (!(family.max_scale > 0) || !std::isfinite(family.max_scale))
    throw InvalidInput(
        where, fmt::format("the maximum scale is {}, expected more than 0", family.max_scale));
}

ParameterBox scaled_box(const LoopFamily& family, double scale) {
  const auto count = static_cast<Eigen::Index>(family.parameters.size());
  ParameterBox box{Eigen::VectorXd(count), Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const UncertainParameter& p = family.parameters[static_cast<std::size_t>(i)];
    box.low(i) = scale == 1 ? p.low : p.nominal - scale * (p.nominal - p.low);
    box.high(i) = scale == 1 ? p.high : p.nominal + scale * (p.high - p.nominal);
  }
  return box;
}

Robustness assess_robustness(const LoopFamily& family, const RobustnessOptions& options) {
  validate(family, "assess_robustness");
  if (!(options.tolerance > 0) || !(options.tolerance < 1) || options.bracket_boxes < 1)
    throw InvalidInput("assess_robustness",
                       fmt::format("tolerance is {} and bracket_boxes is {}, expected a tolerance "
                                   "in (0, 1) and 1 box or more",
                                   options.tolerance, options.bracket_boxes));
  Robustness result;
  result.proof = prove_scaled(family, 1, options.proof);
  result.boxes = result.proof.boxes;
  if (result.proof.proved()) result.proved_scale = std::min(1.0, family.max_scale);
  internal::RobustnessSearch search(family, options.seed, options.proof.threads,
                                    options.proof.interrupted);
  result.worst = search.worst();
  const auto nearest = search.nearest();
  result.found_scale = nearest.scale;
  result.found = nearest.found;
  narrow_bracket(family, options, result);
  return result;
}

}  // namespace quadtune
