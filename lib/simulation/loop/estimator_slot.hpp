// SPDX-License-Identifier: Apache-2.0
/// The estimators that a loop can hold. To add one: a class with update(), and a case in
/// EstimatorSlot::make().
#pragma once

#include <fmt/format.h>

#include <array>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "quadtune/convention.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/general_filter.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/simulation/pack_math.hpp"
#include "quadtune/simulation/uquad_flight.hpp"

namespace quadtune::internal {

/// Data from which the estimators of N flights are created.
template <int N>
struct EstimatorSetup {
  const std::array<const FlightSetup*, N>& setups;
  const std::array<Sensors, N>& sensors;
  double dt = 0;               ///< control period [s]
  bool starts_moving = false;  ///< in the air, or carried: sensor biases were estimated before
  StateVector<Pack<N>> state;  ///< at the start

  [[nodiscard]] const FlightSetup& common() const { return *setups[0]; }
  /// Time for which the vehicle is stationary before take-off, while biases are estimated [s].
  [[nodiscard]] double calibration_time() const {
    return starts_moving ? 0 : common().mission.start.start_up;
  }
  /// Collects a number of the sensors lane by lane.
  template <class Function>
  [[nodiscard]] Pack<N> of_sensors(const Function& number) const {
    Pack<N> result = 0;
    for (int l = 0; l < N; ++l) set_lane(result, l, number(sensors[static_cast<std::size_t>(l)]));
    return result;
  }
};

/// Inputs of the estimators in one control period.
template <int N>
struct EstimatorView {
  double time = 0;
  const SensorFrame<Pack<N>>& frame;
  const RotorSpeeds<Pack<N>>& speeds;  ///< last commanded speeds [rad/s]
  Mask<N> standing;
  const StateVector<Pack<N>>& truth;
};

template <int N>
class MamboEstimation {
 public:
  using P = Pack<N>;

  explicit MamboEstimation(const EstimatorSetup<N>& from) {
    MamboEstimatorSettings<double> settings = from.common().mambo_estimator;
    settings.dt = from.dt;
    settings.gravity = from.common().vehicle.gravity;
    settings.calibration_time = from.common().real_sensors ? from.calibration_time() : 0;
    validate(settings, "estimator");
    settings_ = mambo_estimator_cast<P>(settings);
    state_ = mambo_estimator_start(settings_, from.state);
    if (!from.starts_moving) return;
    for (int i = 0; i < 3; ++i) {
      if (from.sensors[0].gyroscope)
        state_.attitude.gyro_bias(i) =
            from.of_sensors([i](const Sensors& s) { return s.gyroscope->bias(i); });
      if (from.sensors[0].accelerometer)
        state_.force_bias(i) =
            from.of_sensors([i](const Sensors& s) { return s.accelerometer->bias(i); });
    }
  }

  [[nodiscard]] Estimate<P> update(const EstimatorView<N>& now) {
    return step(settings_, state_, now.frame);
  }
  [[nodiscard]] const MamboEstimatorSettings<P>& settings() const { return settings_; }

 private:
  MamboEstimatorSettings<P> settings_;
  MamboEstimatorState<P> state_;
};

template <int N>
class UquadEstimation {
 public:
  using P = Pack<N>;

  explicit UquadEstimation(const EstimatorSetup<N>& from)
      : settings_(uquad_filter_cast<P>(
            uquad_filter_settings(from.common(), from.sensors[0], from.calibration_time()))),
        body_(from.common().vehicle) {
    state_ = uquad_filter_start(settings_, from.state);
    if (from.starts_moving && from.sensors[0].gyroscope)
      for (int i = 0; i < 3; ++i)
        state_.gyro_offset(i) =
            from.of_sensors([i](const Sensors& s) { return s.gyroscope->bias(i); });
  }

  [[nodiscard]] Estimate<P> update(const EstimatorView<N>& now) {
    return step(settings_, state_, now.frame, body_, now.speeds, now.standing);
  }

 private:
  UquadFilterSettings<P> settings_;
  UquadFilterState<P> state_;
  RigidBody body_;  ///< vehicle model of the filter
};

template <int N>
class GeneralEstimation {
 public:
  using P = Pack<N>;

  explicit GeneralEstimation(const EstimatorSetup<N>& from)
      : settings_(general_filter_settings(from.common())),
        state_(general_filter_start(settings_, from.state)) {
    const Sensors& first = from.sensors[0];
    if (!from.starts_moving || !first.gyroscope || !first.accelerometer) return;
    Vector3<P> rates, force;
    for (int i = 0; i < 3; ++i) {
      rates(i) = from.of_sensors(
          [&](const Sensors& s) { return s.gyroscope->bias(i) / settings_.gyroscope.scale(i); });
      force(i) = from.of_sensors([&](const Sensors& s) {
        return s.accelerometer->bias(i) / settings_.accelerometer.scale(i);
      });
    }
    set_biases(state_, rates, force);
    if (settings_.pressure && first.barometer)
      state_.pressure_height = from.of_sensors([&](const Sensors& s) {
        return s.barometer->faults.bias(0) /
               (settings_.pressure->slope() * settings_.pressure->aid.scale);
      });
  }

  [[nodiscard]] Estimate<P> update(const EstimatorView<N>& now) {
    return step(settings_, state_, now.frame, now.standing);
  }

 private:
  GeneralFilterSettings settings_;
  GeneralFilterState<P> state_;
};

/// The true state, with a yaw that is not wrapped, as laws require.
template <int N>
class TrueState {
 public:
  using P = Pack<N>;

  explicit TrueState(const EstimatorSetup<N>& from) : yaw_(from.state(5)) {}

  [[nodiscard]] Estimate<P> update(const EstimatorView<N>& now) {
    Estimate<P> estimate;
    estimate.x = now.truth;
    const P turns = nearest((yaw_ - estimate.x(5)) * P(0.5 * std::numbers::inv_pi));
    estimate.x(5) += turns * P(2 * std::numbers::pi);
    yaw_ = estimate.x(5);
    return estimate;
  }

 private:
  P yaw_;  ///< of the previous period
};

/// User-defined estimators, one per lane.
template <int N>
class OwnEstimation {
 public:
  using P = Pack<N>;

  explicit OwnEstimation(const EstimatorSetup<N>& from) {
    for (std::size_t l = 0; l < N; ++l) {
      const FlightSetup& setup = *from.setups[l];
      const EstimatorStart start{setup.vehicle, from.dt, lane_of(from.state, l)};
      lanes_.push_back({setup.own_estimator.name, setup.own_estimator.make(start)});
      if (!lanes_.back().estimator)
        throw InvalidInput("estimator " + lanes_.back().name,
                           "make() returned null, expected an estimator");
    }
    last_.x = from.state;
  }

  [[nodiscard]] Estimate<P> update(const EstimatorView<N>& now) {
    for (std::size_t l = 0; l < N; ++l) update_lane(now, l);
    return last_;
  }
  [[nodiscard]] const std::string& culprit(std::size_t l) const { return lanes_[l].culprit; }

 private:
  struct Lane {
    std::string name;
    std::unique_ptr<FlightEstimator> estimator;
    std::string culprit = {};  ///< the entry that was not finite; empty if all are
  };

  template <int rows>
  [[nodiscard]] static Eigen::Matrix<double, rows, 1> lane_of(const Eigen::Matrix<P, rows, 1>& all,
                                                              std::size_t l) {
    return all.unaryExpr([l](const P& x) { return lane(x, static_cast<int>(l)); });
  }

  template <class Value>
  static void read(const Sample<Value, P>& all, std::size_t l, auto& one) {
    const int i = static_cast<int>(l);
    if constexpr (requires { lane(all.value, i); })
      one.value = lane(all.value, i);
    else
      one.value = lane_of(all.value, l);
    one.fresh = lane(all.fresh, i);
    one.age = lane(all.age, i);
  }

  void update_lane(const EstimatorView<N>& now, std::size_t l) {
    Lane& own = lanes_[l];
    if (!own.culprit.empty()) return;
    EstimatorInput input;
    input.time = now.time;
    read(now.frame.specific_force, l, input.sensors.specific_force);
    read(now.frame.rates, l, input.sensors.rates);
    read(now.frame.magnetic_field, l, input.sensors.magnetic_field);
    read(now.frame.pressure, l, input.sensors.pressure);
    read(now.frame.sonar, l, input.sensors.sonar);
    read(now.frame.flow, l, input.sensors.flow);
    read(now.frame.gps_position, l, input.sensors.gps_position);
    read(now.frame.gps_velocity, l, input.sensors.gps_velocity);
    read(now.frame.vision, l, input.sensors.vision);
    const int i = static_cast<int>(l);
    input.speeds = now.speeds.unaryExpr([i](const P& x) { return lane(x, i); });
    input.on_ground = lane(now.standing, i);
    input.true_state = lane_of(now.truth, l);
    keep(own.estimator->update(input), l);
  }

  /// Stores the estimate of a lane; if it is not finite, the previous one is kept.
  void keep(const Estimate<double>& estimate, std::size_t l) {
    const int i = static_cast<int>(l);
    for (int j = 0; j < 12 && lanes_[l].culprit.empty(); ++j)
      if (!std::isfinite(estimate.x(j)))
        lanes_[l].culprit =
            fmt::format("estimator '{}': {} is {}", lanes_[l].name,
                        ned_convention().states[static_cast<std::size_t>(j)].name, estimate.x(j));
    if (lanes_[l].culprit.empty() && !estimate.finite)
      lanes_[l].culprit =
          fmt::format("estimator '{}' reports that its state is not finite", lanes_[l].name);
    set_lane(last_.finite, i, lanes_[l].culprit.empty());
    if (!lanes_[l].culprit.empty()) return;
    for (int j = 0; j < 12; ++j) set_lane(last_.x(j), i, estimate.x(j));
    set_lane(last_.height_used, i, estimate.height_used);
    set_lane(last_.flow_used, i, estimate.flow_used);
    set_lane(last_.flow_disagrees, i, estimate.flow_disagrees);
    set_lane(last_.innovation_square, i, estimate.innovation_square);
    set_lane(last_.innovation_freedom, i, estimate.innovation_freedom);
  }

  std::vector<Lane> lanes_;
  Estimate<P> last_;
};

/// The estimator of N flights.
template <int N>
class EstimatorSlot {
 public:
  using P = Pack<N>;

  explicit EstimatorSlot(const EstimatorSetup<N>& from);

  [[nodiscard]] Estimate<P> update(const EstimatorView<N>& now);

  /// Whether update() reads EstimatorView::truth.
  [[nodiscard]] bool needs_truth() const {
    return std::holds_alternative<TrueState<N>>(slot_) ||
           std::holds_alternative<OwnEstimation<N>>(slot_);
  }
  /// Settings of an estimator that cannot work without optical flow; otherwise null.
  [[nodiscard]] const MamboEstimatorSettings<P>* needs_flow() const {
    const auto* mambo = std::get_if<MamboEstimation<N>>(&slot_);
    return mambo ? &mambo->settings() : nullptr;
  }
  /// For a user-defined estimator: description of the entry that was not finite; otherwise empty.
  [[nodiscard]] std::string culprit(std::size_t l) const {
    const auto* own = std::get_if<OwnEstimation<N>>(&slot_);
    return own ? own->culprit(l) : "";
  }

 private:
  using Slot = std::variant<MamboEstimation<N>, UquadEstimation<N>, GeneralEstimation<N>,
                            TrueState<N>, OwnEstimation<N>>;

  [[nodiscard]] static Slot make(const EstimatorSetup<N>& from);

  Slot slot_;
};

template <int N>
EstimatorSlot<N>::EstimatorSlot(const EstimatorSetup<N>& from) : slot_(make(from)) {}

template <int N>
Estimate<Pack<N>> EstimatorSlot<N>::update(const EstimatorView<N>& now) {
  return std::visit([&](auto& estimator) { return estimator.update(now); }, slot_);
}

template <int N>
typename EstimatorSlot<N>::Slot EstimatorSlot<N>::make(const EstimatorSetup<N>& from) {
  switch (from.common().estimator) {
    case EstimatorKind::mambo:
      return MamboEstimation<N>(from);
    case EstimatorKind::uquad:
      return UquadEstimation<N>(from);
    case EstimatorKind::general:
      return GeneralEstimation<N>(from);
    case EstimatorKind::truth:
      break;
    case EstimatorKind::own:
      return OwnEstimation<N>(from);
  }
  return TrueState<N>(from);
}

}  // namespace quadtune::internal
