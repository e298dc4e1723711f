// SPDX-License-Identifier: Apache-2.0
/// One step of x' = f(t, x) by a fixed-step method. The state is of any type that supports addition
/// and multiplication by a number; t and h are numbers.
#pragma once

#include <string>

#include "quadtune/scalar.hpp"

namespace quadtune {

/// Integration methods with a fixed step.
enum class Integrator {
  euler,               ///< order 1
  bogacki_shampine_3,  ///< order 3, three evaluations; used by the original model projects
  runge_kutta_4,       ///< order 4, the classical method
};

/// "euler", "bogacki-shampine-3", "runge-kutta-4".
[[nodiscard]] std::string to_string(Integrator integrator);
/// Parses the name of an integrator.
/// @throws InvalidInput  naming the unknown word and the three known ones
[[nodiscard]] Integrator integrator(const std::string& name, const std::string& where);

/// combine(x, k ...), component by component if the state is a short vector: storing components and
/// then loading the whole vector would stall the processor.
template <class Combine, class State, class... States>
[[nodiscard, gnu::always_inline]] inline State combined(Combine&& combine, const State& x,
                                                        const States&... k) {
  if constexpr (requires { State::SizeAtCompileTime; }) {
    State result;
    if constexpr (State::SizeAtCompileTime < 0) {
      result.resize(x.size());
      for (int i = 0; i < x.size(); ++i) result(i) = combine(x(i), k(i)...);
    } else {
      unrolled<State::SizeAtCompileTime>([&](int i) __attribute__((always_inline)) {
        result(i) = combine(x(i), k(i)...);
      });
    }
    return result;
  } else {
    return combine(x, k...);
  }
}

/// Computes x + k h.
template <class State>
[[nodiscard, gnu::always_inline]] inline State moved(const State& x, const State& k, double h) {
  return combined([h](const auto& x_i, const auto& k_i) { return x_i + k_i * h; }, x, k);
}

/// One step of forward Euler; error O(h²).
template <class State, class Derivative>
[[nodiscard]] State euler_step(const Derivative& f, double t, const State& x, double h) {
  return moved(x, State(f(t, x)), h);
}

/// The third-order solution of the pair in [Bogacki89]; the embedded second-order solution is not
/// used.
template <class State, class Derivative>
[[nodiscard]] State bogacki_shampine_3_step(const Derivative& f, double t, const State& x,
                                            double h) {
  const State k1 = f(t, x);
  const State k2 = f(t + h / 2, moved(x, k1, h / 2));
  const State k3 = f(t + h * 3 / 4, moved(x, k2, h * 3 / 4));
  return combined(
      [h](const auto& x_i, const auto& a, const auto& b, const auto& c) {
        return x_i + (a * (h * 2 / 9) + b * (h / 3) + c * (h * 4 / 9));
      },
      x, k1, k2, k3);
}

/// One step of the classical Runge-Kutta method; error O(h⁵).
template <class State, class Derivative>
[[nodiscard]] State runge_kutta_4_step(const Derivative& f, double t, const State& x, double h) {
  const State k1 = f(t, x);
  const State k2 = f(t + h / 2, moved(x, k1, h / 2));
  const State k3 = f(t + h / 2, moved(x, k2, h / 2));
  const State k4 = f(t + h, moved(x, k3, h));
  return combined([h](const auto& x_i, const auto& a, const auto& b, const auto& c,
                      const auto& d) { return x_i + (a + (b + c) * 2.0 + d) * (h / 6); },
                  x, k1, k2, k3, k4);
}

/// One step by the given method.
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
