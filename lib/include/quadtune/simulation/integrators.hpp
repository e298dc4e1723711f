// SPDX-License-Identifier: Apache-2.0
/// One step of x' = f(t, x) by a fixed-step method. The state is anything that can be added and
/// multiplied by a number; t and h are numbers.
#pragma once

#include <string>

namespace quadtune {

/// Ways to carry the state over one step.
enum class Integrator {
  euler,               ///< order 1
  bogacki_shampine_3,  ///< order 3, three evaluations: what the model projects use
  runge_kutta_4,       ///< order 4, the classical one
};

/// "euler", "bogacki-shampine-3", "runge-kutta-4".
[[nodiscard]] std::string to_string(Integrator integrator);
/// @throws InvalidInput  naming the word and the three that exist.
[[nodiscard]] Integrator integrator(const std::string& name, const std::string& where);

template <class State, class Derivative>
[[nodiscard]] State euler_step(const Derivative& f, double t, const State& x, double h) {
  return x + f(t, x) * h;
}

/// The third-order solution of the pair of [Bogacki89], whose second-order one is not needed.
template <class State, class Derivative>
[[nodiscard]] State bogacki_shampine_3_step(const Derivative& f, double t, const State& x,
                                            double h) {
  const State k1 = f(t, x);
  const State k2 = f(t + h / 2, State(x + k1 * (h / 2)));
  const State k3 = f(t + h * 3 / 4, State(x + k2 * (h * 3 / 4)));
  return x + (k1 * (h * 2 / 9) + k2 * (h / 3) + k3 * (h * 4 / 9));
}

template <class State, class Derivative>
[[nodiscard]] State runge_kutta_4_step(const Derivative& f, double t, const State& x, double h) {
  const State k1 = f(t, x);
  const State k2 = f(t + h / 2, State(x + k1 * (h / 2)));
  const State k3 = f(t + h / 2, State(x + k2 * (h / 2)));
  const State k4 = f(t + h, State(x + k3 * h));
  return x + (k1 + (k2 + k3) * 2.0 + k4) * (h / 6);
}

template <class State, class Derivative>
[[nodiscard]] State integrator_step(Integrator method, const Derivative& f, double t,
                                    const State& x, double h) {
  switch (method) {
    case Integrator::euler:
      return euler_step(f, t, x, h);
    case Integrator::bogacki_shampine_3:
      return bogacki_shampine_3_step(f, t, x, h);
    case Integrator::runge_kutta_4:
      break;
  }
  return runge_kutta_4_step(f, t, x, h);
}

}  // namespace quadtune
