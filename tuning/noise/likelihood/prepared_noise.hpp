// SPDX-License-Identifier: Apache-2.0
/// The part of a prepared model that depends on θ, as numbers or with derivatives (jets).
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "noise/likelihood/prepared_model.hpp"

namespace quadtune::internal {

/// Factors of PreparedTransition::shapes at θ.
template <class T>
[[nodiscard]] std::vector<T> noise_factors(const CovarianceModel& Q, const T* theta) {
  using std::exp;
  std::vector<T> factors;
  for (const ScaledCovariance& term : Q.scaled) factors.push_back(T(exp(theta[term.parameter])));
  for (const FullCovariance& term : Q.full)
    for (int i = 0; i < static_cast<int>(term.entries.size()); ++i)
      for (int j = 0; j <= i; ++j)
        factors.push_back(full_entry(theta + term.first_parameter, i, j));
  return factors;
}

/// The outputs of all sensors with uncorrelated noise: with R = L diag(variance) Lᵀ, those of
/// L⁻¹ y = L⁻¹ C x + L⁻¹ v.
template <class T>
struct Measurements {
  using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  std::vector<T> variance;  ///< (ny)
  Matrix L;                 ///< (ny × ny) with unit diagonal
  Matrix C;                 ///< (ny × nx) L⁻¹ C
};

template <class T>
[[nodiscard]] Measurements<T> measurements_at(const PreparedModel& prepared, const T* theta) {
  const Eigen::Index ny = prepared.C.rows();
  Measurements<T> result;
  result.L.setIdentity(ny, ny);
  result.C = prepared.C.template cast<T>();
  for (const FilterSensor& sensor : prepared.model.sensors) {
    const auto first = static_cast<Eigen::Index>(result.variance.size());
    typename Measurements<T>::Matrix R(sensor.C.rows(), sensor.C.rows());
    fill_covariance(sensor.R, theta, R);
    const bool diagonal = is_diagonal(sensor.R);
    for (Eigen::Index i = 0; i < R.rows(); ++i) {
      T variance = R(i, i);
      for (Eigen::Index j = 0; j < i && !diagonal; ++j) {
        T sum = R(i, j);
        for (Eigen::Index q = 0; q < j; ++q)
          sum -= result.L(first + i, first + q) * result.L(first + j, first + q) *
                 result.variance[static_cast<std::size_t>(first + q)];
        const T& pivot = result.variance[static_cast<std::size_t>(first + j)];
        const T l = sum / pivot;
        result.L(first + i, first + j) = l;
        variance -= l * l * pivot;
        for (Eigen::Index c = 0; c < result.C.cols(); ++c)
          result.C(first + i, c) -= l * result.C(first + j, c);
      }
      result.variance.push_back(variance);
    }
  }
  return result;
}

}  // namespace quadtune::internal
