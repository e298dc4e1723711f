// SPDX-License-Identifier: Apache-2.0
/// Allows Ceres jets as the scalar type of the on-board code (scalar.hpp), to compute its exact
/// derivatives. Private to this folder: no public header includes Ceres.
#pragma once

#include <ceres/jet.h>

#include <cmath>

// In the namespace of the jets, so that argument-dependent lookup finds the functions.
namespace ceres {

template <class T, int N>
[[nodiscard]] Jet<T, N> select(bool mask, const Jet<T, N>& a, const Jet<T, N>& b) {
  return mask ? a : b;
}
template <class T, int N>
[[nodiscard]] Jet<T, N> min_of(const Jet<T, N>& a, const Jet<T, N>& b) {
  return a.a < b.a ? a : b;
}
template <class T, int N>
[[nodiscard]] Jet<T, N> max_of(const Jet<T, N>& a, const Jet<T, N>& b) {
  return a.a > b.a ? a : b;
}
template <class T, int N>
[[nodiscard]] bool is_finite(const Jet<T, N>& x) {
  return std::isfinite(x.a) && x.v.allFinite();
}
template <class T, int N>
[[nodiscard]] Jet<T, N> abs_of(const Jet<T, N>& x) {
  return x.a < 0 ? Jet<T, N>(-x) : x;
}
template <class T, int N>
[[nodiscard]] Jet<T, N> nearest(const Jet<T, N>& x) {
  return Jet<T, N>(std::nearbyint(x.a));
}

}  // namespace ceres
