// SPDX-License-Identifier: Apache-2.0
/// The wind in a simulated flight: mean wind, gust and Dryden turbulence.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "quadtune/model/environment.hpp"
#include "quadtune/model/rotation.hpp"
#include "quadtune/simulation/random.hpp"

namespace quadtune {

/// Low-altitude turbulence of [MIL-F-8785C], along and across the mean wind, sampled exactly.
///
/// Along the wind, white noise is filtered by σ √(2τ) / (1 + τ s); across and vertically, by σ √τ
/// (1 + √3 τ s) / (1 + τ s)². τ = L / V, where V is the horizontal airspeed of the vehicle in the
/// mean wind, at least 1 m/s.
struct DrydenNumbers {
  /// Standard deviations along, across, vertical [m/s]
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();
  Eigen::Vector3d length = Eigen::Vector3d::Ones();  ///< L [m]
  Eigen::Vector3d tau = Eigen::Vector3d::Ones();     ///< L / V of a hovering vehicle [s]
};
/// @throws InvalidInput  if the height is outside 3 … 300 m, the turbulence is negative, a gust has
///                       no length, or a number is not finite
[[nodiscard]] DrydenNumbers dryden_numbers(const Wind& wind);

/// Filter for one axis across the wind: two first-order stages in series with correlated noise. T
/// is double or a Pack. The stationary covariance of the states is [1 ½; ½ ½] for every τ, so τ may
/// change between samples.
template <class T>
struct DrydenStage {
  T decay;                         ///< e^(-dt/τ)
  T coupling;                      ///< from the first stage to the second
  T noise_11, noise_21, noise_22;  ///< lower Cholesky factor of the noise covariance of a sample
};
/// @param samples  dt / τ, > 0
template <class T>
[[nodiscard]] DrydenStage<T> dryden_stage(const T& samples) {
  using std::exp, std::sqrt;
  DrydenStage<T> stage;
  stage.decay = exp(T(-samples));
  stage.coupling = samples * stage.decay;
  // a' = (n - a) / τ, b' = (a - b) / τ with var a = 1. The noise of a sample replaces the variance
  // that decays, Q = P - A P Aᵀ with A = [decay 0; coupling decay], P = [1 ½; ½ ½].
  const T &d = stage.decay, &c = stage.coupling;
  const T half = T(0.5) * d * d;
  stage.noise_11 = sqrt(max_of(T(1) - d * d, T(0)));
  stage.noise_21 = (T(0.5) - d * c - half) / stage.noise_11;
  stage.noise_22 =
      sqrt(max_of(T(0.5) - c * c - c * d - half - stage.noise_21 * stage.noise_21, T(0)));
  return stage;
}

template <int N>
class WindModel {
 public:
  using P = Pack<N>;

  WindModel() = default;
  /// @param winds   one per lane
  /// @param stream  first of three random streams reserved for the wind
  WindModel(const std::array<Wind, N>& winds, double dt, std::uint32_t stream);

  /// Whether any flight has wind.
  [[nodiscard]] bool windy() const { return windy_; }

  /// Whether any flight has turbulence.
  [[nodiscard]] bool turbulent() const { return turbulent_; }

  /// Velocity of the air in sample `index`, at t = index · dt; world axes [m/s]. Call it for
  /// consecutive indices.
  /// @param velocity  of the vehicle, world axes [m/s]; affects the turbulence only
  [[nodiscard]] Vector3<P> at(std::uint64_t index, double t, const RandomSource<N>& source,
                              const Vector3<P>& velocity = Vector3<P>::Zero());

 private:
  void set_pace(const Vector3<P>& velocity);

  std::array<Wind, N> winds_{};
  double dt_ = 0;
  std::uint32_t stream_ = 0;
  bool windy_ = false, gusty_ = false, turbulent_ = false;
  Vector3<P> mean_ = Vector3<P>::Zero();
  Vector3<P> along_ = Vector3<P>::Zero(), across_ = Vector3<P>::Zero();  ///< unit vectors
  Vector3<P> sigma_;
  P level_rate_, up_rate_;  ///< dt/L of the horizontal axes and of the vertical axis [s/m]
  P pace_ = 0;              ///< V with which the stages were computed [m/s]
  DrydenStage<P> level_, up_;
  std::array<P, 3> first_, second_;
};

template <int N>
WindModel<N>::WindModel(const std::array<Wind, N>& winds, double dt, std::uint32_t stream)
    : winds_(winds), dt_(dt), stream_(stream) {
  for (int l = 0; l < N; ++l) {
    const Wind& wind = winds[static_cast<std::size_t>(l)];
    for (int i = 0; i < 3; ++i) set_lane(mean_(i), l, wind.mean(i));
    gusty_ = gusty_ || !wind.gust.velocity.isZero(0);
    turbulent_ = turbulent_ || wind.turbulence > 0;
    windy_ = windy_ || !wind.mean.isZero(0) || gusty_ || turbulent_;
    const DrydenNumbers dryden = dryden_numbers(wind);
    Eigen::Vector3d along(wind.mean.x(), wind.mean.y(), 0);
    along = along.norm() > 0 ? Eigen::Vector3d(along.normalized()) : Eigen::Vector3d::UnitX();
    for (int i = 0; i < 3; ++i) {
      set_lane(along_(i), l, along(i));
      set_lane(across_(i), l, i == 0 ? -along.y() : i == 1 ? along.x() : 0);
      set_lane(sigma_(i), l, dryden.sigma(i));
    }
    set_lane(level_rate_, l, dt / dryden.length(0));
    set_lane(up_rate_, l, dt / dryden.length(2));
  }
}

/// Updates V and the filter stages that depend on it.
template <int N>
void WindModel<N>::set_pace(const Vector3<P>& velocity) {
  using std::sqrt;
  const P x = mean_(0) - velocity(0), y = mean_(1) - velocity(1);
  const P pace = max_of(P(sqrt(x * x + y * y)), P(1));
  if (all(pace == pace_)) return;
  pace_ = pace;
  level_ = dryden_stage(P(level_rate_ * pace));
  up_ = dryden_stage(P(up_rate_ * pace));
}

template <int N>
Vector3<Pack<N>> WindModel<N>::at(std::uint64_t index, double t, const RandomSource<N>& source,
                                  const Vector3<P>& velocity) {
  Vector3<P> wind = mean_;
  if (gusty_)
    for (int l = 0; l < N; ++l) {
      const Gust& gust = winds_[static_cast<std::size_t>(l)].gust;
      const double phase = (t - gust.start) / gust.length;
      if (!(phase > 0 && phase < 1)) continue;
      const double share = 0.5 * (1 - lane(cos(Pack<1>(2 * std::numbers::pi * phase)), 0));
      for (int i = 0; i < 3; ++i) set_lane(wind(i), l, lane(wind(i), l) + gust.velocity(i) * share);
    }
  if (turbulent_) {
    set_pace(velocity);
    std::array<P, 3> gusts;
    for (std::size_t i = 0; i < 3; ++i) {
      const RandomPair<N> n = random_normal(source, stream_ + static_cast<std::uint32_t>(i), index);
      const DrydenStage<P>& c = i < 2 ? level_ : up_;
      if (index == 0) {  // start in the stationary state
        first_[i] = n.first;
        second_[i] = P(0.5) * (n.first + n.second);
      } else {
        second_[i] = c.decay * second_[i] + c.coupling * first_[i] +
                     (c.noise_21 * n.first + c.noise_22 * n.second);
        first_[i] = c.decay * first_[i] + c.noise_11 * n.first;
      }
      // Along the wind: one stage. Across: √3 times the first stage plus 1 - √3 times the second,
      // whose variance is 2 if that of the first stage is 1.
      if (i > 0)
        gusts[i] = P(std::numbers::sqrt2 / 2) *
                   (P(std::numbers::sqrt3) * first_[i] + P(1 - std::numbers::sqrt3) * second_[i]);
      else
        gusts[i] = first_[i];
      gusts[i] = gusts[i] * sigma_(static_cast<Eigen::Index>(i));
    }
    for (int i = 0; i < 2; ++i) wind(i) += along_(i) * gusts[0] + across_(i) * gusts[1];
    wind(2) -= gusts[2];
  }
  return wind;
}

}  // namespace quadtune
