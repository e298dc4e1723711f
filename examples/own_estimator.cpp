// SPDX-License-Identifier: Apache-2.0
/// An estimator of your own in a simulated hover: a camera in the room measures the position.
/// Exit status: 0 if the flight passes its mission, 1 if not.
#include <iostream>
#include <memory>
#include <quadtune/quadtune.hpp>
#include <string>

namespace {

class CameraEstimator : public quadtune::FlightEstimator {
 public:
  explicit CameraEstimator(const quadtune::EstimatorStart& start)
      : gravity_(0, 0, start.vehicle.gravity), position_(start.state.head<3>()) {
    settings_.dt = start.dt;
    settings_.time_constant = 20;  // [s]: in flight the accelerometer hardly shows the tilt
    attitude_.angles = start.state.segment<3>(3);
  }
  // Called once a control period, before the law. World north-east-down, body forward-right-down.
  quadtune::Estimate<double> update(const quadtune::EstimatorInput& input) override {
    const quadtune::SensorFrame<double>& seen = input.sensors;
    const Eigen::Vector3d &force = seen.specific_force.value, &rates = seen.rates.value;
    quadtune::step(settings_, attitude_, rates, force, seen.specific_force.fresh);
    const Eigen::Vector3d& angles = attitude_.angles;  // roll, pitch, yaw
    const Eigen::Matrix3d R_WB = quadtune::rotation_of_euler(angles(0), angles(1), angles(2));
    // Predict with the accelerometer, correct with each image.
    if (!input.on_ground) velocity_ += settings_.dt * (R_WB * force + gravity_);
    position_ += settings_.dt * velocity_;
    const Eigen::Vector3d error = seen.vision.value - position_;
    position_ += (seen.vision.fresh ? 0.2 : 0) * error;
    velocity_ += (seen.vision.fresh ? 1.0 : 0) * error;
    quadtune::Estimate<double> estimate;
    estimate.x << position_, angles, R_WB.transpose() * velocity_, rates;
    return estimate;
  }

 private:
  Eigen::Vector3d gravity_, position_, velocity_ = Eigen::Vector3d::Zero();
  quadtune::ComplementaryFilterSettings<double> settings_;
  quadtune::ComplementaryFilterState<double> attitude_;
};

}  // namespace

int main() {
  quadtune::Vehicle vehicle = quadtune::load_vehicle("crazyflie");
  vehicle.sensors.vision = {.rate = 50, .noise = Eigen::Vector3d::Constant(0.002)};  // [Hz], [m]
  // The default law and mission: a cascade that hovers.
  quadtune::PlannedFlight plan = quadtune::plan_flight({}, vehicle, "own_estimator");
  plan.setup.estimator = quadtune::EstimatorKind::own;
  plan.setup.own_estimator = {"camera", [](const quadtune::EstimatorStart& start) {
                                return std::make_unique<CameraEstimator>(start);
                              }};
  const quadtune::FlownFlight flight = quadtune::fly_planned(plan);
  std::cout << "position estimated within " << flight.result.metrics[quadtune::Metric::estimate_rms]
            << " m (rms): " << (flight.passed ? "pass\n" : "fail\n");
  for (const std::string& why : quadtune::reasons(flight)) std::cout << "  " << why << '\n';
  return flight.passed ? 0 : 1;
}
