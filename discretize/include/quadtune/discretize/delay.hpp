// SPDX-License-Identifier: Apache-2.0
/// Delays of inputs and outputs as additional states of the sampled plant.
#pragma once

#include <Eigen/Core>

#include "quadtune/lti.hpp"

namespace quadtune {

/// Delays of the inputs and outputs. A delay within 1e-9 samples of a whole number of samples
/// counts as that number.
struct ChannelDelays {
  Eigen::VectorXd input;   ///< nu delays [s], each finite and ≥ 0; empty means none
  Eigen::VectorXd output;  ///< ny delays [s], likewise

  /// Whether there are entries, zeros included.
  [[nodiscard]] bool any() const { return input.size() > 0 || output.size() > 0; }
};

/// The zero-order hold of a plant with delays, exact for whole samples and for fractions of a
/// sample.
///
/// If an input is delayed by l dt + φ, 0 ≤ φ < dt, u[k-l-1] acts during the first φ of a sample and
/// u[k-l] during the rest. With Γ(h) = ∫₀^h e^(Aτ) dτ B of that input:
///   x[k+1] = e^(A dt) x[k] + e^(A(dt-φ)) Γ(φ) u[k-l-1] + Γ(dt-φ) u[k-l].
/// An output that is delayed by l dt + φ, φ > 0, is the output dt - φ after sample k-l-1, to which
/// the same equations apply with dt - φ for dt. If an input steps at the instant at which D is
/// evaluated, D uses the value after the step.
///
/// The states are those of the plant, followed by the states of each delayed channel: for an input
/// w1 with φ > 0 "w1[k-l-1]", for an output z with φ = 0.3 dt "z[k-0.3]"; then the whole samples
/// "w1[k-1]" … "w1[k-l]", "z[k-1.3]" …. Unnamed channels are called u1, …, y1, …; unnamed states
/// x1, ….
///
/// @param plant   A (nx × nx), B (nx × nu); time in seconds.
/// @param dt      Sample period [s], 0 < dt < ∞.
/// @param delays  at most 2000 samples in total
/// @return        The sampled plant with explicit C and D.
/// @throws InvalidInput  as discretize_zoh(); if the number of delays is not that of the channels,
///                       a delay is negative or not finite, or the delays add too many states.
/// Source: Åström and Wittenmark 1997, chapter 2 (inputs).
[[nodiscard]] DiscreteLti discretize_zoh(const ContinuousLti& plant, double dt,
                                         const ChannelDelays& delays);

/// A sampled plant with delays of whole samples, exact for any discretization method. States as
/// above.
///
/// @throws InvalidInput  likewise, or if a delay is not a whole number of samples.
[[nodiscard]] DiscreteLti with_delays(const DiscreteLti& plant, const ChannelDelays& delays);

}  // namespace quadtune
