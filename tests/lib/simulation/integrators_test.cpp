// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/integrators.hpp"

#include <gmock/gmock.h>

#include <array>
#include <boost/numeric/odeint.hpp>
#include <cmath>

#include "matrix_near.hpp"
#include "plants/sample_vehicles.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/simulation/plant.hpp"

namespace quadtune {
namespace {

using testing::MatrixNear;
using testing::plus_quadrotor;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

using PlantOfFour = Plant<double, 4>;
using State = PlantOfFour::State;

constexpr std::array kMethods = {Integrator::euler, Integrator::bogacki_shampine_3,
                                 Integrator::runge_kutta_4};

// A vehicle with drag, wind and rotors that lag, high above the ground, while its rotors run up to
// speeds that turn it about every axis. No component of the airspeed changes its sign on the way,
// where the drag would have a kink.
PlantOfFour climbing_plant(State& x) {
  Vehicle vehicle = plus_quadrotor();
  vehicle.drag.cda = {0.01, 0.02, 0.03};
  vehicle.drag.linear = {0.05, 0.04, 0.06};
  vehicle.inertia(0, 1) = vehicle.inertia(1, 0) = 1e-3;
  for (Rotor& rotor : vehicle.rotors) rotor.lag = 0.08;
  PlantOfFour plant(RigidBody(vehicle), GroundContact<double>{});
  plant.ground.present = false;
  plant.windy = true;
  plant.wind = {-1, 0.5, 0.2};
  const StateVector<double> start{{1, 2, -50, 0.2, -0.1, 0.6, 6, -5, -4, 0.4, -0.3, 0.5}};
  x.head<13>() = quaternion_state(start);
  x.tail<4>().setConstant(300);
  plant.command(Eigen::Vector4d(330, 321, 326, 324), x);
  return plant;
}

// The adaptive method of order 8(7) of Boost.Odeint.
State odeint(const PlantOfFour& plant, const State& from, double time, double tolerance) {
  using Numbers = std::array<double, 17>;
  namespace ode = boost::numeric::odeint;
  Numbers x;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = from(static_cast<Eigen::Index>(i));
  const auto f = [&](const Numbers& at, Numbers& rate, double) {
    const State derivative = plant.derivative(Eigen::Map<const State>(at.data()));
    for (std::size_t i = 0; i < rate.size(); ++i)
      rate[i] = derivative(static_cast<Eigen::Index>(i));
  };
  ode::integrate_adaptive(
      ode::make_controlled(tolerance, tolerance, ode::runge_kutta_fehlberg78<Numbers>()), f, x, 0.0,
      time, 1e-3);
  return Eigen::Map<const State>(x.data());
}

State flown(const PlantOfFour& plant, State x, Integrator method, double time, int steps) {
  for (int i = 0; i < steps; ++i) x = plant.step(method, x, time / steps);
  return x;
}

TEST(Integrators, AgreeWithAnAdaptiveMethod) {
  State x;
  const PlantOfFour plant = climbing_plant(x);
  const State exact = odeint(plant, x, 0.5, 1e-10);
  EXPECT_THAT(flown(plant, x, Integrator::runge_kutta_4, 0.5, 2000), MatrixNear(exact, 1e-8));
  EXPECT_THAT(flown(plant, x, Integrator::bogacki_shampine_3, 0.5, 4000), MatrixNear(exact, 1e-7));
  EXPECT_GT((exact - x).norm(), 5);  // and it did move
  EXPECT_GT(exact.segment<3>(4).norm(), 0.3);
}

// Halving the step divides the error by 2 to the order.
TEST(Integrators, HaveTheirOrders) {
  State x;
  const PlantOfFour plant = climbing_plant(x);
  const State exact = odeint(plant, x, 0.5, 1e-13);
  const std::array<double, 3> order = {1, 3, 4};
  const std::array<int, 3> steps = {400, 50, 50};
  for (std::size_t k = 0; k < 3; ++k) {
    std::array<double, 3> error;
    for (std::size_t i = 0; i < 3; ++i)
      error[i] = (flown(plant, x, kMethods[k], 0.5, steps[k] << i) - exact).norm();
    EXPECT_NEAR(std::log2(error[0] / error[1]), order[k], 0.15) << to_string(kMethods[k]);
    EXPECT_NEAR(std::log2(error[1] / error[2]), order[k], 0.1) << to_string(kMethods[k]);
  }
}

// x' = t² x has the time in it: x = x0 e^(t³/3).
TEST(Integrators, PassTheTimeOfEachStage) {
  const std::array<double, 3> order = {1, 3, 4};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto error = [&](int steps) {
      double x = 2;
      const double h = 1.0 / steps;
      for (int i = 0; i < steps; ++i)
        x = integrator_step(
            kMethods[k], [](double t, double at) { return t * t * at; }, 0.5 + i * h, x, h);
      return std::abs(x - 2 * std::exp((1.5 * 1.5 * 1.5 - 0.125) / 3));
    };
    EXPECT_NEAR(std::log2(error(64) / error(128)), order[k], 0.1);
  }
}

TEST(Integrators, KeepTheQuaternionsNorm) {
  State x;
  const PlantOfFour plant = climbing_plant(x);
  x.segment<3>(10) << 15, -20, 10;
  for (const Integrator method : kMethods) {
    State at = x;
    for (int i = 0; i < 100; ++i) {
      at = plant.step(method, at, 0.005);
      // What Euler's step adds, |w h / 2|² / 2 = 0.0023, is squared by the correction.
      ASSERT_NEAR(at.segment<4>(3).norm(), 1, 1e-4);
    }
  }
}

TEST(Integrators, HaveNames) {
  for (const Integrator method : kMethods) EXPECT_EQ(integrator(to_string(method), "x"), method);
  EXPECT_EQ(to_string(Integrator::bogacki_shampine_3), "bogacki-shampine-3");
  EXPECT_THAT([] { (void)integrator("runge-kuta-4", "--integrator"); },
              ThrowsMessage<InvalidInput>(
                  StrEq("--integrator: no solver 'runge-kuta-4', expected euler, "
                        "bogacki-shampine-3, runge-kutta-4; did you mean 'runge-kutta-4'?")));
}

}  // namespace
}  // namespace quadtune
