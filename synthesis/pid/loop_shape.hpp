// SPDX-License-Identifier: Apache-2.0
/// Properties of the loops of one plant with many PID controllers, for searches over gains.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "quadtune/synthesis/pid/pid_gains.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune::internal {

struct SensitivityPeaks {
  double Ms = 0;    ///< max |1/(1 + L)|
  double w_Ms = 0;  ///< [rad/s]
  double Mt = 0;    ///< max |L/(1 + L)|
  double w_Mt = 0;  ///< [rad/s]
};

struct MinPhaseMargin {
  double w = 0;       ///< [rad/s]; 0 if |L| is nowhere 1
  double margin = 0;  ///< [rad], that of minimum magnitude
  double last_w = 0;  ///< the highest frequency at which |L| = 1 [rad/s]
  double last_margin = 0;
};

/// L = C P under negative feedback. The plant's response is computed once, on the loop_grid() of
/// its poles, zeros and delay.
class LoopShape {
 public:
  /// @param corners  further frequencies that the grid must contain with its decades [rad/s]
  LoopShape(const ContinuousTransferFunction& plant, const std::vector<double>& corners);

  /// Whether all poles of the closed loop are in the open left half-plane. Computed from the
  /// characteristic polynomial or, with a delay, by stable_with_delay(). Also false for improper
  /// loops, and for those with a cancelled pole at 0.
  [[nodiscard]] bool stable(const PidGains& gains) const;
  [[nodiscard]] SensitivityPeaks peaks(const PidGains& gains) const;
  /// max |C/(1 + L)| over the frequencies of the grid.
  [[nodiscard]] double noise_gain(const PidGains& gains) const;
  [[nodiscard]] MinPhaseMargin min_phase_margin(const PidGains& gains) const;

  [[nodiscard]] std::complex<double> at(const PidGains& gains, double w) const;
  /// Sign of the plant's response at low frequencies: 1 or -1.
  [[nodiscard]] double low_frequency_sign() const;
  [[nodiscard]] const std::vector<double>& grid() const { return grid_; }
  [[nodiscard]] const std::vector<std::complex<double>>& plant_responses() const {
    return responses_;
  }

 private:
  ContinuousTransferFunction plant_;
  std::vector<double> grid_;                     ///< [rad/s]
  std::vector<std::complex<double>> responses_;  ///< plant responses on the grid
  std::vector<double> sizes_;                    ///< their absolute values
};

}  // namespace quadtune::internal
