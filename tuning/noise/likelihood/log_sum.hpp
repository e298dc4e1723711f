// SPDX-License-Identifier: Apache-2.0
/// Sums over plain numbers and over jets, which carry derivatives: of logarithms, of slopes'
/// products.
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

/// Σ e' e'ᵀ, e' the derivatives of a jet; of plain numbers nothing.
template <class T>
class SlopeOuter {
 public:
  void add(const T& /*e*/) {}
  void add_to(Eigen::MatrixXd& /*sum*/, double /*factor*/) const {}
};
template <int p>
class SlopeOuter<ceres::Jet<double, p>> {
 public:
  void add(const ceres::Jet<double, p>& e) { sum_ += e.v * e.v.transpose(); }
  void add_to(Eigen::MatrixXd& sum, double factor) const { sum += factor * sum_; }

 private:
  Eigen::Matrix<double, p, p> sum_ = Eigen::Matrix<double, p, p>::Zero();
};

}  // namespace quadtune::internal
