// SPDX-License-Identifier: Apache-2.0
/// Model of one sensor: converts true values to the samples that the flight program receives.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "quadtune/estimation/on_board.hpp"
#include "quadtune/model/sensors.hpp"
#include "quadtune/simulation/random.hpp"
#include "quadtune/simulation/sensor_drift.hpp"

namespace quadtune {

/// A second-order response, sampled exactly for inputs that are linear between samples: (y, y')[k]
/// = A (y, y')[k-1] + b0 u[k-1] + b1 u[k].
struct SampledResponse {
  Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
  Eigen::Vector2d b0 = Eigen::Vector2d::Zero();
  Eigen::Vector2d b1 = Eigen::Vector2d(1, 0);
};
/// @param natural_frequency  [rad/s], 0: no dynamics, y = u;  @param damping  > 0;  @param dt  [s]
[[nodiscard]] SampledResponse sampled_response(double natural_frequency, double damping, double dt);

/// Times of a periodic event with period 1/rate from time 0. Each is computed from its number, so
/// that rounding errors do not accumulate.
class SampleClock {
 public:
  SampleClock() = default;
  explicit SampleClock(double rate) : period_(1 / rate) {}

  [[nodiscard]] bool due(double now) const { return next() <= now + kSlack; }
  [[nodiscard]] double next() const { return static_cast<double>(index_) * period_; }
  [[nodiscard]] std::uint64_t index() const { return index_; }
  void advance() { ++index_; }

  /// Times whose difference is smaller count as equal [s].
  static constexpr double kSlack = 1e-9;

 private:
  double period_ = 1;
  std::uint64_t index_ = 0;
};

/// The SensorFaults of one sensor, one flight per lane, and its samples that have not arrived yet.
template <int N, int Axes>
class SensorChannel {
 public:
  using P = Pack<N>;
  using Values = Eigen::Matrix<P, Axes, 1>;

  SensorChannel() = default;
  /// @param faults  one per lane; all with the same rate and delay
  /// @param stream  first of four random streams reserved for this sensor
  SensorChannel(const std::array<SensorFaults, N>& faults, std::uint32_t stream);

  [[nodiscard]] bool due(double now) const { return clock_.due(now); }
  [[nodiscard]] double next() const { return clock_.next(); }

  /// Measures the sample that is due, given the true value at its time.
  /// @param lost        lanes in which no measurement is possible
  /// @param added       added to the output of the response; nullptr: nothing
  /// @param more_noise  standard deviation of additional independent noise; nullptr: none
  void take(const Values& truth, const RandomSource<N>& source, const Mask<N>& lost = {},
            const Values* added = nullptr, const P* more_noise = nullptr);

  /// Delivers the newest sample that has arrived by `now`; call once per control period.
  /// @param dt  control period [s]
  template <class Value>
  void deliver(double now, double dt, Sample<Value, P>& sample) {
    sample.fresh = false;
    sample.age += P(dt);
    while (waiting_ > 0 && queue_[first_].arrival <= now + SampleClock::kSlack) {
      const Pending& come = queue_[first_];
      const Mask<N> here = logical_not(come.lost);
      if constexpr (Axes == 1) {
        sample.value = select(here, come.values(0), sample.value);
      } else {
        for (int i = 0; i < Axes; ++i)
          sample.value(i) = select(here, come.values(i), sample.value(i));
      }
      sample.fresh = logical_or(sample.fresh, here);
      sample.age = select(here, P(now - come.taken), sample.age);
      first_ = first_ + 1 == queue_.size() ? 0 : first_ + 1;
      --waiting_;
    }
  }

 private:
  struct Pending {
    Values values;
    Mask<N> lost;
    double taken = 0;
    double arrival = 0;
  };

  SampleClock clock_;
  double delay_ = 0;
  std::uint32_t stream_ = 0;
  bool noisy_ = false, responds_ = false, quantized_ = false, limited_ = false, lossy_ = false;
  Values scale_, bias_, noise_;
  P limit_, quantum_, dropout_;
  std::array<P, 8> response_;  ///< A in row-major order, b0, b1
  Values before_, y_, rate_;   ///< last true value and state of the response; NaN: none yet
  SensorDrift<N, Axes> drift_;
  std::vector<Pending> queue_;
  std::size_t first_ = 0, waiting_ = 0;
};

template <int N, int Axes>
SensorChannel<N, Axes>::SensorChannel(const std::array<SensorFaults, N>& faults,
                                      std::uint32_t stream)
    : clock_(faults[0].rate),
      delay_(faults[0].delay),
      stream_(stream),
      drift_(faults, stream),
      queue_(static_cast<std::size_t>(faults[0].delay * faults[0].rate) + 2) {
  for (int l = 0; l < N; ++l) {
    const SensorFaults& f = faults[static_cast<std::size_t>(l)];
    for (int i = 0; i < Axes; ++i) {
      set_lane(scale_(i), l, f.scale(i));
      set_lane(bias_(i), l, f.bias(i));
      set_lane(noise_(i), l, f.noise(i));
      noisy_ = noisy_ || f.noise(i) != 0;
    }
    set_lane(limit_, l, f.limit);
    set_lane(quantum_, l, f.quantum);
    set_lane(dropout_, l, f.dropout);
    limited_ = limited_ || std::isfinite(f.limit);
    quantized_ = quantized_ || f.quantum > 0;
    lossy_ = lossy_ || f.dropout > 0;
    responds_ = responds_ || f.natural_frequency > 0;
    const SampledResponse r = sampled_response(f.natural_frequency, f.damping, 1 / f.rate);
    const std::array<double, 8> numbers = {r.A(0, 0), r.A(0, 1), r.A(1, 0), r.A(1, 1),
                                           r.b0(0),   r.b0(1),   r.b1(0),   r.b1(1)};
    for (std::size_t i = 0; i < 8; ++i) set_lane(response_[i], l, numbers[i]);
  }
  // The response starts with the first true value
  y_.setConstant(P(std::numeric_limits<double>::quiet_NaN()));
}

template <int N, int Axes>
void SensorChannel<N, Axes>::take(const Values& truth, const RandomSource<N>& source,
                                  const Mask<N>& lost, const Values* added, const P* more_noise) {
  Values y = truth;
  if (responds_) {
    // Start at rest at the first true value, also after an interval without one: a NaN in the state
    // of the response would remain there for ever.
    const P none = std::numeric_limits<double>::quiet_NaN();
    for (int i = 0; i < Axes; ++i) {
      const Mask<N> goes_on = y_(i) == y_(i);
      const P y0 = select(goes_on, y_(i), truth(i)), r0 = select(goes_on, rate_(i), P(0));
      const P u0 = select(goes_on, before_(i), truth(i));
      const P& u1 = truth(i);
      y(i) = response_[0] * y0 + response_[1] * r0 + response_[4] * u0 + response_[6] * u1;
      rate_(i) = response_[2] * y0 + response_[3] * r0 + response_[5] * u0 + response_[7] * u1;
      y_(i) = select(lost, none, y(i));
    }
    before_ = truth;
  }
  const std::uint64_t index = clock_.index();
  if (added != nullptr) y += *added;
  for (int i = 0; i < Axes; ++i) y(i) = y(i) * scale_(i) + bias_(i);
  if (drift_.present()) drift_.add_to(y, index, source);
  if (noisy_ || more_noise != nullptr) {
    Values deviation = noise_;
    if (more_noise != nullptr)
      for (int i = 0; i < Axes; ++i) {
        using std::sqrt;
        const P both2 = noise_(i) * noise_(i) + *more_noise * *more_noise;
        deviation(i) = select(*more_noise > P(0), P(sqrt(both2)), noise_(i));
      }
    for (int i = 0; i < Axes; i += 2) {
      const RandomPair<N> n =
          random_normal(source, stream_ + static_cast<std::uint32_t>(i / 2), index);
      y(i) += deviation(i) * n.first;
      if (i + 1 < Axes) y(i + 1) += deviation(i + 1) * n.second;
    }
  }
  if (limited_)
    for (int i = 0; i < Axes; ++i)  // NaN must stay NaN: no echo is not the lower limit
      y(i) = select(y(i) == y(i), clamped(y(i), P(-limit_), limit_), y(i));
  if (quantized_)
    for (int i = 0; i < Axes; ++i)
      y(i) = select(quantum_ > P(0), nearest(y(i) / quantum_) * quantum_, y(i));
  Mask<N> gone = lost;
  if (lossy_) gone = logical_or(gone, random_uniform(source, stream_ + 3, index).first < dropout_);
  if (waiting_ == queue_.size()) {  // more samples in a control period than expected
    std::rotate(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(first_), queue_.end());
    first_ = 0;
    queue_.resize(2 * queue_.size());
  }
  const std::size_t end = (first_ + waiting_) % queue_.size();
  queue_[end] = {y, gone, clock_.next(), clock_.next() + delay_};
  ++waiting_;
  clock_.advance();
}

}  // namespace quadtune
