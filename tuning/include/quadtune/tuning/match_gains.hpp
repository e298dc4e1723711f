// SPDX-License-Identifier: Apache-2.0
/// The inverse of an LQR design: diagonal weights whose gain is a given one.
/// Method: docs/theory.md, "Weights of a given gain".
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/design.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/synthesis/state_feedback.hpp"

namespace quadtune {

/// How the search for weights ended.
enum class GainMatchStatus {
  not_run,
  matched,          ///< the gain is that of the weights, up to the tolerance
  not_matched,      ///< no diagonal weights were found that come so near; the nearest are told
  not_stabilizing,  ///< the given gain does not stabilize the plant, so it is no LQR's
  no_solution,      ///< no Riccati equation that was tried has a stabilizing solution
  interrupted,
};

/// "matched", "not matched", …
[[nodiscard]] std::string to_string(GainMatchStatus status);

/// What the gain tells of one weight.
enum class WeightVerdict {
  seen,         ///< the gain tells it
  hardly_seen,  ///< it may change by more than tenfold and the gain stays within the tolerance
  combination,  ///< only together with others; GainMatch::unseen says how
  not_seen,     ///< the gain does not depend on it
  at_zero,      ///< the gain wants none of it; `high` bounds it
  fixed,        ///< 0 as it came
};

/// "", "hardly seen", "in combination", "not seen", "at zero", "fixed"
[[nodiscard]] std::string to_string(WeightVerdict verdict);

/// One weight that was looked for.
struct MatchedWeight {
  std::string name;   ///< "Q(x)", "Q_integral(theta)", "R(w1)"
  double before = 0;  ///< where the first search began
  double value = 0;   ///< found
  /// As far as the weight may go, the others following in what the gain sees of them, while the
  /// scaled differences of the gain's entries together (their root of the sum of squares) stay
  /// below the tolerance; by the derivative of the gain, so exact for narrow intervals only. 0 and
  /// infinity where it is not seen.
  double low = 0, high = std::numeric_limits<double>::infinity();
  WeightVerdict verdict = WeightVerdict::seen;
};

/// How hard the search tries.
struct GainMatchOptions {
  /// Greatest difference of an entry, over the largest entry of its row or of its column in the
  /// given gain, whichever is smaller, with which the gain counts as matched. > 0
  double tolerance = 1e-3;
  int starts = 8;          ///< searches at most; fewer where one leaves no difference. ≥ 1
  std::uint64_t seed = 1;  ///< of the random starts
  /// Names of states, of integrals ("int_x") and of inputs whose weights are equal, a list each.
  std::vector<std::vector<std::string>> ties;
  std::function<bool()> interrupted;  ///< asked between evaluations; may be empty
};

/// Weights with their evidence.
struct GainMatch {
  GainMatchStatus status = GainMatchStatus::not_run;
  std::string culprit;  ///< why there are no weights; empty where there are some

  LqrDesign design;                    ///< with the weights that were found
  StateFeedback feedback;              ///< of that design
  std::vector<MatchedWeight> weights;  ///< of states, integrals, inputs
  std::vector<std::string> unseen;     ///< directions of the weights that the gain does not see

  double before = std::numeric_limits<double>::quiet_NaN();  ///< greatest difference at the start
  double after = std::numeric_limits<double>::quiet_NaN();   ///< and with the weights found
  std::string worst;    ///< the entry where that is, e.g. "K_int(w1, theta)"
  double given = 0;     ///< that entry as given
  double found = 0;     ///< and by the weights
  int evaluations = 0;  ///< Riccati equations solved by the searches
  int starts = 0;       ///< searches made
  int agreeing = 0;     ///< of them, those that ended where the best did

  /// Greatest singular value over frequencies of R^½ (I + L)⁻¹ S^-½, L the loop of the *given* gain
  /// at the plant's inputs, S = R (discrete: R + BᵀXB) with the weights found. Of an LQR gain it is
  /// at most 1, whatever its Q ≥ 0, diagonal or not: Kalman's inequality.
  double weighted_sensitivity = std::numeric_limits<double>::quiet_NaN();
  double weighted_sensitivity_at = 0;  ///< [rad/s]
  /// What the given gain costs more than the found one under the weights found, from a deviation of
  /// one state alone, relative, the worst; and the name of that state. NaN where it is not known:
  /// then `excess_culprit` says why, and the state is empty.
  double excess_cost = std::numeric_limits<double>::quiet_NaN();
  std::string excess_state;
  std::string excess_culprit;

  [[nodiscard]] bool has_weights() const {
    return status == GainMatchStatus::matched || status == GainMatchStatus::not_matched;
  }
};

/// Finds diagonal weights whose LQR gain is nearest to a given one, entry by entry relative to the
/// given gain's rows and columns, by Ceres' Levenberg–Marquardt on the logarithms of the weights
/// with the exact Jacobian of DiagonalLqr. A gain tells weights up to a common factor, which is
/// chosen so that R has the geometric mean that it came with, and nothing of weights that are not
/// diagonal: those are not looked for.
///
/// @param plant   nx states named as in `start.states`, nu inputs
/// @param start   the problem: integrals, method, dt; diagonal weights where the first search
///                begins. A weight of 0 stays 0; those of R are > 0
/// @param K       (nu × nx) of u = u0 + K (x_sp - x)
/// @param K_int   (nu × ni)
/// @throws InvalidInput  for shapes, non-finite entries, a gain of zeros, weights that are not
///                       diagonal or out of range, ties of unknown or twice tied names, options out
///                       of range.
/// Source: Kalman 1964 (when a gain is optimal); docs/theory.md (how the weights are found).
[[nodiscard]] GainMatch match_gains(const ContinuousLti& plant, const LqrDesign& start,
                                    const Eigen::Ref<const Eigen::MatrixXd>& K,
                                    const Eigen::Ref<const Eigen::MatrixXd>& K_int,
                                    const GainMatchOptions& options = {});

}  // namespace quadtune
