// SPDX-License-Identifier: Apache-2.0
/// Slowly varying errors of a sensor: a turn-on bias, a random walk, and an exponentially
/// correlated error. Equations: docs/theory.md, "Simulated flight".
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>

#include "quadtune/model/sensors.hpp"
#include "quadtune/simulation/random.hpp"

namespace quadtune {

/// Drift of one sensor, one flight per lane.
template <int N, int Axes>
class SensorDrift {
 public:
  using P = Pack<N>;
  using Values = Eigen::Matrix<P, Axes, 1>;

  SensorDrift() = default;
  /// @param faults  one per lane; all with the same rate
  /// @param stream  of the sensor; the drift uses the streams that are 256, 512 and 768 above it,
  ///                and the one after each
  SensorDrift(const std::array<SensorFaults, N>& faults, std::uint32_t stream) : stream_(stream) {
    const double dt = 1 / faults[0].rate;
    for (int l = 0; l < N; ++l) {
      const SensorFaults& f = faults[static_cast<std::size_t>(l)];
      const double decay = f.correlation > 0 ? std::exp(-dt / f.correlation) : 0;
      set_lane(decay_, l, decay);
      for (int i = 0; i < Axes; ++i) {
        set_lane(turn_on_(i), l, f.turn_on_bias(i));
        set_lane(walk_(i), l, f.bias_walk(i) * std::sqrt(dt));
        set_lane(correlated_(i), l, f.correlated_noise(i));
        set_lane(innovation_(i), l, f.correlated_noise(i) * std::sqrt(1 - decay * decay));
        turns_on_ = turns_on_ || f.turn_on_bias(i) != 0;
        walks_ = walks_ || f.bias_walk(i) != 0;
        correlates_ = correlates_ || f.correlated_noise(i) != 0;
      }
    }
    bias_.setConstant(P(0));
    error_.setConstant(P(0));
  }

  /// Whether any of these errors is present.
  [[nodiscard]] bool present() const { return turns_on_ || walks_ || correlates_; }

  /// Adds the errors of sample `index`; call it for consecutive indices.
  void add_to(Values& y, std::uint64_t index, const RandomSource<N>& source) {
    if (turns_on_ && index == 0) bias_ += turn_on_.cwiseProduct(normal(256, index, source));
    if (walks_ && index > 0) bias_ += walk_.cwiseProduct(normal(512, index, source));
    if (correlates_) {
      // g[k] = φ g[k-1] + σ √(1 - φ²) n is stationary because it starts with g[0] = σ n.
      const Values n = normal(768, index, source);
      if (index == 0)
        error_ = correlated_.cwiseProduct(n);
      else
        for (int i = 0; i < Axes; ++i) error_(i) = decay_ * error_(i) + innovation_(i) * n(i);
    }
    for (int i = 0; i < Axes; ++i) y(i) += bias_(i) + error_(i);
  }

 private:
  [[nodiscard]] Values normal(std::uint32_t offset, std::uint64_t index,
                              const RandomSource<N>& source) const {
    Values values;
    for (int i = 0; i < Axes; i += 2) {
      const RandomPair<N> n =
          random_normal(source, stream_ + offset + static_cast<std::uint32_t>(i / 2), index);
      values(i) = n.first;
      if (i + 1 < Axes) values(i + 1) = n.second;
    }
    return values;
  }

  std::uint32_t stream_ = 0;
  bool turns_on_ = false, walks_ = false, correlates_ = false;
  P decay_ = 0;
  Values turn_on_, walk_, correlated_, innovation_;
  Values bias_, error_;
};

}  // namespace quadtune
