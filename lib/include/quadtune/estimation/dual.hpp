// SPDX-License-Identifier: Apache-2.0
/// Numbers that carry their derivatives, for exact Jacobians of a function that is a template over
/// the scalar. They are like the jets of Ceres, which no public header includes, and each operation
/// returns a number, so that `auto` is safe.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <compare>
#include <concepts>
#include <type_traits>

#include "quadtune/errors.hpp"

namespace quadtune {
struct Dual;
}

namespace Eigen {

template <>
struct NumTraits<quadtune::Dual> : NumTraits<double> {
  using Real = quadtune::Dual;
  using NonInteger = quadtune::Dual;
  using Nested = quadtune::Dual;
  enum { RequireInitialization = 1, ReadCost = 4, AddCost = 5, MulCost = 9 };
};
template <class Operation>
struct ScalarBinaryOpTraits<quadtune::Dual, double, Operation> {
  using ReturnType = quadtune::Dual;
};
template <class Operation>
struct ScalarBinaryOpTraits<double, quadtune::Dual, Operation> {
  using ReturnType = quadtune::Dual;
};

}  // namespace Eigen

namespace quadtune {

/// A value with its derivatives by four variables. Comparisons use the value alone. A derivative
/// that does not exist is not finite, such as that of sqrt at 0; that of abs is ±1.
struct Dual {
  double value = 0;                                 ///< the number
  Eigen::Vector4d slope = Eigen::Vector4d::Zero();  ///< its four derivatives

  /// 0, a constant.
  Dual() = default;
  /// A constant; implicit, so that models may use numbers.
  Dual(double constant) : value(constant) {}
  /// A value with its derivatives.
  Dual(double value_, const Eigen::Vector4d& slope_) : value(value_), slope(slope_) {}

  /// Adds b.
  Dual& operator+=(const Dual& b) { return *this = *this + b; }
  /// Subtracts b.
  Dual& operator-=(const Dual& b) { return *this = *this - b; }
  /// Multiplies by b.
  Dual& operator*=(const Dual& b) { return *this = *this * b; }
  /// Divides by b.
  Dual& operator/=(const Dual& b) { return *this = *this / b; }

  /// The number itself.
  friend Dual operator+(const Dual& a) { return a; }
  /// Negative.
  friend Dual operator-(const Dual& a) { return {-a.value, -a.slope}; }
  /// Sum.
  friend Dual operator+(const Dual& a, const Dual& b) {
    return {a.value + b.value, a.slope + b.slope};
  }
  /// Difference.
  friend Dual operator-(const Dual& a, const Dual& b) {
    return {a.value - b.value, a.slope - b.slope};
  }
  /// Product.
  friend Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, b.value * a.slope + a.value * b.slope};
  }
  /// Quotient.
  friend Dual operator/(const Dual& a, const Dual& b) {
    const double ratio = a.value / b.value;
    return {ratio, (a.slope - ratio * b.slope) / b.value};
  }

  /// Whether the values are equal.
  friend bool operator==(const Dual& a, const Dual& b) { return a.value == b.value; }
  /// Order of the values.
  friend std::partial_ordering operator<=>(const Dual& a, const Dual& b) {
    return a.value <=> b.value;
  }

  /// Square root.
  friend Dual sqrt(const Dual& x) {
    const double root = std::sqrt(x.value);
    return {root, x.slope / (2 * root)};
  }
  /// Sine.
  friend Dual sin(const Dual& x) { return {std::sin(x.value), std::cos(x.value) * x.slope}; }
  /// Cosine.
  friend Dual cos(const Dual& x) { return {std::cos(x.value), -std::sin(x.value) * x.slope}; }
  /// Tangent.
  friend Dual tan(const Dual& x) {
    const double tangent = std::tan(x.value);
    return {tangent, (1 + tangent * tangent) * x.slope};
  }
  /// Arcsine.
  friend Dual asin(const Dual& x) {
    return {std::asin(x.value), x.slope / std::sqrt((1 - x.value) * (1 + x.value))};
  }
  /// Arccosine.
  friend Dual acos(const Dual& x) {
    return {std::acos(x.value), -x.slope / std::sqrt((1 - x.value) * (1 + x.value))};
  }
  /// Arctangent.
  friend Dual atan(const Dual& x) {
    return {std::atan(x.value), x.slope / (1 + x.value * x.value)};
  }
  /// Angle of the vector (x, y).
  friend Dual atan2(const Dual& y, const Dual& x) {
    const double r = std::hypot(x.value, y.value);
    return {std::atan2(y.value, x.value),
            (x.value / r) * (y.slope / r) - (y.value / r) * (x.slope / r)};
  }
  /// √(x² + y²).
  friend Dual hypot(const Dual& x, const Dual& y) {
    const double r = std::hypot(x.value, y.value);
    return {r, (x.value / r) * x.slope + (y.value / r) * y.slope};
  }
  /// Exponential.
  friend Dual exp(const Dual& x) {
    const double power = std::exp(x.value);
    return {power, power * x.slope};
  }
  /// Natural logarithm.
  friend Dual log(const Dual& x) { return {std::log(x.value), x.slope / x.value}; }
  /// Hyperbolic sine.
  friend Dual sinh(const Dual& x) { return {std::sinh(x.value), std::cosh(x.value) * x.slope}; }
  /// Hyperbolic cosine.
  friend Dual cosh(const Dual& x) { return {std::cosh(x.value), std::sinh(x.value) * x.slope}; }
  /// Hyperbolic tangent.
  friend Dual tanh(const Dual& x) {
    const double tangent = std::tanh(x.value);
    return {tangent, (1 - tangent * tangent) * x.slope};
  }
  /// Absolute value.
  friend Dual abs(const Dual& x) {
    return {std::abs(x.value), std::copysign(1, x.value) * x.slope};
  }
  /// Power with a constant exponent.
  friend Dual pow(const Dual& x, double exponent) {
    const double factor = exponent == 0 ? 0 : exponent * std::pow(x.value, exponent - 1);
    return {std::pow(x.value, exponent), factor * x.slope};
  }
  /// Power; of a positive x unless the exponent is constant.
  friend Dual pow(const Dual& x, const Dual& exponent) {
    return exponent.slope.isZero(0) ? pow(x, exponent.value) : exp(exponent * log(x));
  }
  /// Whether the value and all derivatives are finite.
  friend bool isfinite(const Dual& x) { return std::isfinite(x.value) && x.slope.allFinite(); }
};

/// A vector that a model receives: T is double or Dual.
template <class T>
using ModelVector = Eigen::Matrix<T, Eigen::Dynamic, 1>;

/// f(x) and its Jacobian ∂f/∂x (rows of f × size of x).
struct Linearized {
  Eigen::VectorXd value;     ///< f(x)
  Eigen::MatrixXd jacobian;  ///< ∂f/∂x
};

/// Evaluates f and its Jacobian, exactly up to rounding. f is called once for every four
/// entries of x.
/// @param f  maps a ModelVector<Dual> to a vector of Dual or to one Dual
/// @param x  the point, at least one entry
/// @throws InvalidInput  if the size of f(x) varies, or x is empty
template <class F>
[[nodiscard]] Linearized linearized(const F& f, const Eigen::VectorXd& x) {
  using Result = std::remove_cvref_t<std::invoke_result_t<const F&, const ModelVector<Dual>&>>;
  if (x.size() == 0) throw InvalidInput("linearized", "x is empty, expected at least one entry");
  ModelVector<Dual> z = x.cast<Dual>();
  ModelVector<Dual> fz;
  Linearized result;
  for (Eigen::Index first = 0; first < x.size(); first += 4) {
    const Eigen::Index width = std::min<Eigen::Index>(4, x.size() - first);
    for (Eigen::Index j = 0; j < width; ++j) z(first + j).slope(j) = 1;
    if constexpr (std::same_as<Result, Dual>) {
      fz = ModelVector<Dual>::Constant(1, f(z));
    } else {
      static_assert(std::same_as<Result, typename Result::PlainObject>,
                    "f returns an expression, which refers to variables that no longer exist: "
                    "state the return type, such as ModelVector<T>");
      fz = f(z);
    }
    for (Eigen::Index j = 0; j < width; ++j) z(first + j).slope.setZero();
    if (first == 0) {
      result.value = fz.unaryExpr([](const Dual& entry) { return entry.value; });
      result.jacobian.resize(fz.size(), x.size());
    }
    if (fz.size() != result.value.size())
      throw InvalidInput("linearized", "the size of f(x) varies, expected a constant size");
    for (Eigen::Index i = 0; i < fz.size(); ++i)
      result.jacobian.row(i).segment(first, width) = fz(i).slope.head(width).transpose();
  }
  return result;
}

}  // namespace quadtune
