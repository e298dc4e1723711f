// SPDX-License-Identifier: Apache-2.0
/// A control law of your own in the simulation: own_law [MISSION]
/// Exit status: 0 if the flight passes its mission, 1 if not, 2 and one line for any error.
#include <algorithm>
#include <cmath>
#include <exception>
#include <iostream>
#include <memory>
#include <quadtune/model.hpp>
#include <quadtune/simulation.hpp>

namespace {
/// Position error to acceleration, acceleration to attitude and thrust, attitude error to torques.
class TiltLaw : public quadtune::FlightLaw {
 public:
  explicit TiltLaw(const quadtune::Vehicle& vehicle) : vehicle_(vehicle) {}
  // Called once a control period. World north-east-down, body forward-right-down.
  Eigen::VectorXd command(const quadtune::Estimate<double>& estimate,
                          const quadtune::Reference<double>& reference) override {
    const Eigen::Vector3d angles = estimate.x.segment<3>(3), rates = estimate.x.tail<3>();
    const Eigen::Matrix3d R_WB = quadtune::rotation_of_euler(angles(0), angles(1), angles(2));
    const Eigen::Vector3d velocity = R_WB * estimate.x.segment<3>(6);
    const Eigen::Vector3d a =
        2.0 * (reference.position - estimate.x.head<3>()) + 2.5 * (reference.velocity - velocity);
    // Along the heading: forward needs the nose down, right needs roll to the right.
    const double c = std::cos(angles(2)), s = std::sin(angles(2)), g = vehicle_.gravity;
    const double pitch = std::clamp(-(c * a(0) + s * a(1)) / g, -0.4, 0.4);
    const double roll = std::clamp((c * a(1) - s * a(0)) / g, -0.4, 0.4);
    const Eigen::Vector3d turn = Eigen::Vector3d(roll, pitch, reference.yaw) - angles;
    const Eigen::Vector3d torque = vehicle_.inertia * (100 * turn - 16 * rates);
    const double thrust = vehicle_.mass * (g - a(2)) / (std::cos(angles(0)) * std::cos(angles(1)));
    return Eigen::Vector4d(std::max(thrust, 0.0), torque(0), torque(1), torque(2));
  }

 private:
  quadtune::Vehicle vehicle_;
};
}  // namespace

int main(int count, char** words) {
  try {
    quadtune::FlightSetup setup;
    setup.vehicle = quadtune::load_vehicle("mambo");
    setup.mission = quadtune::load_mission(count > 1 ? words[1] : "step-north");
    setup.controller = quadtune::OwnController{
        "tilt law", 0.005, quadtune::InputKind::wrench,
        [](const quadtune::Vehicle& vehicle) { return std::make_unique<TiltLaw>(vehicle); }};
    setup.estimator = quadtune::EstimatorKind::truth;  // see own_estimator.cpp for the alternative
    const quadtune::FlightResult result = quadtune::fly(setup);
    const quadtune::Verdict verdict = quadtune::judge(setup.mission, result.metrics);
    for (const quadtune::LimitCheck& check : verdict.checks)
      std::cout << quadtune::name_of(check.metric) << ": " << check.value
                << (check.ok ? ": pass\n" : ": fail\n");
    return verdict.ok ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "own_law: " << error.what() << '\n';
    return 2;
  }
}
