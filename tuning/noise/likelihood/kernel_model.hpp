// SPDX-License-Identifier: Apache-2.0
/// What the likelihood's kernel is given at one θ, and what it sums up.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "noise/likelihood/kernel_record.hpp"
#include "noise/likelihood/log_sum.hpp"

namespace quadtune::internal {

/// A row of C: the entries that are not 0, and for few states all of them.
template <class Row, int nx>
struct MeasurementRow {
  std::vector<int> column;
  std::vector<Row> value;
  Eigen::Matrix<Row, nx == -1 ? 0 : nx, 1> all;

  /// f(column, entry) of each; a loop that is known when compiling where the states are few.
  template <class Function>
  void each(Function&& f) const {
    if constexpr (nx == -1)
      for (std::size_t q = 0; q < column.size(); ++q) f(column[q], value[q]);
    else
      for (int j = 0; j < nx; ++j) f(j, all(j));
  }
};

/// From one instant to the next.
template <class T, int nx>
struct KernelTransition {
  using Matrix =
      Eigen::Matrix<double, nx, nx, 0, nx == -1 ? kMostStates : nx, nx == -1 ? kMostStates : nx>;
  using MatrixT =
      Eigen::Matrix<T, nx, nx, 0, nx == -1 ? kMostStates : nx, nx == -1 ? kMostStates : nx>;
  Matrix F;
  Eigen::Matrix<double, nx, Eigen::Dynamic> B;
  MatrixT Q;
};

/// The model at one θ. Row is double, or T where an R is full and its rows are decorrelated.
template <class T, class Row, int nx>
struct KernelModel {
  std::vector<KernelTransition<T, nx>> transitions;
  std::vector<MeasurementRow<Row, nx>> C;  ///< ny
  std::vector<T> R;                        ///< ny
  Eigen::MatrixXd D;                       ///< (ny × nu), or empty
  /// (ny × ny) unit lower triangular L of R = L diag Lᵀ: rows of C are L⁻¹ C. Empty where every R
  /// is diagonal.
  Eigen::Matrix<Row, Eigen::Dynamic, Eigen::Dynamic> L;
  Eigen::VectorXd x0;
  Eigen::MatrixXd P0;
  Eigen::MatrixXd P0_diffuse;
  int diffuse_rank = 0;
  std::vector<T> variances;     ///< exp(θ) of the terms of Q.scaled, for linearized records
  std::vector<double> student;  ///< (ny) degrees of freedom; empty where all noise is normal
  std::vector<double> gate;     ///< (ny) largest e²/S, looked at where a trace is kept
};

/// What is written down of a run, where it is asked for.
struct KernelTrace {
  SampleMatrix* innovation;
  SampleMatrix* variance;
  SampleMatrix* x;
  SampleMatrix* x_variance;
  SampleArray<std::uint8_t>* refused;
};

/// Sums over records.
template <class T>
struct KernelSums {
  LogSum<T> logs;
  T squares = T(0);
  std::int64_t used = 0, diffuse = 0;
  double constants = 0;  ///< what Student's densities have besides logs and squares, twice
  Eigen::MatrixXd* information = nullptr;  ///< added to where it is asked for
  /// Where it failed: sample and output; -1 where it did not.
  Eigen::Index bad_sample = -1, bad_output = -1;
};

}  // namespace quadtune::internal
