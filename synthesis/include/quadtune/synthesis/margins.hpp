// SPDX-License-Identifier: Apache-2.0
/// How far a loop of one channel is from instability.
#pragma once

#include <iosfwd>
#include <limits>
#include <vector>

#include "quadtune/synthesis/open_loop.hpp"

namespace quadtune {

/// Where |L| = 1, at 0 rad/s too.
struct GainCrossover {
  double w = 0;  ///< [rad/s]
  /// [rad] in (-π, π]: arg L + π. Lag of this size turns L to -1; if negative, lead does.
  double phase_margin = 0;
  double delay_margin = 0;  ///< [s] > 0: the least delay that turns L to -1 here
};

/// Where L is real and negative, at a single frequency.
struct PhaseCrossover {
  double w = 0;            ///< [rad/s]
  double gain_margin = 0;  ///< 1/|L|: the factor that brings L to -1
};

/// The largest disk of complex factors, of real-axis ends `gain_low` and `gain_high`, any of which,
/// even changing with frequency, leaves the loop stable. Source: Seiler, Packard, Gahinet 2020.
struct DiskMargin {
  double alpha = 0;      ///< 1 / max |S + (skew - 1)/2|; 0 of an unstable loop
  double w = 0;          ///< [rad/s] of the worst factor
  double gain_low = 1;   ///< ≤ 1; may be negative
  double gain_high = 1;  ///< ≥ 1; infinite where the disk contains all large gains
  double phase = 0;      ///< [rad] either way, 2 atan(α/2) if skew = 0; π where no turn leaves it
};

/// Margins of one loop. Those of an unstable loop tell where L passes -1, not how far it may move.
struct LoopMargins {
  bool stable = false;                         ///< the loop when closed
  std::vector<GainCrossover> gain_crossovers;  ///< by frequency
  /// By frequency; only those with |L| between 1e-6 and 1e6, or whose gain is one of the margins.
  std::vector<PhaseCrossover> phase_crossovers;
  int far_phase_crossovers = 0;  ///< how many that left out, of those on the grid

  double gain_margin = std::numeric_limits<double>::infinity();  ///< least factor > 1 to L = -1
  double gain_reduction = 0;                                     ///< largest factor < 1 to L = -1
  /// [rad] least of all crossovers in size; infinite without one. Of a stable loop it is the least
  /// turn, either way, that ends its stability: in (0, π]. Of an unstable one it is the
  /// crossover's, with its sign.
  double phase_margin = std::numeric_limits<double>::infinity();
  double crossover = 0;  ///< [rad/s] of phase_margin
  /// [s] least of all crossovers; infinite without one.
  double delay_margin = std::numeric_limits<double>::infinity();

  double Ms = 0;    ///< max |S|, S = 1/(1 + L); 1/Ms is the modulus margin
  double w_Ms = 0;  ///< [rad/s]
  double Mt = 0;    ///< max |T|, T = L/(1 + L)
  double w_Mt = 0;  ///< [rad/s]
  DiskMargin disk;
};

std::ostream& operator<<(std::ostream& out, const LoopMargins& margins);

/// Margins of a loop of one channel, continuous (with delay) or discrete: exact responses on a grid
/// that is dense around every pole and zero of the open and of the closed loop, then roots and
/// peaks refined to rounding.
///
/// @param loop  of one channel; OpenLoop::channel() makes one of several
/// @param skew  of the disk: 0 symmetric (as S - T), 1 the modulus margin's S, -1 that of T
/// @throws InvalidInput  for a loop of several channels, or a skew that is not finite
[[nodiscard]] LoopMargins loop_margins(const OpenLoop& loop, double skew = 0);

}  // namespace quadtune
