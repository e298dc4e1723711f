// SPDX-License-Identifier: Apache-2.0
/// Maximizes one gain of a PID loop within bounds, and searches over the other gains.
#pragma once

#include <limits>
#include <vector>

#include "pid/gain_gaps.hpp"
#include "quadtune/synthesis/pid/pid_gains.hpp"

namespace quadtune::internal {

/// The gains that are searched. A problem may ignore either of them.
struct GainPoint {
  double log_Kp = 0;
  double log_Kd = 0;
};

/// A loop with bounds and one gain that is to be maximized.
///
/// If the other gains are fixed, the response of the loop is affine in that gain, and each bound at
/// each frequency forbids intervals of it; see forbid().
class GainProblem {
 public:
  virtual ~GainProblem() = default;

  /// Returns all gains.
  /// @param log_gain  logarithm of the gain to maximize; -∞ for a gain of 0
  [[nodiscard]] virtual PidGains gains(const GainPoint& x, double log_gain) const = 0;
  /// The frequency grid [rad/s].
  [[nodiscard]] virtual const std::vector<double>& grid() const = 0;
  /// Appends the forbidden intervals of all frequencies of the grid.
  /// @param base  gains() with the maximized gain set to 0
  virtual void forbid_on_grid(const PidGains& base, std::vector<GainInterval>& forbidden) const = 0;
  /// Appends the forbidden intervals of one frequency.
  virtual void forbid_at(const PidGains& base, double w,
                         std::vector<GainInterval>& forbidden) const = 0;
  [[nodiscard]] virtual bool stable(const PidGains& gains) const = 0;
  /// Logarithm of the largest ratio of a quantity to its bound; ≤ 0 if all bounds are satisfied.
  [[nodiscard]] virtual double excess(const PidGains& gains) const = 0;
  /// The same for the bound on the load response, which is not a bound at each frequency.
  [[nodiscard]] virtual double load_excess(const PidGains& /*gains*/) const { return 0; }
  /// Whether the gain is unbounded above.
  /// @param reached  gain above which no frequency forbids any
  [[nodiscard]] virtual bool is_unlimited(const GainPoint& /*x*/, double /*reached*/) const {
    return false;
  }

 protected:
  GainProblem() = default;
  GainProblem(const GainProblem&) = default;
  GainProblem& operator=(const GainProblem&) = default;
};

/// The outcome for given other gains, in order from worst to best.
enum class GainStatus {
  out_of_bounds,  ///< no gain satisfies the bounds at all frequencies
  load_exceeded,  ///< a gain does, but the load response exceeds its bound
  within_bounds,
};

/// The maximum gain for given other gains. A result is greater if its status is better or, for
/// equal status, if its violation is smaller (outside the bounds) or its gain larger (within them).
struct MaxGain {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  GainStatus status = GainStatus::out_of_bounds;
  double violation = kInfinity;  ///< logarithm of the largest ratio to a bound, ≥ 0
  double log_gain = -kInfinity;  ///< infinite if unlimited

  [[nodiscard]] bool within_bounds() const { return status == GainStatus::within_bounds; }
  [[nodiscard]] bool operator>(const MaxGain& other) const;
};

/// Options of GainSearch::climb().
struct ClimbRange {
  bool over_Kp = true;
  bool over_Kd = true;
  double Kp_reach = 0.5;   ///< initial half-width of the search interval in log Kp
  double Kd_reach = 0.7;   ///< the same in log Kd
  double Kp_width = 1e-6;  ///< accuracy of log Kp
  double Kd_width = 1e-6;  ///< accuracy of log Kd
  double log_Kd_max = std::numeric_limits<double>::infinity();
};

/// A local search. It only compares outcomes and never interpolates them, because the objective has
/// a ridge where two bounds are active and is discontinuous where the status changes.
class GainSearch {
 public:
  /// @param problem  must outlive the search
  explicit GainSearch(const GainProblem& problem) : problem_(problem) {}

  /// Maximizes the gain for given other gains. All frequencies together leave feasible intervals; a
  /// loop is either stable or unstable in the whole of an interval. The result is the end of the
  /// highest interval with a stable loop.
  [[nodiscard]] MaxGain max(const GainPoint& x);

  /// Returns the best point, the first one if several are equal.
  [[nodiscard]] GainPoint best_of(const std::vector<GainPoint>& points);

  /// Maximizes over Kd, and for every Kd over Kp. Nested searches follow a ridge, along which
  /// separate steps in Kp and Kd would not improve the result.
  [[nodiscard]] GainPoint climb(GainPoint x, const ClimbRange& range);

  [[nodiscard]] int evaluations() const { return evaluations_; }

 private:
  [[nodiscard]] double log_end_of(const GainInterval& gap, const PidGains& base) const;

  const GainProblem& problem_;
  std::vector<GainInterval> forbidden_;  ///< a member to reuse its memory
  int evaluations_ = 0;
};

}  // namespace quadtune::internal
