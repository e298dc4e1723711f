// SPDX-License-Identifier: Apache-2.0
/// One plant under many PID controllers: what a search asks of each of them.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "quadtune/synthesis/pid_gains.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune::internal {

struct SensitivityPeaks {
  double Ms = 0;    ///< max |1/(1 + L)|
  double w_Ms = 0;  ///< [rad/s]
  double Mt = 0;    ///< max |L/(1 + L)|
  double w_Mt = 0;  ///< [rad/s]
};

struct LeastPhaseMargin {
  double w = 0;       ///< [rad/s]; 0 when |L| is nowhere 1
  double margin = 0;  ///< [rad], least in size
  double last_w = 0;  ///< the highest frequency at which |L| = 1 [rad/s]
  double last_margin = 0;
};

/// L = C P under negative feedback. The plant's response is computed once, on the loop_grid() of
/// its poles, zeros and delay.
class LoopShape {
 public:
  /// @param corners  further frequencies that the grid must contain with its decades [rad/s]
  LoopShape(const ContinuousTransferFunction& plant, const std::vector<double>& corners);

  /// Whether the closed loop has all its poles left: by their polynomial, or with a delay by
  /// Mikhailov's criterion, which follows the argument of den(jω) + num(jω) e^(-jω delay). False as
  /// well for loops that differentiate, and for those that hide a pole at 0.
  [[nodiscard]] bool stable(const PidGains& gains) const;
  [[nodiscard]] SensitivityPeaks peaks(const PidGains& gains) const;
  /// max |C/(1 + L)|, as far as the grid goes.
  [[nodiscard]] double noise_gain(const PidGains& gains) const;
  [[nodiscard]] LeastPhaseMargin least_phase_margin(const PidGains& gains) const;

  [[nodiscard]] std::complex<double> at(const PidGains& gains, double w) const;
  /// Of the plant's response to what is slow: 1 or -1.
  [[nodiscard]] double low_frequency_sign() const;
  [[nodiscard]] const std::vector<double>& grid() const { return grid_; }
  [[nodiscard]] const std::vector<std::complex<double>>& plant_responses() const {
    return responses_;
  }

 private:
  ContinuousTransferFunction plant_;
  std::vector<double> grid_;                     ///< [rad/s]
  std::vector<std::complex<double>> responses_;  ///< of the plant
};

}  // namespace quadtune::internal
