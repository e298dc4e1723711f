// SPDX-License-Identifier: Apache-2.0
/// Inputs of the passes of the Kalman filter at one θ, and the sums that they compute.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

#include "noise/likelihood/kernel_record.hpp"
#include "noise/likelihood/small_algebra.hpp"

namespace quadtune::internal {

/// The nonzero entries of a row of C; for two states all entries, so that loops are unrolled.
template <int N>
struct SparseRow {
  const int* column = nullptr;
  const double* value = nullptr;
  std::size_t size = 0;

  /// f(column, entry)
  template <class Function>
  [[gnu::always_inline]] void each(Function&& f) const {
    if constexpr (N == 2) {
      f(0, value[0]);
      f(1, value[1]);
    } else {
      for (std::size_t q = 0; q < size; ++q) f(column[q], value[q]);
    }
  }
  /// sum + c x
  [[nodiscard, gnu::always_inline]] double dot(const double* x, double sum = 0) const {
    each([&](int j, double c) { sum += c * x[j]; });
    return sum;
  }
  /// x += a cᵀ
  void add_to(double* x, double a) const {
    each([&](int j, double c) { x[j] += c * a; });
  }
  /// P cᵀ
  [[nodiscard, gnu::always_inline]] Column<N> times(const Square<N>& P) const {
    Column<N> result;
    each([&](int j, double c) { add_scaled<N>(c, P.column(j), result.at); });
    return result;
  }
};

/// Consecutive rows of C.
template <int N>
class SparseRows {
 public:
  void add(const Eigen::Ref<const Eigen::RowVectorXd>& row) {
    for (int j = 0; j < N; ++j) {
      const double value = j < row.size() ? row(j) : 0;
      if (N > 2 && value == 0) continue;
      column_.push_back(j);
      value_.push_back(value);
    }
    end_.push_back(column_.size());
  }
  [[nodiscard]] SparseRow<N> operator[](std::size_t row) const {
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

/// The linearized instants of a record: padded, without zeros and contiguous, because memory access
/// is slow if each instant consists of several heap blocks.
template <int N>
struct LinearizedInstants {
  std::vector<Square<N>> F;            ///< from each instant to the next
  std::vector<Column<N>> offset;       ///< likewise
  SparseRows<N> C;                     ///< ny per instant
  std::size_t terms = 0;               ///< number of terms of Q.scaled
  std::vector<SymmetricEntry> noise;   ///< of all terms of all instants
  std::vector<std::size_t> noise_end;  ///< of each term of each instant

  /// f(term, entry) for each entry of the noise after instant k.
  template <class Function>
  void each_noise(std::size_t k, Function&& f) const {
    if (terms == 0) return;
    std::size_t q = k == 0 ? 0 : noise_end[k * terms - 1];
    for (std::size_t t = 0; t < terms; ++t)
      for (; q < noise_end[k * terms + t]; ++q) f(t, noise[q]);
  }
};

/// x⁺ = F x + B u + w, w of covariance Q.
template <int N>
struct Transition {
  Square<N> F, F_transposed, Q;
  std::vector<Column<N>> B;  ///< nu columns
};

/// Adjacent entries of a column of Q, at least one of which depends on θ.
struct NoiseEntries {
  int row = 0;  ///< a multiple of kLanes
  int column = 0;
};

/// The model at one θ.
template <int N>
struct EngineModel {
  std::vector<Transition<N>> transitions;
  SparseRows<N> C;              ///< ny rows of L⁻¹ C
  std::vector<double> R;        ///< (ny) variances of L⁻¹ v
  Eigen::MatrixXd L;            ///< (ny × ny) of R = L diag Lᵀ; empty if all R are diagonal
  Eigen::MatrixXd D;            ///< (ny × nu), or empty
  std::vector<double> student;  ///< (ny) degrees of freedom; empty if all noise is normal
  std::vector<double> gate;     ///< (ny) largest e²/S; only for a trace
  std::vector<double> factors;  ///< factors of the noise shapes, for linearized records
  std::vector<NoiseEntries> noise_entries;
  bool diagonal_noise = true;  ///< whether only diagonal entries of Q depend on θ
  Eigen::VectorXd x0;
  Eigen::MatrixXd P0;
  std::vector<bool> diffuse;

  /// Row i of L⁻¹ (y - D u).
  /// @param whitened  rows before i; row i is written.
  double measurement(Eigen::Index i, const double* y, const double* u, double* whitened) const {
    double value = y[i];
    for (Eigen::Index j = 0; j < D.cols(); ++j) value -= D(i, j) * u[j];
    if (L.size() > 0) {
      for (Eigen::Index j = 0; j < i; ++j) value -= L(i, j) * whitened[j];
      whitened[i] = value;
    }
    return value;
  }
};

/// Derivatives of the model with respect to each of p parameters.
template <int N>
struct ModelSlopes {
  Eigen::MatrixXd R;                      ///< (p × ny)
  Eigen::MatrixXd factors;                ///< (p × terms) of EngineModel::factors
  std::vector<Square<N>> Q;               ///< for parameter a at transition t: [t p + a]
  std::vector<Eigen::MatrixXd> L;         ///< p matrices, or empty like EngineModel::L
  std::vector<std::vector<Column<N>>> C;  ///< p times ny rows, or likewise empty
};

/// Estimate and covariance P + κ P_diffuse of its error, κ → ∞.
template <int N>
struct FilterState {
  Column<N> x;
  Square<N> P, P_diffuse;
  int diffuse_rank = 0;
};

/// Σ log of positive numbers, computed from products, since a logarithm takes longer than a filter
/// step of two states.
class LogSum {
 public:
  void add(double x) {
    product_ *= x;
    if (!(product_ < 1e100 && product_ > 1e-100)) collect();
  }
  void add(double x, Eigen::Index times) { sum_ += std::log(x) * static_cast<double>(times); }
  [[nodiscard]] double value() const { return sum_ + std::log(product_); }

 private:
  void collect() {
    sum_ += std::log(product_);
    product_ = 1;
  }
  double product_ = 1;
  double sum_ = 0;
};

/// Sums over records, and derivatives of the log-likelihood by an adjoint pass.
template <int N>
struct LikelihoodSums {
  LogSum logs;
  double squares = 0;
  double constants = 0;  ///< twice the constants of Student's densities
  Eigen::Index used = 0, diffuse = 0;
  Eigen::Index bad_sample = -1, bad_output = -1;

  std::vector<double> by_R;  ///< ny
  /// Per transition; valid for the entries of EngineModel::noise_entries
  std::vector<Square<N>> by_Q;
  std::vector<double> by_factors;  ///< of linearized records
};

/// Output of a run: its innovations and states.
struct RunTrace {
  SampleMatrix* innovation;
  SampleMatrix* variance;
  SampleMatrix* x;
  SampleMatrix* x_variance;
  SampleArray<std::uint8_t>* refused;
};

}  // namespace quadtune::internal
