// SPDX-License-Identifier: Apache-2.0
/// The frequency grid of a loop, and the refinement of peaks and crossings between its points.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

namespace quadtune::internal {

/// The features that the frequency grid must resolve.
struct Landmarks {
  std::vector<Eigen::VectorXcd> roots = {};  ///< poles and zeros, in s if dt is 0, otherwise in z
  std::vector<double> corners = {};          ///< further frequencies, > 0 [rad/s]
  double dt = 0;                             ///< [s]; 0: continuous time
  double delay = 0;                          ///< additional delay of a continuous loop [s]
  double delay_phase = 1000;                 ///< maximum phase of the delay to resolve [rad]
};

/// Computes increasing frequencies from 0 to a thousand times the fastest landmark, or to the
/// Nyquist frequency: sixty per decade from a thousandth of the slowest landmark, more around
/// lightly damped roots, and with a delay enough that its phase changes by at most 0.2 rad per
/// step.
[[nodiscard]] std::vector<double> loop_grid(const Landmarks& landmarks);

/// The same from `low` > 0, or slightly below, to `high`, without 0.
[[nodiscard]] std::vector<double> loop_grid(const Landmarks& landmarks, double low, double high);

using FrequencyFunction = std::function<double(double w)>;

struct Peak {
  double value = 0;
  double w = 0;  ///< [rad/s]
};

/// Computes the maximum of f ≥ 0, given its values on the grid `w`.
///
/// Local maxima on the grid are refined by Brent's method. Around the peak of a resonance, 1/f² is
/// a parabola in w, since f = |N/D| with D linear there: three values predict the peak, even from
/// its flank. A local maximum is refined if its prediction, plus a reserve, exceeds the largest
/// value found so far. Of equal peaks, the one with the lowest frequency is returned.
[[nodiscard]] Peak highest_peak(const FrequencyFunction& f, const std::vector<double>& w,
                                const std::vector<double>& values);

/// Computes the minimum of a unimodal f between two frequencies by Brent's method.
/// @param bits  accuracy of its position relative to the interval; the value of a smooth f is
///              accurate to twice as many
[[nodiscard]] Peak lowest_between(const FrequencyFunction& f, double low, double high,
                                  int bits = 26);

/// Computes the root of f between two arguments at which it has opposite signs; one of them may be
/// the root.
[[nodiscard]] double crossing(const FrequencyFunction& f, double low, double high, double at_low,
                              double at_high);

/// Computes the points at which f changes sign between neighbours of the grid.
/// @param certain  whether the sign of a grid value is unaffected by rounding. Values with an
///                 uncertain sign are ignored: a crossing lies between two certain ones.
[[nodiscard]] std::vector<double> crossings(
    const FrequencyFunction& f, const std::vector<double>& w, const std::vector<double>& values,
    const std::function<bool(std::size_t)>& certain = [](std::size_t) { return true; });

}  // namespace quadtune::internal
