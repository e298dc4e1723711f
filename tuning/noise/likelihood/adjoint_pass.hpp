// SPDX-License-Identifier: Apache-2.0
/// The adjoint of the Kalman filter: derivatives of the log-likelihood with respect to all
/// covariances at once, whatever the number of parameters.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "noise/likelihood/forward_pass.hpp"
#include "noise/likelihood/steady_information.hpp"

namespace quadtune::internal {

/// Processes one record from its end to its beginning, for uncorrelated and normal measurements.
/// With r = ∂ log p/∂x and ½ (r rᵀ - N) = ∂ log p/∂P of a prediction, a measurement with gain K,
/// innovation e of variance S and row c changes them to
///     u = e/S - K·r,  D = 1/S + K·N K,  r ← r + cᵀ u,
///     N ← (I - K c)ᵀ N (I - K c) + cᵀ c/S,  ∂ log p/∂R = ½ (u² - D),
/// and a time step gives ∂ log p/∂Q = ½ (r rᵀ - N), r ← Fᵀ r, N ← Fᵀ N F (Koopman and Shephard
/// 1992).
template <int N>
class AdjointPass {
 public:
  /// @param forward  a forward pass that has processed the record with the tape
  AdjointPass(const EngineModel<N>& model, const KernelRecord& record,
              const LinearizedInstants<N>* instants, const RunOptions& options,
              ForwardPass<N>& forward, Tape<N>& tape)
      : model_(model),
        record_(record),
        instants_(instants),
        options_(options),
        forward_(forward),
        tape_(tape) {}

  /// Adds to sums.by_…
  void run(LikelihoodSums<N>& sums) {
    Eigen::VectorXd repeated;
    for (std::size_t p = tape_.count; p-- > 0;) {
      const TapePiece<N>& piece = tape_.pieces[p];
      if (piece.steady < 0 || p % Tape<N>::kSteadyPiecesPerQuestion == 0) options_.ask();
      const Eigen::VectorXd* numbers = &piece.numbers;
      if (numbers->size() == 0) {
        repeated.resize((piece.end - piece.begin) * std::max<Eigen::Index>(4, Tape<N>::kEntry) *
                        record_.ny);
        forward_.repeat(piece, repeated.data());
        numbers = &repeated;
      }
      if (piece.steady < 0)
        run_piece(piece, numbers->data(), sums);
      else
        run_steady_piece(piece, numbers->data(), sums);
    }
  }

 private:
  void run_piece(const TapePiece<N>& piece, const double* numbers, LikelihoodSums<N>& sums) {
    steady_ = -1;
    // Missing measurements leave part of the tape unused.
    for (Eigen::Index j = piece.begin * record_.ny; j < piece.end * record_.ny; ++j)
      if (!std::isnan(record_.y[j])) numbers += Tape<N>::kEntry;
    for (Eigen::Index k = piece.end; k > piece.begin;) {
      if constexpr (N == 2) k = run_two_states(k, piece.begin, numbers, sums);
      if (k-- == piece.begin) break;
      if (k + 1 < record_.samples) predict(k, sums);
      for (Eigen::Index i = record_.ny; i-- > 0;) {
        if (std::isnan(record_.y[k * record_.ny + i])) continue;
        numbers -= Tape<N>::kEntry;
        const SparseRow<N> c = forward_.row(k, i);
        const double u = numbers[N + 1] - dot<N>(numbers, r_.at);  // u = e/S - K·r
        sums.by_R[static_cast<std::size_t>(i)] +=
            0.5 * (u * u - correct_information(c, numbers, numbers[N]));
        c.add_to(r_.at, u);
      }
    }
  }

  /// Two states and one output, a time step and a correction combined: with g = F K,
  ///     u = e/S - g·r, D = 1/S + g·N g, r ← Fᵀ r + cᵀ u, N ← (F - g c)ᵀ N (F - g c) + cᵀ c/S,
  /// so that there is only one product between one N and the next.
  /// @return  the end of the remaining part, behind the last instant that differs from the others
  Eigen::Index run_two_states(Eigen::Index k, Eigen::Index begin, const double*& numbers,
                              LikelihoodSums<N>& sums) {
    if (record_.ny != 1 || instants_ != nullptr || k == record_.samples) return k;
    const std::uint32_t transition = record_.transition[k - 1];
    const Square<N>& F = model_.transitions[transition].F;
    const double F00 = F(0, 0), F01 = F(0, 1), F10 = F(1, 0), F11 = F(1, 1);
    const double c0 = model_.C[0].value[0], c1 = model_.C[0].value[1];
    double r0 = r_.at[0], r1 = r_.at[1], N00 = N_(0, 0), N10 = N_(1, 0), N11 = N_(1, 1);
    double by_R = 0, by_Q00 = 0, by_Q10 = 0, by_Q11 = 0;  // twice
    for (; k > begin && record_.transition[k - 1] == transition && !std::isnan(record_.y[k - 1]);
         --k) {
      numbers -= Tape<N>::kEntry;
      by_Q00 += r0 * r0 - N00;
      by_Q10 += r0 * r1 - N10;
      by_Q11 += r1 * r1 - N11;
      const double g0 = F00 * numbers[0] + F01 * numbers[1];
      const double g1 = F10 * numbers[0] + F11 * numbers[1], precision = numbers[2];
      const double u = numbers[3] - (g0 * r0 + g1 * r1);
      by_R += u * u - (precision + g0 * (N00 * g0 + 2 * N10 * g1) + g1 * N11 * g1);
      const double before = F00 * r0 + (F10 * r1 + c0 * u);
      r1 = F01 * r0 + (F11 * r1 + c1 * u);
      r0 = before;
      const double M00 = F00 - g0 * c0, M01 = F01 - g0 * c1;
      const double M10 = F10 - g1 * c0, M11 = F11 - g1 * c1;
      const double NM00 = N00 * M00 + N10 * M10, NM01 = N00 * M01 + N10 * M11;
      const double NM10 = N10 * M00 + N11 * M10, NM11 = N10 * M01 + N11 * M11;
      N00 = M00 * NM00 + (M10 * NM10 + c0 * c0 * precision);
      N10 = M01 * NM00 + (M11 * NM10 + c0 * c1 * precision);
      N11 = M01 * NM01 + (M11 * NM11 + c1 * c1 * precision);
    }
    r_ = {{r0, r1}};
    N_ = {{N00, N10, N10, N11}};
    sums.by_R[0] += 0.5 * by_R;
    const Square<N> by_Q = {{by_Q00, by_Q10, by_Q10, by_Q11}};
    add_scaled<N * N>(0.5, by_Q.at, sums.by_Q[transition].at);
    return k;
  }

  void predict(Eigen::Index k, LikelihoodSums<N>& sums) {
    if (instants_ == nullptr) {
      const Transition<N>& step = model_.transitions[record_.transition[k]];
      Square<N>& by_Q = sums.by_Q[record_.transition[k]];  // += ½ (r rᵀ - N)
      if (model_.diagonal_noise) {
        for (int i = 0; i < N; ++i) by_Q(i, i) += 0.5 * (r_.at[i] * r_.at[i] - N_(i, i));
      } else {
        add_outer<N>(0.5, r_.at, r_.at, by_Q);
        add_scaled<N * N>(-0.5, N_.at, by_Q.at);
      }
      predict(step.F_transposed);
      return;
    }
    instants_->each_noise(static_cast<std::size_t>(k), [&](std::size_t t, const auto& entry) {
      const double share = entry.row == entry.column ? 0.5 : 1;
      sums.by_factors[t] += share * entry.value *
                            (r_.at[entry.row] * r_.at[entry.column] - N_(entry.row, entry.column));
    });
    transpose<N>(instants_->F[static_cast<std::size_t>(k)], F_transposed_);
    predict(F_transposed_);
  }
  void predict(const Square<N>& F_transposed) {
    Column<N> r;
    multiply<N>(F_transposed, r_.at, r.at);
    r_ = r;
    propagate<N>(F_transposed, N_, nullptr);
  }

  /// N ← (I - K c)ᵀ N (I - K c) + cᵀ c/S
  /// @return  D = 1/S + K·N K
  double correct_information(const SparseRow<N>& c, const double* K, double precision) {
    Column<N> NK;
    multiply<N>(N_, K, NK.at);
    const double D = precision + dot<N>(K, NK.at);
    if constexpr (N == 2) {  // the same with whole vectors: N - h c - cᵀ hᵀ, h = N K - ½ D cᵀ
      add_scaled<N>(-0.5 * D, c.value, NK.at);
      add_outer<N>(-1, NK.at, c.value, N_);
      add_outer<N>(-1, c.value, NK.at, N_);
      return D;
    }
    for (std::size_t q = 0; q < c.size; ++q) {
      const int column = c.column[q];
      add_scaled<N>(-c.value[q], NK.at, N_.column(column));
      for (int j = 0; j < N; ++j) N_(column, j) -= c.value[q] * NK.at[j];
    }
    for (std::size_t q = 0; q < c.size; ++q)
      for (std::size_t s = 0; s < c.size; ++s)
        N_(c.column[q], c.column[s]) += c.value[q] * c.value[s] * D;
    return D;
  }

  // --- steady gains ---

  void run_steady_piece(const TapePiece<N>& piece, const double* numbers, LikelihoodSums<N>& sums) {
    const SteadyState<N>& steady = tape_.steady[static_cast<std::size_t>(piece.steady)];
    if (steady_ != piece.steady) run_steady_information(steady, sums);
    steady_ = piece.steady;
    const Eigen::Index blocks = (piece.end - piece.begin) / steady.block;
    steady.with_sizes([&](auto y_size, auto) {
      if constexpr (y_size() == 4) {
        run_two_steady_states(steady, blocks, numbers);
        // The first piece of the stretch is processed last.
        if (&piece == tape_.pieces.data() || (&piece)[-1].steady != piece.steady)
          add_two_steady_states(steady, sums);
      } else {
        run_steady_residuals(steady, blocks, numbers, sums);
      }
    });
  }

  /// Propagates r through a piece, and adds its contribution to ∂ log p/∂Q and ∂ log p/∂R.
  void run_steady_residuals(const SteadyState<N>& steady, Eigen::Index left, const double* numbers,
                            LikelihoodSums<N>& sums) {
    constexpr int kGroup = 8;                       // blocks whose products are summed together
    constexpr int kRows = kMaxOutputs + 4 * N + 8;  // u, and r before each sample
    const Eigen::Index e_rows = steady.innovation_rows(), rows = steady.backward.rows();
    alignas(64) double out[kGroup][kRows];
    const double* r_after[4 * kGroup];  // one per sample
    // Squares of u, and of r too if only diagonal entries of r rᵀ are required.
    Vector<8> squares[kRows / 8] = {};
    const Eigen::Index squared = model_.diagonal_noise ? rows : e_rows;
    Square<N>& by_Q = sums.by_Q[steady.transition];
    const Column<N> last = r_;  // after the last sample of the piece
    while (left > 0) {
      const double* r = r_.at;
      int blocks = 0, samples = 0;
      for (; blocks < kGroup && left > 0; ++blocks) {
        --left;
        multiply(steady.backward.data(), rows, out[blocks],
                 Input<>{numbers + left * e_rows, steady.block * record_.ny}, Input<N>{r});
        for (Eigen::Index sample = 0; sample < steady.block; ++sample) {
          r_after[samples++] = r;
          r = out[blocks] + e_rows + sample * N;
        }
      }
      for (Eigen::Index i = 0; i < squared; i += 8) {
        Vector<8> sum = squares[i / 8];
        for (int block = 0; block < blocks; ++block) {
          const Vector<8> part = reinterpret_cast<const Lanes<8>*>(out[block] + i)->v;
          sum += part * part;
        }
        squares[i / 8] = sum;
      }
      if (!model_.diagonal_noise)
        for (const NoiseEntries& entries : model_.noise_entries) {  // ½ Σ r rᵀ
          Vector<kLanes<N>> sum{};
          for (int sample = 0; sample < samples; ++sample)
            sum += r_after[sample][entries.column] * lanes<N>(r_after[sample] + entries.row)->v;
          lanes<N>(by_Q.column(entries.column) + entries.row)->v += 0.5 * sum;
        }
      std::copy_n(r, N, r_.at);
    }
    for (Eigen::Index row = 0; row < steady.block * record_.ny; ++row)
      sums.by_R[static_cast<std::size_t>(row % record_.ny)] += 0.5 * squares[row / 8][row % 8];
    if (model_.diagonal_noise)
      for (int i = 0; i < N; ++i) {
        // Σ r rᵀ contains the r after each sample, and `squares` those before it.
        double sum = last.at[i] * last.at[i] - r_.at[i] * r_.at[i];
        for (Eigen::Index row = e_rows + i; row < e_rows + steady.block * N; row += N)
          sum += squares[row / 8][row % 8];
        by_Q(i, i) += 0.5 * sum;
      }
  }

  /// The same for two states and one output. All sums are quadratic in w = [ē; r] of a block of
  /// four samples, so that Σ w wᵀ suffices, and r stays in its register.
  void run_two_steady_states(const SteadyState<N>& steady, Eigen::Index blocks,
                             const double* numbers) {
    Vector<4> step[6];
    for (int j = 0; j < 6; ++j)
      step[j] = Vector<4>{steady.backward(10, j), steady.backward(11, j), 0, 0};
    Vector<8> products[6] = {};
    Vector<4> r = {r_.at[0], r_.at[1], 0, 0};
    while (blocks-- > 0) {
      const double* e = numbers + 4 * blocks;
      const Vector<8> w = __builtin_shufflevector(lanes<4>(e)->v, r, 0, 1, 2, 3, 4, 5, 6, 7);
      for (int j = 0; j < 4; ++j) products[j] += w * e[j];
      products[4] += w * r[0];
      products[5] += w * r[1];
      r = (step[0] * e[0] + step[1] * e[1] + (step[2] * e[2] + step[3] * e[3])) + step[4] * r[0] +
          step[5] * r[1];
    }
    r_ = {{r[0], r[1]}};
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 6; ++i) two_states_(i, j) += products[j][i];
  }

  /// Adds the contribution of a stretch of two steady states.
  void add_two_steady_states(const SteadyState<N>& steady, LikelihoodSums<N>& sums) {
    const Eigen::Matrix<double, 6, 6> of_w =
        std::exchange(two_states_, Eigen::Matrix<double, 6, 6>::Zero());
    const Eigen::Matrix<double, 12, 6> map = steady.backward.topRows(12);
    const Eigen::Matrix<double, 12, 12> of_map = map * of_w * map.transpose();
    sums.by_R[0] += 0.5 * of_map.diagonal().head<4>().sum();
    const Eigen::Matrix2d by_Q = 0.5 * (of_w.bottomRightCorner<2, 2>() + of_map.block<2, 2>(4, 4) +
                                        of_map.block<2, 2>(6, 6) + of_map.block<2, 2>(8, 8));
    add_scaled<N * N>(1, by_Q.data(), sums.by_Q[steady.transition].at);
  }

  /// Propagates N through a whole stretch, and adds the contribution of its steps to ∂ log p/∂Q and
  /// ∂ log p/∂R.
  void run_steady_information(const SteadyState<N>& steady, LikelihoodSums<N>& sums) {
    const Square<N> start = N_;
    N_ = Square<N>();
    for (Eigen::Index i = record_.ny; i-- > 0;) correct_information(steady, i);
    const SteadyInformation<N> information =
        steady_information<N>(steady.backward_step, N_, start, steady.samples);
    const auto samples = static_cast<double>(steady.samples);
    add_scaled<N * N>(-0.5, information.sum.at, sums.by_Q[steady.transition].at);
    // D is linear in N: the sum of D follows from the mean of N.
    N_ = Square<N>();
    add_scaled<N * N>(1 / samples, information.sum.at, N_.at);
    propagate<N>(model_.transitions[steady.transition].F_transposed, N_, nullptr);
    for (Eigen::Index i = record_.ny; i-- > 0;)
      sums.by_R[static_cast<std::size_t>(i)] -= 0.5 * samples * correct_information(steady, i);
    N_ = information.last;
  }
  double correct_information(const SteadyState<N>& steady, Eigen::Index i) {
    const auto q = static_cast<std::size_t>(i);
    return correct_information(model_.C[q], steady.K[q].at, 1 / steady.S[q]);
  }

  const EngineModel<N>& model_;
  const KernelRecord& record_;
  const LinearizedInstants<N>* instants_;
  const RunOptions& options_;
  ForwardPass<N>& forward_;
  Tape<N>& tape_;
  Column<N> r_;
  Square<N> N_, F_transposed_;
  /// Σ w wᵀ of run_two_steady_states() over the pieces of a stretch
  Eigen::Matrix<double, 6, 6> two_states_ = Eigen::Matrix<double, 6, 6>::Zero();
  int steady_ = -1;  ///< index of the steady gains through which N has been propagated
};

}  // namespace quadtune::internal
