// SPDX-License-Identifier: Apache-2.0
/// The standard plots of a loop, one panel each.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "quadtune/synthesis/margins.hpp"
#include "quadtune/synthesis/pid/step_response.hpp"
#include "report/plots/figure.hpp"

namespace quadtune::report {

/// A loop of one channel, its margins, and its response at the frequencies of the plots.
struct LoopCurves {
  std::string name;
  LoopMargins margins;
  std::vector<double> w;                ///< [rad/s], increasing, > 0
  std::vector<std::complex<double>> L;  ///< finite
  std::vector<std::complex<double>> S;
  std::complex<double> at_rest = 0;  ///< L(0) if it is finite, otherwise the first element of L
  std::vector<double> phase;  ///< phase of L [deg], unwrapped, -90 for each integrator at the
                              ///< lowest frequency
};

/// @param loop  of one channel
[[nodiscard]] LoopCurves loop_curves(const OpenLoop& loop, const LoopMargins& margins,
                                     const std::string& name);

/// A response with its name.
struct NamedResponse {
  std::string name;
  StepResponse response;
  double dt = 0;  ///< sample period [s] of a response that is held between samples; 0 if continuous
};

/// Outputs over time; the unit of time is chosen by the duration.
[[nodiscard]] Panel step_panel(const std::string& title, const std::string& output,
                               const std::vector<NamedResponse>& responses);

/// Adds a faint line from the first to the last x. gnuplot rejects a plot without a point within
/// the ranges; if the ranges contain the level, this line provides one.
void add_level(Panel& panel, const std::vector<double>& x, double value);

/// |L| [dB] with the gain margins marked, and the phase of L [deg] with the phase margin marked.
/// With several loops, the marks are those of the loop with the smallest disk margin.
[[nodiscard]] Panel magnitude_panel(const std::vector<LoopCurves>& loops);
[[nodiscard]] Panel phase_panel(const std::vector<LoopCurves>& loops);

/// |S| with its maximum; for a single loop |T| as well.
[[nodiscard]] Panel sensitivity_panel(const std::vector<LoopCurves>& loops);

/// The region that L must not enter: -1/f for the factors f of a disk margin.
struct ForbiddenDisk {
  enum class Kind { none, inside, half_plane, outside };
  Kind kind = Kind::none;  ///< which side of the circle through both ends is forbidden; left of
                           ///< `right`
  double left = 0;         ///< ends on the real axis
  double right = 0;
};

/// @param disk  symmetric (skew 0)
[[nodiscard]] ForbiddenDisk forbidden_disk(const DiskMargin& disk);

/// L(jω) with -1, the unit circle, and the disk of the loop with the smallest disk margin.
[[nodiscard]] Panel nyquist_panel(const std::vector<LoopCurves>& loops);

/// Points of the s-plane (dt = 0) or the z-plane.
struct PointSet {
  std::string name;   ///< in the legend
  std::string style;  ///< cross_style() or circle_style()
  Eigen::VectorXcd points;
};

/// A pole map. In the z-plane it shows the unit circle, or the part of it around z = 1 if all
/// points are near it.
[[nodiscard]] Panel pole_panel(const std::string& title, const std::vector<PointSet>& sets,
                               double dt);

}  // namespace quadtune::report
