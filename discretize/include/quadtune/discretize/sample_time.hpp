// SPDX-License-Identifier: Apache-2.0
/// Warnings about a sample period that is long for a plant.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/lti.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// A sample period is long if |pole| dt exceeds this: fewer than 4π ≈ 13 samples per period of a
/// mode, or fewer than two per time constant.
inline constexpr double kLongPeriod = 0.5;

/// One line per pole, or per conjugate pair, whose |pole| dt exceeds kLongPeriod, the fastest
/// first; only the four fastest are listed, the others are counted. "the pole at -120 1/s is fast
/// for dt = 0.01 s: |pole| dt is 1.2, expected at most 0.5; use dt <= 0.00417 s". These are
/// warnings and not errors: the holds remain exact at the samples, but a sampled controller has
/// little authority over such a mode, and approximations of it are coarse.
///
/// @param poles  of a continuous plant [1/s]
/// @param dt     Sample period [s], 0 < dt < ∞.
/// @throws InvalidInput  if dt is out of range.
/// Source: Åström and Wittenmark 1997, chapter 2 (choice of the sampling rate).
[[nodiscard]] std::vector<std::string> sample_time_warnings(const Eigen::VectorXcd& poles,
                                                            double dt);

/// The same for the poles of a state-space model.
[[nodiscard]] std::vector<std::string> sample_time_warnings(const ContinuousLti& plant, double dt);

/// The same for the poles of a transfer function.
[[nodiscard]] std::vector<std::string> sample_time_warnings(const ContinuousTransferFunction& plant,
                                                            double dt);

}  // namespace quadtune
