// SPDX-License-Identifier: Apache-2.0
/// A plain integrator for tests that follow a motion.
#pragma once

#include <Eigen/Core>

namespace quadtune::testing {

/// The classical fourth-order Runge-Kutta method, `steps` steps of `dt` from x0 of x' = f(x). Its
/// global error is of the order (rate · dt)⁴.
template <class Vector, class F>
[[nodiscard]] Vector integrate(const F& f, Vector x, double dt, int steps) {
  for (int k = 0; k < steps; ++k) {
    const Vector k1 = f(x);
    const Vector k2 = f(Vector(x + 0.5 * dt * k1));
    const Vector k3 = f(Vector(x + 0.5 * dt * k2));
    const Vector k4 = f(Vector(x + dt * k3));
    x += dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return x;
}

}  // namespace quadtune::testing
