// SPDX-License-Identifier: Apache-2.0
/// The frequencies at which a loop is examined, and the peaks and crossings between them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

namespace quadtune::internal {

/// What the frequencies have to resolve.
struct Landmarks {
  std::vector<Eigen::VectorXcd> roots = {};  ///< poles and zeros, in s if dt is 0, otherwise in z
  std::vector<double> corners = {};          ///< further frequencies, > 0 [rad/s]
  double dt = 0;                             ///< [s]; 0: continuous time
  double delay = 0;                          ///< [s] in addition, of a continuous loop
  double delay_phase = 1000;                 ///< how far the delay's turning is followed [rad]
};

/// Increasing frequencies from 0 to a thousand times the fastest landmark, or to Nyquist: sixty a
/// decade from a thousandth of the slowest landmark, more around lightly damped roots, and with a
/// delay so many that its phase turns by at most 0.2 rad from one to the next.
[[nodiscard]] std::vector<double> loop_grid(const Landmarks& landmarks);

/// The same from `low` > 0, or a little below, to `high`, without 0.
[[nodiscard]] std::vector<double> loop_grid(const Landmarks& landmarks, double low, double high);

using FrequencyFunction = std::function<double(double w)>;

struct Peak {
  double value = 0;
  double w = 0;  ///< [rad/s]
};

/// The maximum of f ≥ 0, given its values on the grid `w`.
///
/// One rule decides which local maxima of the grid are refined, by Brent's method. Around the peak
/// of a resonance 1/f² is a parabola in w, since f = |N/D| with D linear there: three values
/// predict the peak, even from its flank. Every local maximum is refined whose prediction, with a
/// reserve, exceeds the largest value found so far. Of equal peaks the slowest is returned.
[[nodiscard]] Peak highest_peak(const FrequencyFunction& f, const std::vector<double>& w,
                                const std::vector<double>& values);

/// The minimum of f between two frequencies, where it falls, then rises, by Brent's method.
/// @param bits  to which its place is found, as a share of the interval; its value of a smooth f to
///              twice as many
[[nodiscard]] Peak lowest_between(const FrequencyFunction& f, double low, double high,
                                  int bits = 26);

/// The root of f between two arguments at which it has opposite signs, or one of which is a root.
[[nodiscard]] double crossing(const FrequencyFunction& f, double low, double high, double at_low,
                              double at_high);

/// Where f changes sign between neighbours of the grid.
/// @param certain  whether rounding cannot have decided the sign of a grid value. Values whose sign
///                 is uncertain are passed over: a crossing lies between two certain ones.
[[nodiscard]] std::vector<double> crossings(
    const FrequencyFunction& f, const std::vector<double>& w, const std::vector<double>& values,
    const std::function<bool(std::size_t)>& certain = [](std::size_t) { return true; });

}  // namespace quadtune::internal
