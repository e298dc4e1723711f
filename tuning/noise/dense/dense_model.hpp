// SPDX-License-Identifier: Apache-2.0
/// What the filter in dense_filter.hpp is given at one θ, what it sums up, and what it leaves for
/// the way back.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "noise/dense/dense_algebra.hpp"
#include "noise/likelihood/kernel_record.hpp"
#include "noise/likelihood/log_sum.hpp"

namespace quadtune::internal {

/// A row of C: the entries that are not 0, wherever they are kept.
struct SparseRow {
  const int* column = nullptr;
  const double* value = nullptr;
  std::size_t size = 0;
};

/// Rows of C, one after the other, without their zeros.
class SparseRows {
 public:
  void add(const Eigen::Ref<const Eigen::RowVectorXd>& row) {
    for (Eigen::Index j = 0; j < row.size(); ++j)
      if (row(j) != 0) {
        column_.push_back(static_cast<int>(j));
        value_.push_back(row(j));
      }
    end_.push_back(column_.size());
  }
  [[nodiscard]] SparseRow operator[](std::size_t row) const {
    const std::size_t begin = row == 0 ? 0 : end_[row - 1];
    return {column_.data() + begin, value_.data() + begin, end_[row] - begin};
  }

 private:
  std::vector<int> column_;
  std::vector<double> value_;
  std::vector<std::size_t> end_;
};

/// An entry of a symmetric matrix, on the diagonal or below it.
struct SymmetricEntry {
  int row = 0;
  int column = 0;
  double value = 0;
};

/// The linearized instants of a record as the filter reads them: padded, without zeros, one after
/// the other, because the processor waits for memory where each is several blocks of the heap.
template <int N>
struct DenseInstants {
  std::vector<Square<N>> F;            ///< from each instant to the next
  std::vector<Column<N>> offset;       ///< likewise
  SparseRows C;                        ///< ny an instant
  std::size_t terms = 0;               ///< of Q.scaled
  std::vector<SymmetricEntry> noise;   ///< of all terms of all instants
  std::vector<std::size_t> noise_end;  ///< of each term of each instant

  /// f(term, entry) of each entry of the noise after instant k.
  template <class Function>
  void each_noise(std::size_t k, Function&& f) const {
    if (terms == 0) return;
    std::size_t q = k == 0 ? 0 : noise_end[k * terms - 1];
    for (std::size_t t = 0; t < terms; ++t)
      for (; q < noise_end[k * terms + t]; ++q) f(t, noise[q]);
  }
};

template <int N>
struct DenseTransition {
  Square<N> F, F_transposed, Q;
  Eigen::MatrixXd B;  ///< (N × nu)
};

/// Four entries of Q, one below the other, of which one depends on θ.
struct NoiseEntries {
  int row = 0;  ///< a multiple of 4
  int column = 0;
};

template <int N>
struct DenseModel {
  std::vector<DenseTransition<N>> transitions;
  SparseRows C;           ///< ny
  std::vector<double> R;  ///< ny
  std::vector<NoiseEntries> noise_entries;
  std::vector<double> variances;  ///< exp(θ) of the terms of Q.scaled, for linearized records
  Eigen::MatrixXd D;              ///< (ny × nu), or empty
  Eigen::VectorXd x0;
  Eigen::MatrixXd P0;
  std::vector<bool> diffuse;
};

template <int N>
struct DenseState {
  Column<N> x;
  Square<N> P, diffuse_P;
  int rank = 0;
};

/// Sums over records, and derivatives of the log-likelihood by what the model has of θ.
template <int N>
struct DenseSums {
  LogSum<double> logs;
  double squares = 0;
  std::int64_t used = 0, diffuse = 0;
  Eigen::Index bad_sample = -1, bad_output = -1;

  std::vector<double> by_R;          ///< ny
  std::vector<Square<N>> by_Q;       ///< of each transition; entries that depend on θ are right
  std::vector<double> by_variances;  ///< of DenseModel::variances
};

/// Gains of a covariance that has settled, and what they make of a sample.
template <int N>
struct SteadyGains {
  std::uint32_t transition = 0;
  std::int64_t samples = 0;      ///< that they are held for
  std::vector<Column<N>> gain;   ///< ny
  std::vector<double> variance;  ///< ny
  Eigen::VectorXd precision;     ///< 1/variance, padded with zeros to a multiple of 4
  // Of a state and ny measurements: the next state less what inputs do, and the innovations.
  Eigen::MatrixXd next, innovations;  ///< (N × N + ny), (padded × N + ny)
  // On the way back, of r and ny innovations over their variances: r before, and the weights.
  Eigen::MatrixXd before, weights;
};

/// A stretch of a record that is gone through in one go, each way.
template <int N>
struct DensePiece {
  Eigen::Index begin = 0, end = 0;
  int steady = -1;  ///< index of its gains; -1: they change
  DenseState<N> start;
  Eigen::VectorXd tape;  ///< what the way back needs; empty: it is made again
};

/// Kept from one run to the next, so that an evaluation allocates little.
template <int N>
struct DenseWorkspace {
  std::vector<DensePiece<N>> pieces;
  std::size_t piece_count = 0;
  std::vector<SteadyGains<N>> steady;
  Eigen::VectorXd scratch_tape;
};

}  // namespace quadtune::internal
