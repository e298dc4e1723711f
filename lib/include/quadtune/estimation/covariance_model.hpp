// SPDX-License-Identifier: Apache-2.0
/// A covariance matrix as a function of parameters that are estimated from logs.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <vector>

namespace quadtune {

/// exp(θ) · shape: one variance, or several entries that share a factor.
struct ScaledCovariance {
  Eigen::MatrixXd shape;  ///< (n × n) symmetric, ≥ 0
  int parameter = 0;      ///< index of θ, the logarithm of the factor
};

/// A full block, parameterized by its factor: Σ = L Lᵀ, row i of L = exp(θ_i / 2) (a_i1, …,
/// a_i,i-1, 1, 0, …). Any θ and a give a positive definite block, and each positive definite block
/// has exactly one θ and a.
struct FullCovariance {
  std::vector<int> entries;  ///< rows and columns of the block
  /// Index of the first of n (n + 1) / 2 consecutive parameters θ_1, a_21, θ_2, a_31, a_32, θ_3, ….
  int first_parameter = 0;
};

/// Σ(θ) = fixed + Σ scaled + Σ full.
struct CovarianceModel {
  Eigen::MatrixXd fixed;                 ///< (n × n) symmetric, ≥ 0
  std::vector<ScaledCovariance> scaled;  ///< terms that one variance scales; may be empty
  std::vector<FullCovariance> full;      ///< blocks with all their entries free; may be empty

  [[nodiscard]] Eigen::Index size() const { return fixed.rows(); }  ///< n, the number of rows
};

/// Whether Σ(θ) is diagonal for every θ.
[[nodiscard]] bool is_diagonal(const CovarianceModel& model);

/// Entry (i, j) of the block of a FullCovariance.
/// @param parameters  θ and a, beginning with the block's first parameter
/// @param i           row within the block, from 0
/// @param j           column within the block, from 0
template <class T>
[[nodiscard]] T full_entry(const T* parameters, int i, int j) {
  using std::exp;
  const auto row = [&](int k) { return parameters + k * (k + 1) / 2; };
  const auto factor = [&](int k, int q) { return k == q ? T(1) : row(k)[q]; };
  T sum = T(0);
  for (int q = 0; q <= (i < j ? i : j); ++q) sum += factor(i, q) * factor(j, q);
  return sum * T(exp(T(0.5) * (row(i)[i] + row(j)[j])));
}

/// Computes the parameters of a positive definite block: the inverse of full_entry().
/// @return  (n (n + 1) / 2), not finite if the block is not positive definite
[[nodiscard]] Eigen::VectorXd parameters_of_block(const Eigen::Ref<const Eigen::MatrixXd>& block);

/// Writes Σ(θ) to a matrix that already has the right size.
/// @param model       of the covariance
/// @param parameters  all parameters of the filter model that the covariance belongs to
/// @param result      (n × n) receives Σ(θ)
template <class T, class Matrix>
void fill_covariance(const CovarianceModel& model, const T* parameters, Matrix& result) {
  using std::exp;
  for (Eigen::Index j = 0; j < model.size(); ++j)
    for (Eigen::Index i = 0; i < model.size(); ++i) result(i, j) = T(model.fixed(i, j));
  for (const ScaledCovariance& term : model.scaled) {
    const T variance = exp(parameters[term.parameter]);
    for (Eigen::Index j = 0; j < model.size(); ++j)
      for (Eigen::Index i = 0; i < model.size(); ++i)
        if (term.shape(i, j) != 0) result(i, j) += variance * term.shape(i, j);
  }
  for (const FullCovariance& term : model.full)
    for (std::size_t j = 0; j < term.entries.size(); ++j)
      for (std::size_t i = 0; i < term.entries.size(); ++i)
        result(term.entries[i], term.entries[j]) +=
            full_entry(parameters + term.first_parameter, static_cast<int>(i), static_cast<int>(j));
}

/// Σ(θ) as a matrix of doubles.
[[nodiscard]] Eigen::MatrixXd covariance(const CovarianceModel& model,
                                         const Eigen::Ref<const Eigen::VectorXd>& parameters);

}  // namespace quadtune
