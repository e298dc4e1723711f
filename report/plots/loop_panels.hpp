// SPDX-License-Identifier: Apache-2.0
/// The usual pictures of a loop, one panel each.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "quadtune/synthesis/margins.hpp"
#include "quadtune/synthesis/step_response.hpp"
#include "report/plots/figure.hpp"

namespace quadtune::report {

/// A loop of one channel, its margins, and its response at the frequencies that are shown.
struct LoopCurves {
  std::string name;
  LoopMargins margins;
  std::vector<double> w;                ///< [rad/s], increasing, > 0
  std::vector<std::complex<double>> L;  ///< finite
  std::vector<std::complex<double>> S;
  std::complex<double> at_rest = 0;  ///< L(0) where it is finite, otherwise the first of L
  std::vector<double> phase;  ///< [deg] of L, unwrapped, -90 for each integrator at the slow end
};

/// @param loop  of one channel
[[nodiscard]] LoopCurves loop_curves(const OpenLoop& loop, const LoopMargins& margins,
                                     const std::string& name);

/// A response with its name.
struct NamedResponse {
  std::string name;
  StepResponse response;
  double dt = 0;  ///< sample period [s] of what is held between samples; 0 of what is continuous
};

/// Outputs over time; the unit of time follows from the duration.
[[nodiscard]] Panel step_panel(const std::string& title, const std::string& output,
                               const std::vector<NamedResponse>& responses);

/// A faint line from the first to the last x. gnuplot refuses a plot of which no point lies within
/// the ranges; where they contain the level, one does.
void add_level(Panel& panel, const std::vector<double>& x, double value);

/// |L| [dB] with the gain margins marked, and the phase of L [deg] with the phase margin marked.
/// Of several loops the marks are those of the one with the smallest disk margin.
[[nodiscard]] Panel magnitude_panel(const std::vector<LoopCurves>& loops);
[[nodiscard]] Panel phase_panel(const std::vector<LoopCurves>& loops);

/// |S| with its largest value; of one loop |T| as well.
[[nodiscard]] Panel sensitivity_panel(const std::vector<LoopCurves>& loops);

/// Where L must not come: -1/f of the factors f of a disk margin.
struct ForbiddenDisk {
  enum class Kind { none, inside, half_plane, outside };
  Kind kind = Kind::none;  ///< of the circle through the ends that is forbidden; left of `right`
  double left = 0;         ///< ends on the real axis
  double right = 0;
};

/// @param disk  symmetric (skew 0)
[[nodiscard]] ForbiddenDisk forbidden_disk(const DiskMargin& disk);

/// L(jω) with -1, the unit circle, and the disk of the worst loop.
[[nodiscard]] Panel nyquist_panel(const std::vector<LoopCurves>& loops);

/// Points of the s-plane (dt = 0) or the z-plane.
struct PointSet {
  std::string name;   ///< in the legend
  std::string style;  ///< cross_style() or circle_style()
  Eigen::VectorXcd points;
};

/// A pole map; in the z-plane with the unit circle, or the part of it that all points are near.
[[nodiscard]] Panel pole_panel(const std::string& title, const std::vector<PointSet>& sets,
                               double dt);

}  // namespace quadtune::report
