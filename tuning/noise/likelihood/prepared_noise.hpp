// SPDX-License-Identifier: Apache-2.0
/// The noise of a prepared step at a θ.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "noise/likelihood/prepared_model.hpp"

namespace quadtune::internal {

/// @param parameters  all of θ, plain or with derivatives.
/// @param Q           (nx × nx) of any type with entries of T.
template <class T, class Matrix>
void fill_noise(const CovarianceModel& model, const PreparedTransition& from, const T* parameters,
                Matrix& Q) {
  using std::exp;
  const Eigen::Index n = from.fixed.rows();
  const auto add = [&](const Eigen::MatrixXd& shape, const T& factor) {
    for (Eigen::Index j = 0; j < n; ++j)
      for (Eigen::Index i = 0; i < n; ++i)
        if (shape(i, j) != 0) Q(i, j) += factor * shape(i, j);
  };
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = 0; i < n; ++i) Q(i, j) = T(from.fixed(i, j));
  for (std::size_t t = 0; t < model.scaled.size(); ++t)
    add(from.scaled[t], T(exp(parameters[model.scaled[t].parameter])));
  for (std::size_t t = 0; t < model.full.size(); ++t) {
    const T* first = parameters + model.full[t].first_parameter;
    std::size_t entry = 0;
    for (int i = 0; i < static_cast<int>(model.full[t].entries.size()); ++i)
      for (int j = 0; j <= i; ++j) add(from.full[t][entry++], full_entry(first, i, j));
  }
}

}  // namespace quadtune::internal
