// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flown/flown_box.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/internal/in_parallel.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Indices of the parameters.
enum Place : Index { kMass, kInertiaX, kInertiaY, kInertiaZ, kThrust, kLag, kDelay, kCount };

Vehicle with_parameters(Vehicle vehicle, const VectorXd& p) {
  vehicle.mass *= p(kMass);
  vehicle.inertia = (p.segment<3>(kInertiaX).asDiagonal() * vehicle.inertia).eval();
  for (Rotor& rotor : vehicle.rotors) {
    rotor.thrust_a2 *= p(kThrust);
    rotor.thrust_a1 *= p(kThrust);
    rotor.torque_d2 *= p(kThrust);
    rotor.torque_d1 *= p(kThrust);
    rotor.lag = rotor.lag_down = p(kLag);
  }
  vehicle.motor.delay = p(kDelay);
  vehicle.motor.delay_jitter = 0;
  return vehicle;
}

/// The nominal vehicle, the corners, and the additional vehicle.
std::vector<VectorXd> points_of(const LoopFamily& family, const VectorXd& also) {
  VectorXd nominal(kCount);
  for (Index i = 0; i < kCount; ++i)
    nominal(i) = family.parameters[static_cast<std::size_t>(i)].nominal;
  std::vector<VectorXd> points = {nominal};
  if (also.size() == kCount && also != nominal) points.push_back(also);
  // Bits of a corner: mass, inertia, thrust, lag, delay.
  const std::vector<std::vector<Index>> groups = {
      {kMass}, {kInertiaX, kInertiaY, kInertiaZ}, {kThrust}, {kLag}, {kDelay}};
  for (unsigned corner = 0; corner < 1U << groups.size(); ++corner) {
    VectorXd point = nominal;
    for (std::size_t g = 0; g < groups.size(); ++g)
      for (const Index i : groups[g]) {
        const UncertainParameter& p = family.parameters[static_cast<std::size_t>(i)];
        point(i) = (corner >> g & 1U) != 0 ? p.high : p.low;
      }
    if (std::find(points.begin(), points.end(), point) == points.end()) points.push_back(point);
  }
  return points;
}

}  // namespace

FlownBox flown_box(const PlannedFlight& plan, const LoopFamily& family,
                   const FlownBoxOptions& options) {
  if (std::ssize(family.parameters) != kCount || family.parameters[kThrust].name != "thrust" ||
      family.parameters[kDelay].name != "delay")
    throw InvalidInput("flown box",
                       "the family has other parameters, expected those of uncertain_hover()");
  const std::vector<VectorXd> points = points_of(family, options.also);
  std::vector<FlownLoop> loops(points.size());
  FlownLoopOptions of_loop;
  of_loop.evidence = MarginsEvidence::none;
  const auto one = [&](std::size_t i) {
    PlannedFlight flown = plan;
    flown.setup.flown =
        with_parameters(plan.setup.flown ? *plan.setup.flown : plan.setup.vehicle, points[i]);
    loops[i] = flown_loop(flown, of_loop);
  };
  FlownBox box;
  try {
    internal::in_parallel(
        points.size(), internal::thread_count(options.threads), [&] { return one; },
        options.interrupted);
  } catch (const InvalidInput& error) {
    box.why = error.what();
    return box;
  }
  box.vehicles = static_cast<int>(points.size());
  const auto worst = std::min_element(
      loops.begin(), loops.end(),
      [](const FlownLoop& a, const FlownLoop& b) { return a.decay() < b.decay(); });
  box.parameters = points[static_cast<std::size_t>(worst - loops.begin())];
  box.worst = *worst;
  return box;
}

}  // namespace quadtune
