// SPDX-License-Identifier: Apache-2.0
/// Stability margins of a loop with one channel.
#pragma once

#include <iosfwd>
#include <limits>
#include <vector>

#include "quadtune/synthesis/open_loop.hpp"

namespace quadtune {

/// A frequency at which |L| = 1; it may be 0 rad/s.
struct GainCrossover {
  double w = 0;  ///< [rad/s]
  /// [rad] in (-π, π]: arg L + π. A phase lag of this size moves L to -1; if it is negative, a
  /// phase lead does.
  double phase_margin = 0;
  /// [s] The smallest delay that moves L to -1 here; 0 if the phase margin is 0 up to rounding.
  double delay_margin = 0;
};

/// An isolated frequency at which L is real and negative.
struct PhaseCrossover {
  double w = 0;            ///< [rad/s]
  double gain_margin = 0;  ///< 1/|L|: the factor that moves L to -1
};

/// The largest disk of complex factors, with the real-axis ends `gain_low` and `gain_high`, such
/// that the loop remains stable when it is multiplied by any of them, even if the factor varies
/// with frequency. Source: Seiler, Packard, Gahinet 2020.
struct DiskMargin {
  double alpha = 0;      ///< 1 / max |S + (skew - 1)/2|; 0 if the loop is unstable
  double w = 0;          ///< frequency of the worst factor [rad/s]
  double gain_low = 1;   ///< ≤ 1; may be negative
  double gain_high = 1;  ///< ≥ 1; infinite if the disk contains all large gains
  double phase = 0;      ///< [rad] lag or lead, 2 atan(α/2) if skew = 0; π: all phases
};

/// Margins of one loop. If the loop is unstable, they describe where L passes near -1 and are no
/// tolerances.
struct LoopMargins {
  bool stable = false;                         ///< whether the closed loop is stable
  std::vector<GainCrossover> gain_crossovers;  ///< in order of increasing frequency
  /// In order of increasing frequency; only those with |L| between 1e-6 and 1e6, or whose gain is
  /// one of the margins.
  std::vector<PhaseCrossover> phase_crossovers;
  int far_phase_crossovers = 0;  ///< number of crossovers on the grid omitted by that rule

  double gain_margin = std::numeric_limits<double>::infinity();  ///< min. factor > 1 with L = -1
  double gain_reduction = 0;                                     ///< max. factor < 1 with L = -1
  /// [rad] phase margin of the gain crossover at which its magnitude is smallest; infinite without
  /// a crossover. For a stable loop it is the magnitude, in (0, π]: the smallest phase lag or lead
  /// that destabilizes the loop. For an unstable loop it is signed.
  double phase_margin = std::numeric_limits<double>::infinity();
  double crossover = 0;  ///< frequency of phase_margin [rad/s]
  /// [s] minimum over all gain crossovers; infinite without one.
  double delay_margin = std::numeric_limits<double>::infinity();

  double Ms = 0;    ///< max |S|, S = 1/(1 + L); 1/Ms is the modulus margin
  double w_Ms = 0;  ///< [rad/s]
  double Mt = 0;    ///< max |T|, T = L/(1 + L)
  double w_Mt = 0;  ///< [rad/s]
  DiskMargin disk;  ///< simultaneous variation of gain and phase
};

/// Prints stability and all margins in one line.
std::ostream& operator<<(std::ostream& out, const LoopMargins& margins);

/// Computes the margins of a loop with one channel, continuous (with delay) or discrete. The
/// response is evaluated exactly on a grid that is dense around every pole and zero of the open and
/// of the closed loop; roots and peaks are then refined to rounding accuracy.
///
/// @param loop  one channel; OpenLoop::channel() extracts one of several
/// @param skew  of the disk: 0 symmetric (S - T), 1 based on S (modulus margin), -1 based on T
/// @throws InvalidInput  if the loop has several channels, or the skew is not finite
[[nodiscard]] LoopMargins loop_margins(const OpenLoop& loop, double skew = 0);

}  // namespace quadtune
