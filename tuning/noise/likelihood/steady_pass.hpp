// SPDX-License-Identifier: Apache-2.0
/// The forward pass with steady gains.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <utility>
#include <vector>

#include "noise/likelihood/engine_model.hpp"
#include "noise/likelihood/sensitivities.hpp"
#include "noise/likelihood/steady_state.hpp"
#include "noise/likelihood/tape.hpp"

namespace quadtune::internal {

template <int N>
class SteadyPass {
 public:
  /// @param state  of the forward pass: read and advanced, except for its covariance
  /// @param tape, sensitivities  of the forward pass; may be null
  SteadyPass(const EngineModel<N>& model, const KernelRecord& record, const RunOptions& options,
             FilterState<N>& state, Tape<N>* tape, Sensitivities<N>* sensitivities)
      : model_(model),
        record_(record),
        options_(options),
        state_(state),
        tape_(tape),
        sensitivities_(sensitivities) {}

  /// Processes whole blocks of the rest of a segment with the gains of the current P; advances k.
  bool run(Eigen::Index& k, Eigen::Index end, LikelihoodSums<N>& sums) {
    SteadyState<N> own;
    if (tape_ != nullptr) tape_->steady.emplace_back();
    SteadyState<N>& steady = tape_ != nullptr ? tape_->steady.back() : own;
    steady.transition = record_.transition[k];
    steady.ny = record_.ny;
    steady.nu = record_.nu;
    steady.block = std::max<Eigen::Index>(1, 4 / record_.ny);
    steady.samples = (end - k) / steady.block * steady.block;
    if (!find_gains(k, steady, sums)) return false;
    steady.fill_forward(model_, sensitivities_);
    if (tape_ != nullptr) steady.fill_backward(model_);
    for (const double S : steady.S) sums.logs.add(S, steady.samples);
    sums.used += record_.ny * steady.samples;
    int pieces = 0;
    for (end = k + steady.samples; k < end;) {
      if (++pieces % Tape<N>::kSteadyPiecesPerQuestion == 0) options_.ask();
      const Eigen::Index stop = std::min(k + Tape<N>::kPieceSamples, end);
      double* numbers = nullptr;
      if (tape_ != nullptr) {
        TapePiece<N>& piece = tape_->add(k, steady.innovation_rows() * ((stop - k) / steady.block),
                                         static_cast<int>(tape_->steady.size()) - 1, state_);
        piece.end = stop;
        if (piece.numbers.size() > 0) numbers = piece.numbers.data();
      }
      if (sensitivities_ != nullptr)
        steady.with_sizes([&](auto y_size, auto u_size) {
          run_steady_sensitivities<y_size(), u_size()>(steady, k, stop, sums);
        });
      else
        run_piece(steady, k, stop, sums, numbers);
      k = stop;
    }
    return true;
  }

  /// @param numbers  output of the normalized innovations; may be null
  void run_piece(const SteadyState<N>& steady, Eigen::Index k, Eigen::Index stop,
                 LikelihoodSums<N>& sums, double* numbers) {
    steady.with_sizes([&](auto y_size, auto u_size) {
      if constexpr (y_size() == 4)
        run_two_states<u_size()>(steady, k, stop, sums, numbers);
      else
        run_blocks(steady, k, stop, sums, numbers);
    });
  }

 private:
  /// Computes K, S and their derivatives by the corrections of one instant, which are then undone.
  bool find_gains(Eigen::Index k, SteadyState<N>& steady, LikelihoodSums<N>& sums) {
    const FilterState<N> before = state_;
    std::vector<typename Sensitivities<N>::Slope> slopes_before;
    if (sensitivities_ != nullptr) slopes_before = sensitivities_->slopes;
    for (Eigen::Index i = 0; i < record_.ny; ++i) {
      const SparseRow<N> c = model_.C[static_cast<std::size_t>(i)];
      const Column<N> Pc = c.times(state_.P);
      const double S = model_.R[static_cast<std::size_t>(i)] + c.dot(Pc.at);
      if (!(S > 0)) {
        sums.bad_sample = k;
        sums.bad_output = i;
        return false;
      }
      Column<N>& K = steady.K.emplace_back();
      add_scaled<N>(1 / S, Pc.at, K.at);
      steady.S.push_back(S);
      if (sensitivities_ != nullptr) {
        sensitivities_->linearize(i, c, state_, Pc);
        for (const auto& slope : sensitivities_->slopes) {  // K' = (b - S' K)/S
          Column<N>& K_slope = steady.K_slope.emplace_back();
          add_scaled<N>(1 / S, slope.b.at, K_slope.at);
          add_scaled<N>(-slope.S / S, K.at, K_slope.at);
          steady.S_slope.push_back(slope.S);
        }
        sensitivities_->correct(K, 0);
      }
      add_outer<N>(-1, K.at, Pc.at, state_.P);
    }
    state_ = before;
    if (sensitivities_ != nullptr) sensitivities_->slopes = std::move(slopes_before);
    return true;
  }

  /// The numbers between the present write to the tape and the memory that is requested for a later
  /// one. The tape is larger than the second-level cache, and not every processor anticipates
  /// writes.
  static constexpr Eigen::Index kPrefetched = 256;

  void run_blocks(const SteadyState<N>& steady, Eigen::Index k, Eigen::Index stop,
                  LikelihoodSums<N>& sums, double* numbers) {
    const Eigen::Index e_rows = steady.innovation_rows();
    alignas(64) double out[2][kMaxOutputs + (N + 15) / 8 * 8];
    Vector<4> squares[kMaxOutputs / 4] = {};
    const double* x = state_.x.at;
    int side = 0;
    for (; k < stop; k += steady.block, side = 1 - side) {
      const Input<> y = {record_.y + k * record_.ny, steady.block * record_.ny};
      const Input<> u = {record_.u + k * record_.nu, steady.block * record_.nu};
      multiply(steady.forward.data(), steady.rows(N), out[side], y, u, Input<N>{x});
      x = out[side] + e_rows;
      for (Eigen::Index i = 0; i < e_rows; i += 4) {
        const Vector<4> e = lanes<4>(out[side] + i)->v;
        squares[i / 4] += e * e;
        if (numbers != nullptr) lanes<4>(numbers + i)->v = e;
      }
      if (numbers != nullptr) {
        __builtin_prefetch(numbers + kPrefetched, 1);
        numbers += e_rows;
      }
    }
    for (const Vector<4>& square : squares)
      for (int i = 0; i < 4; ++i) sums.squares += square[i];
    if (x != state_.x.at) std::copy_n(x, N, state_.x.at);
  }

  /// The same for two states and one output: a block is one vector, [ē; x⁺; 0; 0] of four samples,
  /// which stays in its register from one block to the next.
  template <int u_size>
  void run_two_states(const SteadyState<N>& steady, Eigen::Index k, Eigen::Index stop,
                      LikelihoodSums<N>& sums, double* numbers) {
    const double* const map = steady.forward.data();
    const Vector<8> by_x0 =
        reinterpret_cast<const Lanes<8>*>(map + Eigen::Index{8} * (4 + u_size))->v;
    const Vector<8> by_x1 =
        reinterpret_cast<const Lanes<8>*>(map + Eigen::Index{8} * (5 + u_size))->v;
    Vector<8> out = {0, 0, 0, 0, state_.x.at[0], state_.x.at[1], 0, 0}, squares = {};
    for (; k < stop; k += 4) {
      const double* column = map;
      Vector<8> even = {}, odd = {};
      add_columns<1>(column, 8, Input<4>{record_.y + k}, &even, &odd);
      add_columns<1>(column, 8, Input<u_size>{record_.u + k}, &even, &odd);
      out = (even + odd) + by_x0 * out[4] + by_x1 * out[5];
      squares += out * out;
      if (numbers != nullptr) {
        lanes<4>(numbers)->v = __builtin_shufflevector(out, out, 0, 1, 2, 3);
        numbers += 4;
      }
    }
    for (int i = 0; i < 4; ++i) sums.squares += squares[i];
    for (int i = 0; i < N; ++i) state_.x.at[i] = out[4 + i];
  }

  /// The same with e'/√S, whose products are the terms of gradient and information.
  template <int y_size, int u_size>
  void run_steady_sensitivities(const SteadyState<N>& steady, Eigen::Index k, Eigen::Index stop,
                                LikelihoodSums<N>& sums) {
    const auto p = static_cast<Eigen::Index>(sensitivities_->slopes.size());
    const Eigen::Index e_rows = steady.innovation_rows();
    const Eigen::Index rows = y_size == 4 ? 8 : steady.rows(N);
    const auto samples = static_cast<double>(stop - k);
    // Columns: one for each parameter, and one for the run itself.
    Eigen::MatrixXd now = Eigen::MatrixXd::Zero(rows, p + 1), next = now;
    std::copy_n(state_.x.at, N, now.col(p).data() + e_rows);
    for (Eigen::Index a = 0; a < p; ++a)
      std::copy_n(sensitivities_->slopes[static_cast<std::size_t>(a)].x.at, N,
                  now.col(a).data() + e_rows);
    Eigen::Matrix4Xd products = Eigen::Matrix4Xd::Zero(4, p * (p + 3) / 2);  // one per pair
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(e_rows);
    for (; k < stop; k += steady.block, now.swap(next)) {
      const Input<y_size> y = {record_.y + k * record_.ny, steady.block * record_.ny};
      const Input<u_size> u = {record_.u + k * record_.nu, steady.block * record_.nu};
      const Input<N> x = {now.col(p).data() + e_rows};
      multiply(steady.forward.data(), rows, next.col(p).data(), y, u, x);
      for (Eigen::Index a = 0; a < p; ++a)
        multiply(steady.forward_slope[static_cast<std::size_t>(a)].data(), rows, next.col(a).data(),
                 y, u, x, Input<N>{now.col(a).data() + e_rows});
      for (Eigen::Index i = 0; i < e_rows; i += 4) {
        double* product = products.data();
        for (Eigen::Index a = 0; a < p; ++a)
          for (Eigen::Index b = a; b <= p; ++b, product += 4)
            add_product(next.col(a).data() + i, next.col(b).data() + i, product);
        add_product(next.col(p).data() + i, next.col(p).data() + i, squares.data() + i);
      }
    }
    std::copy_n(now.col(p).data() + e_rows, N, state_.x.at);
    for (Eigen::Index a = 0; a < p; ++a)
      std::copy_n(now.col(a).data() + e_rows, N,
                  sensitivities_->slopes[static_cast<std::size_t>(a)].x.at);
    sums.squares += squares.sum();
    Eigen::Index pair = 0;
    for (Eigen::Index a = 0; a < p; ++a)
      for (Eigen::Index b = a; b <= p; ++b) {
        const double sum = products.col(pair++).sum();
        if (b == p) {
          sensitivities_->gradient(a) -= sum;
        } else {
          sensitivities_->information(a, b) += sum;
          if (a != b) sensitivities_->information(b, a) += sum;
        }
      }
    add_steady_variances(steady, samples, squares);
  }

  /// sum += a b, four entries each
  static void add_product(const double* a, const double* b, double* sum) {
    lanes<4>(sum)->v += lanes<4>(a)->v * lanes<4>(b)->v;
  }

  /// Adds the contribution of S' to the gradient, -½ Σ (1 - ē²) S'/S, and to the information, ½ Σ
  /// (S'/S)(S'/S)ᵀ.
  void add_steady_variances(const SteadyState<N>& steady, double samples,
                            const Eigen::VectorXd& squares) {
    const auto p = static_cast<Eigen::Index>(sensitivities_->slopes.size());
    for (Eigen::Index i = 0; i < steady.ny; ++i) {
      double square = 0;
      for (Eigen::Index sample = 0; sample < steady.block; ++sample)
        square += squares(sample * steady.ny + i);
      const Eigen::VectorXd relative =
          Eigen::Map<const Eigen::VectorXd>(steady.S_slope.data() + i * p, p) /
          steady.S[static_cast<std::size_t>(i)];
      sensitivities_->gradient -= 0.5 * (samples - square) * relative;
      sensitivities_->information += 0.5 * samples * relative * relative.transpose();
    }
  }

  const EngineModel<N>& model_;
  const KernelRecord& record_;
  const RunOptions& options_;
  FilterState<N>& state_;
  Tape<N>* tape_;
  Sensitivities<N>* sensitivities_;
};

}  // namespace quadtune::internal
