// SPDX-License-Identifier: Apache-2.0
/// The wind that a simulated flight meets: mean, gust and Dryden's turbulence.
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

/// Turbulence of [MIL-F-8785C] at low altitude, along and across the mean wind, sampled exactly.
///
/// Along: white noise through σ √(2τ) / (1 + τ s); across and up: through
/// σ √τ (1 + √3 τ s) / (1 + τ s)². τ = L / V with V the mean wind, at least 1 m/s, past a vehicle
/// that hovers.
struct DrydenNumbers {
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();  ///< standard deviations along, across, up [m/s]
  Eigen::Vector3d tau = Eigen::Vector3d::Ones();    ///< L / V [s]
};
/// @throws InvalidInput  for a height out of 3 … 300 m, a turbulence below 0, a gust without
/// length,
///                       or numbers that are not finite
[[nodiscard]] DrydenNumbers dryden_numbers(const Wind& wind);

/// One axis across the wind: two first-order stages in a row, with their joint noise.
struct DrydenStage {
  double decay = 0;            ///< e^(-dt/τ)
  double coupling = 0;         ///< of the first stage into the second
  Eigen::Matrix2d noise;       ///< lower Cholesky factor of a sample's noise
  Eigen::Matrix2d stationary;  ///< and of the state's covariance, to start from
};
/// @param tau  [s];  @param dt  [s]
[[nodiscard]] DrydenStage dryden_stage(double tau, double dt);

template <int N>
class WindModel {
 public:
  using P = Pack<N>;

  WindModel() = default;
  /// @param winds   one a lane
  /// @param stream  first of three random streams that are the wind's own
  WindModel(const std::array<Wind, N>& winds, double dt, std::uint32_t stream);

  /// Whether there is any wind at all.
  [[nodiscard]] bool windy() const { return windy_; }

  /// Velocity of the air in sample `index`, at t = index · dt; world axes [m/s]. To be called for
  /// each index in turn.
  [[nodiscard]] Vector3<P> at(std::uint64_t index, double t, const RandomSource<N>& source);

 private:
  std::array<Wind, N> winds_{};
  double dt_ = 0;
  std::uint32_t stream_ = 0;
  bool windy_ = false, gusty_ = false, turbulent_ = false;
  Vector3<P> mean_ = Vector3<P>::Zero();
  Vector3<P> along_ = Vector3<P>::Zero(), across_ = Vector3<P>::Zero();  ///< unit vectors
  Vector3<P> sigma_;
  /// Per axis: decay, coupling, noise (3 entries), stationary (3 entries).
  std::array<std::array<P, 8>, 3> numbers_;
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
      const DrydenStage stage = dryden_stage(dryden.tau(i), dt);
      const std::array<double, 8> numbers = {stage.decay,
                                             stage.coupling,
                                             stage.noise(0, 0),
                                             stage.noise(1, 0),
                                             stage.noise(1, 1),
                                             stage.stationary(0, 0),
                                             stage.stationary(1, 0),
                                             stage.stationary(1, 1)};
      for (std::size_t k = 0; k < 8; ++k)
        set_lane(numbers_[static_cast<std::size_t>(i)][k], l, numbers[k]);
    }
  }
}

template <int N>
Vector3<Pack<N>> WindModel<N>::at(std::uint64_t index, double t, const RandomSource<N>& source) {
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
    std::array<P, 3> gusts;
    for (std::size_t i = 0; i < 3; ++i) {
      const RandomPair<N> n = random_normal(source, stream_ + static_cast<std::uint32_t>(i), index);
      const std::array<P, 8>& c = numbers_[i];
      if (index == 0) {
        first_[i] = c[5] * n.first;
        second_[i] = c[6] * n.first + c[7] * n.second;
      } else {
        second_[i] = c[0] * second_[i] + c[1] * first_[i] + (c[3] * n.first + c[4] * n.second);
        first_[i] = c[0] * first_[i] + c[2] * n.first;
      }
      // Along, one stage; across, √3 of the first and 1 - √3 of the second, whose variance is then
      // 2 where the first stage has 1.
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
