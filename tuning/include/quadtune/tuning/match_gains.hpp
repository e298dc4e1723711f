// SPDX-License-Identifier: Apache-2.0
/// The inverse LQR problem: diagonal weights whose LQR gain is a given one.
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
  matched,  ///< the weights reproduce the gain within the tolerance
  /// No diagonal weights within the tolerance were found; the closest are returned
  not_matched,
  not_stabilizing,  ///< the given gain does not stabilize the plant, so it is not an LQR gain
  no_solution,      ///< none of the Riccati equations solved has a stabilizing solution
  interrupted,
};

/// "matched", "not matched", …
[[nodiscard]] std::string to_string(GainMatchStatus status);

/// How well the gain determines one weight.
enum class WeightVerdict {
  seen,         ///< the gain determines it
  hardly_seen,  ///< it may change by more than a factor of ten within the tolerance on the gain
  combination,  ///< only a combination with others is determined; see GainMatch::unseen
  not_seen,     ///< the gain does not depend on it
  at_zero,      ///< the best value is 0; `high` is its upper bound
  fixed,        ///< 0 in the start, and held there
};

/// "", "poorly determined", "in combination", "not determined", "at zero", "fixed"
[[nodiscard]] std::string to_string(WeightVerdict verdict);

/// One weight of the search.
struct MatchedWeight {
  std::string name;   ///< "Q(x)", "Q_integral(theta)", "R(w1)"
  double before = 0;  ///< start value of the first search
  double value = 0;   ///< the result
  /// Interval of the weight, within which the root sum of squares of the scaled gain differences
  /// stays below the tolerance while the other weights compensate as far as they can. Computed from
  /// the derivative of the gain, so accurate for narrow intervals only. 0 and infinity if the gain
  /// does not determine the weight.
  double low = 0,                                      ///< lower end
      high = std::numeric_limits<double>::infinity();  ///< upper end
  WeightVerdict verdict = WeightVerdict::seen;         ///< whether the gain determines the weight
};

/// Options of the search.
struct GainMatchOptions {
  /// Largest difference of an entry with which the gain counts as matched, relative to the largest
  /// entry of its row or of its column in the given gain, whichever is smaller. > 0
  double tolerance = 1e-3;
  int starts = 8;          ///< maximum number of searches; fewer if one leaves no difference. ≥ 1
  std::uint64_t seed = 1;  ///< of the random starts
  /// Lists of names of states, of integrals ("int_x") or of inputs whose weights are equal.
  std::vector<std::vector<std::string>> ties;
  std::function<bool()> interrupted;  ///< called between evaluations; true interrupts; may be empty
};

/// Weights with their evidence.
struct GainMatch {
  GainMatchStatus status = GainMatchStatus::not_run;  ///< matched, or why not
  std::string culprit;  ///< why there are no weights; empty if there are

  LqrDesign design;                    ///< with the resulting weights
  StateFeedback feedback;              ///< of that design
  std::vector<MatchedWeight> weights;  ///< of states, integrals, inputs
  /// Directions of the weights that the gain does not determine
  std::vector<std::string> unseen;

  double before = std::numeric_limits<double>::quiet_NaN();  ///< largest difference at the start
  /// Largest difference with the resulting weights
  double after = std::numeric_limits<double>::quiet_NaN();
  std::string worst;    ///< the entry with that difference, e.g. "K_int(w1, theta)"
  double given = 0;     ///< value of that entry in the given gain
  double found = 0;     ///< value of that entry with the resulting weights
  int evaluations = 0;  ///< number of Riccati equations solved by the searches
  int starts = 0;       ///< number of searches
  int agreeing = 0;     ///< number of searches that ended at the best result

  /// Largest singular value over frequencies of R^½ (I + L)⁻¹ S^-½, where L is the loop of the
  /// *given* gain at the inputs of the plant and S = R (discrete: R + BᵀXB) with the resulting
  /// weights. For an LQR gain with any Q ≥ 0, diagonal or not, it is at most 1 (Kalman's
  /// inequality).
  double weighted_sensitivity = std::numeric_limits<double>::quiet_NaN();
  double weighted_sensitivity_at = 0;  ///< [rad/s]
  /// Largest relative excess cost of the given gain over the resulting one, under the resulting
  /// weights and for an initial deviation of one state alone, and the name of that state. NaN if it
  /// is not known: then `excess_culprit` states why, and the state is empty.
  double excess_cost = std::numeric_limits<double>::quiet_NaN();
  std::string excess_state;    ///< see excess_cost
  std::string excess_culprit;  ///< see excess_cost

  /// Whether a search ended with weights, close or not.
  [[nodiscard]] bool has_weights() const {
    return status == GainMatchStatus::matched || status == GainMatchStatus::not_matched;
  }
};

/// Computes the diagonal weights whose LQR gain is closest to a given one, entry by entry relative
/// to the rows and columns of the given gain, by the Levenberg–Marquardt method of Ceres on the
/// logarithms of the weights with the exact Jacobian of DiagonalLqr. A gain determines weights only
/// up to a common factor, which is chosen so that R keeps the geometric mean of its start. Weights
/// that are not diagonal are not searched.
///
/// @param plant    nx states named as in `start.states`, nu inputs
/// @param start    the problem: integrals, method, dt; diagonal weights at which the first search
///                 starts. A weight of 0 stays 0; those of R are > 0
/// @param K        (nu × nx) of u = u0 + K (x_sp - x)
/// @param K_int    (nu × ni)
/// @param options  ties, tolerance and number of starts
/// @throws InvalidInput  for wrong shapes, non-finite entries, a zero gain, weights that are not
///                       diagonal or out of range, ties with unknown or repeated names, options out
///                       of range.
/// Source: Kalman 1964 (when a gain is optimal); docs/theory.md (how the weights are computed).
[[nodiscard]] GainMatch match_gains(const ContinuousLti& plant, const LqrDesign& start,
                                    const Eigen::Ref<const Eigen::MatrixXd>& K,
                                    const Eigen::Ref<const Eigen::MatrixXd>& K_int,
                                    const GainMatchOptions& options = {});

}  // namespace quadtune
