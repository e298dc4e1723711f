// SPDX-License-Identifier: Apache-2.0
/// Simulates the sensors of a loop: each takes the samples that are due by the end of a control
/// period, from the true state at the instant of the sample, and delivers those that have arrived.
#pragma once

#include <limits>

#include "simulation/loop/closed_loop.hpp"

namespace quadtune::internal {

template <int N, int R>
typename ClosedLoop<N, R>::State ClosedLoop<N, R>::true_state(double instant, double now) const {
  if (!carried_) return truth_at(instant, now);
  State x = x_;
  const QuaternionState<double> moved = quaternion_state<double>(carried_->at(instant).state());
  for (int i = 0; i < kRotorSpeeds; ++i) x(i) = P(moved(i));
  return x;
}

template <int N, int R>
void ClosedLoop<N, R>::sense(double now) {
  sense_inertial(now);
  sense_field_and_pressure(now);
  sense_ground(now);
  sense_position(now);
  if (accelerometer_) accelerometer_->deliver(now, dt_, frame_.specific_force);
  if (gyroscope_) gyroscope_->deliver(now, dt_, frame_.rates);
  if (magnetometer_) magnetometer_->deliver(now, dt_, frame_.magnetic_field);
  if (barometer_) barometer_->deliver(now, dt_, frame_.pressure);
  if (sonar_) sonar_->deliver(now, dt_, frame_.sonar);
  if (flow_) flow_->deliver(now, dt_, frame_.flow);
  if (gps_position_) gps_position_->deliver(now, dt_, frame_.gps_position);
  if (gps_velocity_) gps_velocity_->deliver(now, dt_, frame_.gps_velocity);
  if (vision_) vision_->deliver(now, dt_, frame_.vision);
}

template <int N, int R>
void ClosedLoop<N, R>::sense_inertial(double now) {
  while (accelerometer_ && accelerometer_->due(now)) {
    Vector3<P> force;
    if (carried_) {
      const Eigen::Vector3d felt =
          carried_->at(accelerometer_->next()).specific_force(flown_vehicle(common_).gravity);
      for (int i = 0; i < 3; ++i) force(i) = P(felt(i));
    } else {
      const State x = true_state(accelerometer_->next(), now);
      force = felt_at(accelerometer_->next(), x);
      if (accelerometer_shake_.present()) {
        const Vector3<P> shake = shake_at(accelerometer_shake_, accelerometer_->next(), now, x);
        accelerometer_->take(force, source_, {}, &shake);
        continue;
      }
    }
    accelerometer_->take(force, source_);
  }
  while (gyroscope_ && gyroscope_->due(now)) {
    const double instant = gyroscope_->next();
    const State x = true_state(instant, now);
    Vector3<P> rates = x.template segment<3>(kBodyRates);
    if (g_sensitive_ && !carried_) rates += g_sensitivity_.cwiseProduct(felt_at(instant, x));
    if (gyroscope_shake_.present() && !carried_) {
      const Vector3<P> shake = shake_at(gyroscope_shake_, instant, now, x);
      gyroscope_->take(rates, source_, {}, &shake);
      continue;
    }
    gyroscope_->take(rates, source_);
  }
}

template <int N, int R>
void ClosedLoop<N, R>::sense_field_and_pressure(double now) {
  while (magnetometer_ && magnetometer_->due(now)) {
    const Matrix3<P> M = rotation_of(true_state(magnetometer_->next(), now));
    magnetometer_->take(Vector3<P>(M.transpose() * field_), source_);
  }
  while (barometer_ && barometer_->due(now)) {
    const P height = -true_state(barometer_->next(), now)(2);
    const P pressure = linear_pressure_ ? P(ground_pressure_ + pressure_fall_ * height)
                                        : barometric_pressure(height, ground_pressure_);
    barometer_->take(Eigen::Matrix<P, 1, 1>(pressure), source_);
  }
}

template <int N, int R>
void ClosedLoop<N, R>::sense_ground(double now) {
  while (sonar_ && sonar_->due(now)) {
    const State x = true_state(sonar_->next(), now);
    const Matrix3<P> M = rotation_of(x);
    const P range = -x(2) / M(2, 2);
    const Mask<N> echo = logical_and(logical_and(range >= sonar_min_, range <= sonar_max_),
                                     M(2, 2) >= sonar_cosine_);
    sonar_->take(
        Eigen::Matrix<P, 1, 1>(select(echo, range, P(std::numeric_limits<double>::quiet_NaN()))),
        source_);
  }
  while (flow_ && flow_->due(now)) {
    const State x = true_state(flow_->next(), now);
    const Matrix3<P> M = rotation_of(x);
    const P height = -x(2);
    const Vector3<P> v = x.template segment<3>(kBodyVelocity);
    const Vector3<P> w = x.template segment<3>(kBodyRates);
    Eigen::Matrix<P, 2, 1> flow;
    if (common_.flow == FlowModel::simplified) {
      flow << -v.x() + flow_gain_ * w.y() * height, -v.y() - flow_gain_ * w.x() * height;
    } else {
      // Over level ground 1/Z is linear in the image coordinates, so the mean motion field has a
      // closed form.
      const P a = flow_a2_ * P(1.0 / 3), b = flow_b2_ * P(1.0 / 3);
      flow << (v.z() * M(2, 0) * a - v.x() * M(2, 2)) / height - w.y() * (P(1) + a),
          (v.z() * M(2, 1) * b - v.y() * M(2, 2)) / height + w.x() * (P(1) + b);
    }
    const P growth = flow_growth_ * height;
    flow_->take(
        flow, source_,
        logical_or(logical_or(height<flow_min_height_, height> flow_max_height_), M(2, 2) <= P(0)),
        nullptr, flow_grows_ ? &growth : nullptr);
  }
}

template <int N, int R>
void ClosedLoop<N, R>::sense_position(double now) {
  while (gps_position_ && gps_position_->due(now)) {
    const State x = true_state(gps_position_->next(), now);
    gps_position_->take(Vector3<P>(x.template segment<3>(kPosition)), source_);
    gps_velocity_->take(Vector3<P>(rotation_of(x) * x.template segment<3>(kBodyVelocity)), source_);
  }
  while (vision_ && vision_->due(now))
    vision_->take(Vector3<P>(true_state(vision_->next(), now).template segment<3>(kPosition)),
                  source_);
}

}  // namespace quadtune::internal
