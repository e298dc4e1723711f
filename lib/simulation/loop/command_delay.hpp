// SPDX-License-Identifier: Apache-2.0
/// Delays commands between the law and the motors.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <limits>

#include "quadtune/model/rigid_body.hpp"
#include "quadtune/simulation/random.hpp"

namespace quadtune::internal {

/// Each command takes effect `delay` after it was sent, plus a random delay, uniformly distributed
/// in 0 … jitter, but never before the previous command. All lanes use the delay of the first;
/// flights with jitter are simulated one by one, see same_structure().
template <int N>
class CommandDelay {
 public:
  using Speeds = RotorSpeeds<Pack<N>>;

  CommandDelay() = default;
  /// @param delay, jitter  [s], ≥ 0;  @param stream  number of the random stream
  CommandDelay(double delay, double jitter, std::uint32_t stream)
      : delay_(delay), jitter_(jitter), stream_(stream) {}

  [[nodiscard]] bool active() const { return delay_ > 0 || jitter_ > 0; }

  /// @param index  of the control period;  @param t  its beginning [s]
  void send(std::uint64_t index, double t, const Speeds& speeds, const RandomSource<N>& source) {
    double arrival = t + delay_;
    if (jitter_ > 0) arrival += jitter_ * lane(random_uniform(source, stream_, index).first, 0);
    if (!waiting_.empty()) arrival = std::max(arrival, waiting_.back().arrival);
    waiting_.push_back({arrival, speeds});
  }

  /// Time at which the next command takes effect [s]; infinite if there is none.
  [[nodiscard]] double next() const {
    return waiting_.empty() ? std::numeric_limits<double>::infinity() : waiting_.front().arrival;
  }

  [[nodiscard]] Speeds take() {
    Speeds speeds = waiting_.front().speeds;
    waiting_.pop_front();
    return speeds;
  }

 private:
  struct Waiting {
    double arrival;  ///< [s]
    Speeds speeds;
  };

  double delay_ = 0, jitter_ = 0;
  std::uint32_t stream_ = 0;
  std::deque<Waiting> waiting_;
};

}  // namespace quadtune::internal
