// SPDX-License-Identifier: Apache-2.0
/// The scalar with which the library's templates reproduce, bit by bit, what exported flight code
/// computes in `float`: its sines and logarithms are those of the exported source.
#pragma once

#include <Eigen/Core>

#include "quadtune/scalar.hpp"
#define QT_WITH_ESTIMATOR 1
#define QT_WITH_GENERAL 1
#define QT_WITH_LOGARITHM 1
extern "C" {
#include "flight_code/source/maths.h"
}

namespace quadtune::exports {

struct BoardFloat {
  float value;

  BoardFloat() = default;
  // NOLINTBEGIN(google-explicit-constructor): like the conversions between numbers
  BoardFloat(double x) : value(static_cast<float>(x)) {}
  BoardFloat(float x) : value(x) {}
  BoardFloat(int x) : value(static_cast<float>(x)) {}
  // NOLINTEND(google-explicit-constructor)

  friend BoardFloat operator+(BoardFloat a, BoardFloat b) { return a.value + b.value; }
  friend BoardFloat operator-(BoardFloat a, BoardFloat b) { return a.value - b.value; }
  friend BoardFloat operator*(BoardFloat a, BoardFloat b) { return a.value * b.value; }
  friend BoardFloat operator/(BoardFloat a, BoardFloat b) { return a.value / b.value; }
  friend BoardFloat operator-(BoardFloat a) { return -a.value; }
  friend BoardFloat operator+(BoardFloat a) { return a; }
  BoardFloat& operator+=(BoardFloat b) { return *this = *this + b; }
  BoardFloat& operator-=(BoardFloat b) { return *this = *this - b; }
  BoardFloat& operator*=(BoardFloat b) { return *this = *this * b; }
  BoardFloat& operator/=(BoardFloat b) { return *this = *this / b; }
  friend bool operator<(BoardFloat a, BoardFloat b) { return a.value < b.value; }
  friend bool operator<=(BoardFloat a, BoardFloat b) { return a.value <= b.value; }
  friend bool operator>(BoardFloat a, BoardFloat b) { return a.value > b.value; }
  friend bool operator>=(BoardFloat a, BoardFloat b) { return a.value >= b.value; }
  friend bool operator==(BoardFloat a, BoardFloat b) { return a.value == b.value; }
  friend bool operator!=(BoardFloat a, BoardFloat b) { return a.value != b.value; }
  friend BoardFloat select(bool mask, BoardFloat a, BoardFloat b) { return mask ? a : b; }
  friend BoardFloat min_of(BoardFloat a, BoardFloat b) { return qt_min(a.value, b.value); }
  friend BoardFloat max_of(BoardFloat a, BoardFloat b) { return qt_max(a.value, b.value); }
  friend BoardFloat abs_of(BoardFloat a) { return qt_abs(a.value); }
  friend BoardFloat abs(BoardFloat a) { return qt_abs(a.value); }
  friend bool is_finite(BoardFloat a) { return qt_is_finite(a.value); }
  friend BoardFloat sqrt(BoardFloat a) { return qt_sqrt(a.value); }
  friend BoardFloat nearest(BoardFloat a) { return qt_nearest(a.value); }
  friend BoardFloat sin(BoardFloat a) {
    float sine = 0, cosine = 0;
    qt_sine_and_cosine(a.value, &sine, &cosine);
    return sine;
  }
  friend BoardFloat cos(BoardFloat a) {
    float sine = 0, cosine = 0;
    qt_sine_and_cosine(a.value, &sine, &cosine);
    return cosine;
  }
  friend BoardFloat atan2(BoardFloat y, BoardFloat x) { return qt_atan2(y.value, x.value); }
  friend BoardFloat log(BoardFloat a) { return qt_natural_logarithm(a.value); }
  friend BoardFloat exp(BoardFloat a) { return qt_exponential(a.value); }
  friend double lane(BoardFloat a, int /*index*/) { return static_cast<double>(a.value); }
  friend void set_lane(BoardFloat& a, int /*index*/, double x) { a = BoardFloat(x); }
};

}  // namespace quadtune::exports

namespace Eigen {

template <>
struct NumTraits<quadtune::exports::BoardFloat> : NumTraits<float> {
  using Real = quadtune::exports::BoardFloat;
  using NonInteger = quadtune::exports::BoardFloat;
  using Nested = quadtune::exports::BoardFloat;
  using Literal = double;
  enum { RequireInitialization = 0 };
};
template <class Operation>
struct ScalarBinaryOpTraits<quadtune::exports::BoardFloat, double, Operation> {
  using ReturnType = quadtune::exports::BoardFloat;
};
template <class Operation>
struct ScalarBinaryOpTraits<double, quadtune::exports::BoardFloat, Operation> {
  using ReturnType = quadtune::exports::BoardFloat;
};

}  // namespace Eigen
