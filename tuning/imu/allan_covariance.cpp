// SPDX-License-Identifier: Apache-2.0
#include "imu/allan_covariance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace quadtune {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::array<double, 3> kSecondDifference = {1, -2, 1};

/// Generalized autocovariances of the phase at a lag t, each up to polynomials that second
/// differences remove [Greenhall and Riley 2003]; that of quantization is a pulse at t = 0.
NoiseVariances phase_autocovariance(double t, double dt) {
  const double a = std::abs(t) * dt;
  return {0, -a / 2, t == 0 ? 0 : a * a * std::log(std::abs(t)) / (2 * kPi), a * a * a / 12};
}

/// Covariance of the second difference over m1 at one sample with that over m2, `lag` samples
/// later.
NoiseVariances difference_covariance(double m1, double m2, double lag, double dt) {
  NoiseVariances r{};
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      const double t = a * m1 - b * m2 - lag;
      const double c = kSecondDifference[static_cast<std::size_t>(a)] *
                       kSecondDifference[static_cast<std::size_t>(b)];
      const NoiseVariances s = phase_autocovariance(t, dt);
      for (std::size_t k = 0; k < kAllanNoises; ++k) r[k] += c * s[k];
      if (t == 0) r[0] += c;
    }
  return r;
}

}  // namespace

NoiseVariances allan_variance_of_noises(double tau) {
  return {3 / (tau * tau), 1 / tau, 2 * std::numbers::ln2 / kPi, tau / 3};
}

AllanCovariance::AllanCovariance(std::size_t samples, std::size_t m1, std::size_t m2, double dt) {
  const auto n = static_cast<double>(samples) + 1;
  const auto f1 = static_cast<double>(m1), f2 = static_cast<double>(m2);
  const double terms1 = n - 2 * f1, terms2 = n - 2 * f2;
  // Number of pairs of terms that are `lag` apart.
  const auto pairs = [&](double lag) {
    return std::max(0.0, std::min(terms1, terms2 - lag) - std::max(0.0, -lag));
  };
  const auto add = [&](double lag, double weight, bool pulses_alone) {
    const NoiseVariances r = difference_covariance(f1, f2, lag, dt);
    for (std::size_t p = 0; p < kAllanNoises; ++p)
      for (std::size_t q = 0; q < kAllanNoises; ++q)
        if ((p == 0 || q == 0) == pulses_alone)
          products_[p][q] += weight * pairs(lag) * r[p] * r[q];
  };
  // All terms except the pulses are smooth between these lags, and decay fast away from them.
  std::vector<double> corners;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) corners.push_back(a * f1 - b * f2);
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  for (const double lag : corners) add(lag, 1, true);
  const double tail = 6 * std::max(f1, f2);
  const double first = std::max(corners.front() - tail, -terms1);
  const double last = std::min(corners.back() + tail, terms2);
  std::erase_if(corners, [&](double lag) { return lag <= first || lag >= last; });
  corners.insert(corners.begin(), first);
  corners.push_back(last);
  constexpr int kSteps = 32;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const double length = corners[i + 1] - corners[i];
    if (length <= kSteps) {
      const auto count = static_cast<int>(std::ceil(length));
      for (int k = 0; k < count; ++k) add(corners[i] + k, 1, false);
    } else {  // the midpoint rule
      for (int k = 0; k < kSteps; ++k)
        add(corners[i] + (k + 0.5) * length / kSteps, length / kSteps, false);
    }
  }
  // cov = 2 Σ pairs(lag) r(lag)² / (terms · 2τ²)(terms · 2τ²)
  const double tau_squares = f1 * f1 * f2 * f2 * dt * dt * dt * dt;
  for (NoiseVariances& row : products_)
    for (double& entry : row) entry *= 2 / (terms1 * terms2 * 4 * tau_squares);
}

double AllanCovariance::at(const NoiseVariances& noises) const {
  double sum = 0;
  for (std::size_t p = 0; p < kAllanNoises; ++p)
    for (std::size_t q = 0; q < kAllanNoises; ++q) sum += noises[p] * noises[q] * products_[p][q];
  return sum;
}

}  // namespace quadtune
