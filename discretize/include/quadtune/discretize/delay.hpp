// SPDX-License-Identifier: Apache-2.0
/// Delays of inputs and outputs as states of the sampled plant.
#pragma once

#include <Eigen/Core>

#include "quadtune/lti.hpp"

namespace quadtune {

/// How late each input acts and each output is seen. A delay within 1e-9 samples of a whole number
/// of samples is one.
struct ChannelDelays {
  Eigen::VectorXd input;   ///< nu delays [s], each finite and ≥ 0; empty means none
  Eigen::VectorXd output;  ///< ny delays [s], likewise

  /// True when there are entries, zeros included.
  [[nodiscard]] bool any() const { return input.size() > 0 || output.size() > 0; }
};

/// The zero-order hold of a plant with delays, exact for whole samples and for fractions.
///
/// A delay of an input by l dt + φ, 0 ≤ φ < dt, makes u[k-l-1] act for the first φ of a sample and
/// u[k-l] for the rest. With Γ(h) = ∫₀^h e^(Aτ) dτ B of that input:
///   x[k+1] = e^(A dt) x[k] + e^(A(dt-φ)) Γ(φ) u[k-l-1] + Γ(dt-φ) u[k-l].
/// A delay of an output by l dt + φ, φ > 0, shows it between the instants, dt - φ after sample
/// k-l-1, where the same equations hold with dt - φ for dt. Where an input steps at the very moment
/// that D is looked at, D sees it after the step.
///
/// The states are those of the plant, then for each delayed channel its own: of an input w1 with
/// φ > 0 its "w1[k-l-1]", of an output z with φ = 0.3 dt its value "z[k-0.3]"; last the whole
/// samples "w1[k-1]" … "w1[k-l]", "z[k-1.3]" …. Channels without names are u1, …, y1, …; states
/// without names become x1, ….
///
/// @param plant   A (nx × nx), B (nx × nu); time in seconds.
/// @param dt      Sample period [s], 0 < dt < ∞.
/// @param delays  at most 2000 samples altogether
/// @return        The sampled plant; C and D are written out.
/// @throws InvalidInput  as discretize_zoh(), and for delays of another number than channels, that
///                       are negative or not finite, or that make too many states.
/// Source: Åström and Wittenmark 1997, chapter 2 (inputs).
[[nodiscard]] DiscreteLti discretize_zoh(const ContinuousLti& plant, double dt,
                                         const ChannelDelays& delays);

/// A sampled plant with delays of whole samples: exact whatever it was sampled by. States as above.
///
/// @throws InvalidInput  likewise, and for a delay that is no whole number of samples.
[[nodiscard]] DiscreteLti with_delays(const DiscreteLti& plant, const ChannelDelays& delays);

}  // namespace quadtune
