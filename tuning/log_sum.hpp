// SPDX-License-Identifier: Apache-2.0
/// Sums of logarithms of plain numbers and of jets, which carry derivatives.
#pragma once

#include <ceres/jet.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <type_traits>

namespace quadtune::internal {

template <class T>
inline constexpr bool is_jet = !std::is_same_v<T, double>;

inline double plain(double x) { return x; }
template <int p>
double plain(const ceres::Jet<double, p>& x) {
  return x.a;
}

/// Σ log of positive numbers by products: a logarithm costs more than a filter of two states.
template <class T>
class LogSum {
 public:
  void add(const T& x) {
    product_ *= plain(x);
    if constexpr (is_jet<T>) slope_ += x.v / x.a;
    if (!(product_ < 1e100 && product_ > 1e-100)) collect();
  }
  void add(const T& x, std::int64_t times) {
    collect();
    sum_ += std::log(plain(x)) * static_cast<double>(times);
    if constexpr (is_jet<T>) slope_ += x.v / x.a * static_cast<double>(times);
  }
  [[nodiscard]] T value() {
    collect();
    if constexpr (is_jet<T>) {
      T result(sum_);
      result.v = slope_;
      return result;
    } else {
      return sum_;
    }
  }

 private:
  struct Nothing {};
  template <class U>
  struct SlopeOf {
    using type = Nothing;
  };
  template <int p>
  struct SlopeOf<ceres::Jet<double, p>> {
    using type = Eigen::Matrix<double, p, 1>;
  };
  static typename SlopeOf<T>::type zero() {
    if constexpr (is_jet<T>)
      return SlopeOf<T>::type::Zero();
    else
      return {};
  }

  void collect() {
    sum_ += std::log(product_);
    product_ = 1;
  }

  double product_ = 1;
  double sum_ = 0;
  typename SlopeOf<T>::type slope_ = zero();
};

}  // namespace quadtune::internal
