// SPDX-License-Identifier: Apache-2.0
/// The greatest gain of a PID loop within bounds, and the search over the other gains.
#pragma once

#include <limits>
#include <vector>

#include "pid/gain_gaps.hpp"
#include "quadtune/synthesis/pid_gains.hpp"

namespace quadtune::internal {

/// The gains over which a search moves. A problem may ignore either.
struct GainPoint {
  double log_Kp = 0;
  double log_Kd = 0;
};

/// A loop with bounds, of whose gains one is to be as large as possible.
///
/// For given other gains the loop's response is affine in that gain, and each bound at each
/// frequency forbids intervals of it; see forbid().
class GainProblem {
 public:
  virtual ~GainProblem() = default;

  /// @param log_gain  of the gain to be maximized; -∞ for 0
  [[nodiscard]] virtual PidGains gains(const GainPoint& x, double log_gain) const = 0;
  /// Frequencies [rad/s].
  [[nodiscard]] virtual const std::vector<double>& grid() const = 0;
  /// Appends what all frequencies of the grid forbid.
  /// @param base  gains() with the maximized one 0
  virtual void forbid_on_grid(const PidGains& base, std::vector<GainInterval>& forbidden) const = 0;
  /// Appends what one frequency forbids.
  virtual void forbid_at(const PidGains& base, double w,
                         std::vector<GainInterval>& forbidden) const = 0;
  [[nodiscard]] virtual bool stable(const PidGains& gains) const = 0;
  /// log of the largest ratio of a quantity to its bound; ≤ 0 within all bounds.
  [[nodiscard]] virtual double excess(const PidGains& gains) const = 0;
  /// The same for a bound on the response to a load, which is not one at each frequency.
  [[nodiscard]] virtual double load_excess(const PidGains& /*gains*/) const { return 0; }
  /// Whether no gain is too large.
  /// @param reached  beyond which no frequency forbids any
  [[nodiscard]] virtual bool is_unlimited(const GainPoint& /*x*/, double /*reached*/) const {
    return false;
  }

 protected:
  GainProblem() = default;
  GainProblem(const GainProblem&) = default;
  GainProblem& operator=(const GainProblem&) = default;
};

/// From worst to best.
enum class GainStatus {
  out_of_bounds,  ///< no gain keeps the bounds at all frequencies
  load_exceeded,  ///< a gain does, but the response to a load exceeds its bound
  within_bounds,
};

/// The greatest gain for given others. Ordered: the better status, then the smaller violation, or
/// the greater gain within the bounds.
struct GreatestGain {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  GainStatus status = GainStatus::out_of_bounds;
  double violation = kInfinity;  ///< log of the largest ratio to a bound, ≥ 0
  double log_gain = -kInfinity;  ///< infinite if unlimited

  [[nodiscard]] bool within_bounds() const { return status == GainStatus::within_bounds; }
  [[nodiscard]] bool operator>(const GreatestGain& other) const;
};

/// Where GainSearch::climb() moves, and how finely.
struct ClimbRange {
  bool over_Kp = true;
  bool over_Kd = true;
  double Kp_reach = 0.5;   ///< first moves of log Kp go so far
  double Kd_reach = 0.7;   ///< and of log Kd
  double Kp_width = 1e-6;  ///< to which log Kp is found
  double Kd_width = 1e-6;  ///< and log Kd
  double log_Kd_max = std::numeric_limits<double>::infinity();
};

/// A local search. It compares outcomes and never interpolates them: where two bounds meet they
/// have a ridge, and a change of status has no slope.
class GainSearch {
 public:
  /// @param problem  outlives the search
  explicit GainSearch(const GainProblem& problem) : problem_(problem) {}

  /// All frequencies leave intervals of the gain, in each of which the loop is stable or not as a
  /// whole: the end of the highest in which it is.
  [[nodiscard]] GreatestGain greatest(const GainPoint& x);

  /// The first of the best.
  [[nodiscard]] GainPoint best_of(const std::vector<GainPoint>& points);

  /// Climbs over Kp for every Kd, and over Kd: along a ridge a step in both at once would be
  /// needed.
  [[nodiscard]] GainPoint climb(GainPoint x, const ClimbRange& range);

  [[nodiscard]] int evaluations() const { return evaluations_; }

 private:
  [[nodiscard]] double log_end_of(const GainInterval& gap, const PidGains& base) const;

  const GainProblem& problem_;
  std::vector<GainInterval> forbidden_;  ///< kept, so that it is not allocated anew
  int evaluations_ = 0;
};

}  // namespace quadtune::internal
