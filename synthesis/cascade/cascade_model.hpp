// SPDX-License-Identifier: Apache-2.0
/// One loop of a cascade with given gains: its matrices and its responses on a grid.
#pragma once

#include <complex>
#include <vector>

#include "quadtune/frequency_response.hpp"
#include "quadtune/synthesis/pid/cascade_loop.hpp"

namespace quadtune::internal {

/// The discrete integral I[k] = s[k] + now e[k], s[k+1] = s[k] + dt e[k].
struct PidIntegral {
  double dt;
  double now;

  PidIntegral(PidMethod method, double period);
  /// Frequency response.
  /// @param w  [rad/s]
  [[nodiscard]] std::complex<double> at(double w) const;
};

/// The input of the closed loop.
enum class LoopInput { command, set_point };

/// Computes the closed loop. Its states are those of the plant and, if Ki is not 0, of the
/// integral; its outputs are those of the plant. Its input is the set point, or is added to the
/// command.
[[nodiscard]] CascadePlant closed_loop(const CascadePlant& plant, const PidGains& gains,
                                       PidMethod method, LoopInput input);

/// Responses of one plant on a grid, reused for all gains.
class CascadeResponses {
 public:
  /// @param slowest  lowest frequency of the grid [rad/s]
  CascadeResponses(const CascadePlant& plant, PidMethod method, double slowest);

  struct Point {
    std::complex<double> value;     ///< plant, command to value
    std::complex<double> rate;      ///< plant, command to rate
    std::complex<double> integral;  ///< integral of the controller, per Ki
  };

  [[nodiscard]] Point at(double w) const;
  [[nodiscard]] const std::vector<double>& grid() const { return grid_; }  ///< [rad/s]
  [[nodiscard]] const std::vector<Point>& points() const { return points_; }

  [[nodiscard]] CascadePlant closed(const PidGains& gains) const;
  [[nodiscard]] bool stable(const PidGains& gains) const;

  [[nodiscard]] double Ms(const PidGains& gains) const;             ///< max |S|
  [[nodiscard]] double value_noise(const PidGains& gains) const;    ///< max |(Kp + Ki I) S|
  [[nodiscard]] double tracking_peak(const PidGains& gains) const;  ///< max |(Kp + Ki I) P S|

 private:
  template <class F>
  [[nodiscard]] double peak(const PidGains& gains, const F& f) const;

  CascadePlant plant_;
  FrequencyResponse response_;
  PidIntegral integral_;
  PidMethod method_;
  std::vector<double> grid_;
  std::vector<Point> points_;
};

/// The maximum |value| after a unit step at the command of a closed loop, and the steady-state
/// value.
struct LoadStep {
  double peak = std::numeric_limits<double>::infinity();
  double left = std::numeric_limits<double>::infinity();
};
[[nodiscard]] LoadStep load_step(const CascadePlant& closed_loop);

/// @throws InvalidInput  unless the plant has one input, two outputs and no feed-through
void require_cascade_plant(const CascadePlant& plant);

}  // namespace quadtune::internal
