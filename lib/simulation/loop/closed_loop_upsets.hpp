// SPDX-License-Identifier: Apache-2.0
/// Events, and commands that arrive with a delay.
#pragma once

#include "simulation/loop/closed_loop.hpp"

namespace quadtune::internal {

template <int N, int R>
void ClosedLoop<N, R>::make_upsets() {
  const MotorCommand& motor = flown_vehicle(common_).motor;
  late_ = CommandDelay<N>(motor.delay, motor.delay_jitter, kCommandStream);
  const auto faults = [&](auto&& member) {
    std::array<SensorFaults, N> result;
    for (std::size_t l = 0; l < N; ++l) result[l] = member(sensors_[l]);
    return result;
  };
  if (accelerometer_)
    accelerometer_shake_ =
        RotorVibration<N>(faults([](const Sensors& s) { return *s.accelerometer; }));
  if (gyroscope_) {
    gyroscope_shake_ = RotorVibration<N>(faults([](const Sensors& s) { return *s.gyroscope; }));
    for (int l = 0; l < N; ++l)
      for (int i = 0; i < 3; ++i) {
        const double of_lane = sensors_[static_cast<std::size_t>(l)].g_sensitivity(i);
        set_lane(g_sensitivity_(i), l, of_lane);
        g_sensitive_ = g_sensitive_ || of_lane != 0;
      }
  }
  if ((accelerometer_shake_.present() || gyroscope_shake_.present()) && !carried_)
    phases_.start(plant_.body().rotor_count, source_, kVibrationStream);
}

/// Applies the events that are due.
template <int N, int R>
void ClosedLoop<N, R>::happen(double t) {
  const std::vector<FlightEvent>& events = common_.mission.events;
  for (; next_event_ < events.size(); ++next_event_) {
    const FlightEvent& event = events[next_event_];
    if (event.time > t + SampleClock::kSlack) return;
    if (const auto* fault = std::get_if<MotorFault>(&event.what)) {
      if (fault->thrust_share == 0)
        stopped_.push_back(fault->motor - 1);
      else
        plant_.weaken(fault->motor - 1, P(fault->thrust_share));
    } else {
      plant_.set_mass(plant_.body().mass + P(std::get<LoadChange>(event.what).mass));
    }
    for (int l = 0; l < N; ++l)
      if (lane(alive_, l))
        results_[static_cast<std::size_t>(l)].events.push_back({t, "event", describe(event)});
  }
}

/// Commands the motors, except those that have failed.
template <int N, int R>
void ClosedLoop<N, R>::tell(RotorSpeeds<P> speeds) {
  for (const int motor : stopped_) speeds(motor) = P(0);
  plant_.command(speeds, x_);
}

/// Integrates one control period piece by piece, since delayed commands can take effect at any
/// time.
template <int N, int R>
void ClosedLoop<N, R>::advance_late(std::uint64_t index, double t) {
  late_.send(index, t, speeds_, source_);
  pieces_.clear();
  const double end = t + dt_;
  std::uint64_t steps = 0;
  for (double begin = t; begin < end - SampleClock::kSlack;) {
    RotorSpeeds<P> told = plant_.speeds;
    while (late_.next() <= begin + SampleClock::kSlack) told = late_.take();
    tell(told);
    Piece piece;
    piece.begin = begin;
    piece.end = late_.next() < end - SampleClock::kSlack ? late_.next() : end;
    piece.speeds = plant_.speeds;
    piece.x = x_;
    piece.slope = plant_.derivative(x_);
    const double length = piece.end - begin;
    const int pieces = std::max(1, static_cast<int>(std::ceil(length / common_.step - 1e-9)));
    for (int i = 0; i < pieces; ++i) x_ = plant_.step(common_.integrator, x_, length / pieces);
    piece.x_end = x_;
    piece.slope_end = plant_.derivative(x_);
    pieces_.push_back(piece);
    steps += static_cast<std::uint64_t>(pieces);
    begin = piece.end;
  }
  x_before_ = pieces_.front().x;
  slope_before_ = pieces_.front().slope;
  for (int l = 0; l < N; ++l)
    if (lane(alive_, l)) results_[static_cast<std::size_t>(l)].steps += steps;
}

/// The piece of the last control period that contains an instant.
template <int N, int R>
const typename ClosedLoop<N, R>::Piece& ClosedLoop<N, R>::piece_at(double instant) const {
  std::size_t i = 0;
  while (i + 1 < pieces_.size() && instant > pieces_[i].end) ++i;
  return pieces_[i];
}

/// Specific force at the centre of mass at an instant of the last control period.
template <int N, int R>
Vector3<Pack<N>> ClosedLoop<N, R>::felt_at(double instant, const State& x) {
  if (pieces_.empty()) return plant_.specific_force(x);
  const RotorSpeeds<P> now = plant_.speeds;
  plant_.hold(piece_at(instant).speeds);
  Vector3<P> felt = plant_.specific_force(x);
  plant_.hold(now);
  return felt;
}

/// Vibration of the rotors in a sensor at an instant of the last control period.
template <int N, int R>
Vector3<Pack<N>> ClosedLoop<N, R>::shake_at(const RotorVibration<N>& shake, double instant,
                                            double now, const State& x) const {
  const RotorSpeeds<P> turning =
      R == 0 && !pieces_.empty() ? piece_at(instant).speeds : plant_.rotor_speeds(x);
  return shake.at(phases_.at(turning, between_ ? dt_ + (instant - now) : 0), turning);
}

}  // namespace quadtune::internal
