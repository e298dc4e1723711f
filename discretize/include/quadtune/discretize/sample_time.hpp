// SPDX-License-Identifier: Apache-2.0
/// Whether a sample period is short enough for a plant.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/lti.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// |pole| dt above which a sample period is long: fewer than 4π = 13 samples in the period of a
/// mode, or fewer than two in its time constant.
inline constexpr double kLongPeriod = 0.5;

/// One line for each pole, of a conjugate pair for both, whose |pole| dt exceeds kLongPeriod, the
/// fastest first; of all but the four fastest, their number. "the pole at -120 1/s is fast for
/// dt = 0.01 s: |pole| dt is 1.2, expected at most 0.5; take dt <= 0.00417 s". Warnings and no
/// refusals: the holds stay exact at the samples, but a computer that sees so few of them cannot do
/// much about such a mode, and the approximations of it are coarse.
///
/// @param poles  of a continuous plant [1/s]
/// @param dt     Sample period [s], 0 < dt < ∞.
/// @throws InvalidInput  if dt is out of range.
/// Source: Åström and Wittenmark 1997, chapter 2 (choice of the sampling rate).
[[nodiscard]] std::vector<std::string> sample_time_warnings(const Eigen::VectorXcd& poles,
                                                            double dt);
[[nodiscard]] std::vector<std::string> sample_time_warnings(const ContinuousLti& plant, double dt);
[[nodiscard]] std::vector<std::string> sample_time_warnings(const ContinuousTransferFunction& plant,
                                                            double dt);

}  // namespace quadtune
