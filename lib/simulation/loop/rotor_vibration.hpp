// SPDX-License-Identifier: Apache-2.0
/// Vibration of the rotors in an inertial sensor. Equations: docs/theory.md, "Simulated flight".
#pragma once

#include <array>
#include <cstddef>
#include <numbers>

#include "quadtune/model/rigid_body.hpp"
#include "quadtune/model/sensors.hpp"
#include "quadtune/simulation/random.hpp"

namespace quadtune::internal {

/// Angles of the rotors, integrated from their speeds over the last control period.
template <int N>
class RotorPhases {
 public:
  using P = Pack<N>;
  using Angles = std::array<P, kMaxRotors>;

  /// The initial angles are uniformly distributed.
  /// @param stream  first of as many random streams as there are rotors
  void start(int rotors, const RandomSource<N>& source, std::uint32_t stream) {
    rotors_ = rotors;
    for (int i = 0; i < rotors; ++i)
      begin_[static_cast<std::size_t>(i)] =
          P(2 * std::numbers::pi) *
          random_uniform(source, stream + static_cast<std::uint32_t>(i), 0).first;
  }
  [[nodiscard]] bool present() const { return rotors_ > 0; }

  /// Stores the speeds at the beginning of a control period [rad/s], dt [s] after the previous
  /// ones.
  void keep(const RotorSpeeds<P>& speeds) { before_ = speeds; }
  /// Ends the period with these speeds.
  void advance(const RotorSpeeds<P>& speeds, double dt) { begin_ = at(speeds, dt); }

  /// Angles [rad] `since` seconds after the beginning of the period, at which time the speeds are
  /// these; the speed is assumed to change linearly.
  [[nodiscard]] Angles at(const RotorSpeeds<P>& speeds, double since) const {
    Angles angles = begin_;
    for (int i = 0; i < rotors_ && before_.size() > 0; ++i) {
      P& angle = angles[static_cast<std::size_t>(i)];
      angle += P(0.5 * since) * (before_(i) + speeds(i));
      angle = angle - nearest(angle * P(0.5 * std::numbers::inv_pi)) * P(2 * std::numbers::pi);
    }
    return angles;
  }

 private:
  int rotors_ = 0;
  Angles begin_{};
  RotorSpeeds<P> before_;
};

/// Vibration in one sensor. Rotor i at the angle φ_i adds a |H(w_i)| w_i² (cos φ_i, sin φ_i, sin
/// φ_i), with the amplitudes a of each axis and the gain |H| of the sensor's response at that
/// frequency. Sampling aliases it to its apparent frequency.
template <int N>
class RotorVibration {
 public:
  using P = Pack<N>;

  RotorVibration() = default;
  /// @param faults  one per lane
  explicit RotorVibration(const std::array<SensorFaults, N>& faults) {
    for (int l = 0; l < N; ++l) {
      const SensorFaults& f = faults[static_cast<std::size_t>(l)];
      const double period = f.natural_frequency > 0 ? 1 / f.natural_frequency : 0;
      set_lane(period2_, l, period * period);
      set_lane(damping_, l, 4 * f.damping * f.damping * period * period);
      for (int i = 0; i < 3; ++i) set_lane(amplitude_(i), l, f.vibration(i));
      present_ = present_ || !f.vibration.isZero(0);
    }
  }

  [[nodiscard]] bool present() const { return present_; }

  /// @param angles  of the rotors [rad];  @param speeds  [rad/s]
  [[nodiscard]] Vector3<P> at(const typename RotorPhases<N>::Angles& angles,
                              const RotorSpeeds<P>& speeds) const {
    using std::cos, std::sin, std::sqrt;
    Vector3<P> sum = Vector3<P>::Zero();
    for (Eigen::Index i = 0; i < speeds.size(); ++i) {
      const P w2 = speeds(i) * speeds(i);
      // |H|⁻² = (1 - w²/ω²)² + 4 ζ² w²/ω²
      const P off = P(1) - w2 * period2_;
      const P size = w2 / sqrt(off * off + damping_ * w2);
      const P& angle = angles[static_cast<std::size_t>(i)];
      const P c = size * cos(angle), s = size * sin(angle);
      sum(0) += amplitude_(0) * c;
      sum(1) += amplitude_(1) * s;
      sum(2) += amplitude_(2) * s;
    }
    return sum;
  }

 private:
  bool present_ = false;
  P period2_ = 0, damping_ = 0;  ///< 1/ω² and 4 ζ²/ω² [s²]
  Vector3<P> amplitude_ = Vector3<P>::Zero();
};

}  // namespace quadtune::internal
