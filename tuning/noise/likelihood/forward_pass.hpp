// SPDX-License-Identifier: Apache-2.0
/// The Kalman filter over one record: likelihood, sensitivities, a trace, and what the adjoint pass
/// needs.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "noise/likelihood/convergence.hpp"
#include "noise/likelihood/engine_model.hpp"
#include "noise/likelihood/sensitivities.hpp"
#include "noise/likelihood/steady_state.hpp"

namespace quadtune::internal {

/// A stretch of a record that the adjoint pass goes through in one go.
template <int N>
struct TapePiece {
  Eigen::Index begin = 0, end = 0;
  int steady = -1;          ///< index of its gains; -1: they change
  FilterState<N> start;     ///< before `begin`
  Eigen::VectorXd numbers;  ///< empty: there was no room, the stretch is filtered once more
};

/// What a forward pass leaves for the adjoint pass; kept from one evaluation to the next, so that
/// these allocate little.
template <int N>
class Tape {
 public:
  static constexpr Eigen::Index kPieceSamples = 1024;
  static constexpr Eigen::Index kEntry = N + 2;  ///< numbers of one measurement: K, 1/S, e/S

  std::vector<TapePiece<N>> pieces;  ///< of which `count` are in use
  std::size_t count = 0;
  std::vector<SteadyState<N>> steady;

  void clear() {
    count = 0;
    steady.clear();
    left_ = kMaxNumbers;
    steady_left_ = kMaxSteadyNumbers;
  }
  TapePiece<N>& add(Eigen::Index begin, Eigen::Index size, int steady_index,
                    const FilterState<N>& start) {
    if (count == pieces.size()) pieces.emplace_back();
    TapePiece<N>& piece = pieces[count++];
    piece.begin = begin;
    piece.steady = steady_index;
    piece.start = start;
    Eigen::Index& left = steady_index < 0 ? left_ : steady_left_;
    piece.numbers.resize(size <= left ? size : 0);
    left -= piece.numbers.size();
    return piece;
  }

 private:
  /// 64 MiB, and 4 MiB of steady gains, whose filter is fast: the memory of a fit must not grow
  /// with the log.
  static constexpr Eigen::Index kMaxNumbers = Eigen::Index{1} << 23;
  static constexpr Eigen::Index kMaxSteadyNumbers = Eigen::Index{1} << 19;
  Eigen::Index left_ = 0, steady_left_ = 0;
};

template <int N>
class ForwardPass {
 public:
  /// What a run does besides the likelihood; any may be null. A tape needs measurements that are
  /// uncorrelated and normal.
  struct Extras {
    Tape<N>* tape = nullptr;
    Sensitivities<N>* sensitivities = nullptr;
    const RunTrace* trace = nullptr;
  };

  /// @param instants  of a linearized record, otherwise null
  ForwardPass(const EngineModel<N>& model, const KernelRecord& record,
              const LinearizedInstants<N>* instants, const RunOptions& options, Extras extras)
      : model_(model),
        record_(record),
        instants_(instants),
        options_(options),
        tape_(extras.tape),
        sensitivities_(extras.sensitivities),
        trace_(extras.trace) {}

  /// @return  false if an innovation has no positive variance; sums says which.
  /// @throws Interrupted  if the options ask for it
  bool run(LikelihoodSums<N>& sums) {
    start();
    for (std::size_t s = 0; s < record_.segment_count; ++s)
      if (!run_segment(record_.segments[s], sums)) return false;
    return true;
  }

  /// Writes the numbers of a piece that had no room on the tape.
  void repeat(const TapePiece<N>& piece, double* numbers) {
    LikelihoodSums<N> ignored;
    state_ = piece.start;
    if (piece.steady < 0)
      run_samples(piece.begin, piece.end, ignored, numbers);
    else
      run_steady(tape_->steady[static_cast<std::size_t>(piece.steady)], piece.begin, piece.end,
                 ignored, numbers);
  }

  [[nodiscard]] SparseRow<N> row(Eigen::Index k, Eigen::Index i) const {
    if (instants_ == nullptr) return model_.C[static_cast<std::size_t>(i)];
    return instants_->C[static_cast<std::size_t>(k * record_.ny + i)];
  }

 private:
  static constexpr Eigen::Index kEvery = Convergence::kEvery;

  void start() {
    state_ = FilterState<N>();
    if (sensitivities_ != nullptr) sensitivities_->start();
    if (tape_ != nullptr) tape_->clear();
    numbers_ = nullptr;
    const Eigen::VectorXd& x0 = record_.start != nullptr ? record_.start->x : model_.x0;
    const Eigen::MatrixXd& P0 = record_.start != nullptr ? record_.start->P : model_.P0;
    for (Eigen::Index j = 0; j < x0.size(); ++j) {
      state_.x.at[j] = x0(j);
      for (Eigen::Index i = 0; i < x0.size(); ++i) state_.P(i, j) = P0(i, j);
      if (record_.start == nullptr && model_.diffuse[static_cast<std::size_t>(j)]) {
        state_.P_diffuse(j, j) = 1;
        ++state_.diffuse_rank;
      }
    }
  }

  bool run_segment(const KernelSegment& segment, LikelihoodSums<N>& sums) {
    bool may_settle = options_.hold_steady_gains && segment.complete && trace_ == nullptr &&
                      model_.student.empty() && segment.end - segment.begin > 2 * kEvery;
    SteadyTest<N> steady;
    for (Eigen::Index k = segment.begin; k < segment.end;) {
      if ((k - segment.begin) % RunOptions::kEvery < kEvery) options_.ask();
      Eigen::Index stop = std::min(k + kEvery, segment.end);
      if (tape_ != nullptr) {
        TapePiece<N>& piece = open_piece(k);
        stop = std::min(stop, piece.begin + Tape<N>::kPieceSamples);
        piece.end = stop;
      }
      if (!run_samples(k, stop, sums, numbers_)) return false;
      k = stop;
      if (may_settle && k < segment.end && (k - segment.begin) % kEvery == 0 &&
          state_.diffuse_rank == 0 && steady.reached(state_.P, sensitivities_)) {
        may_settle = false;
        if (!hold_gains(k, segment.end, sums)) return false;
      }
    }
    return true;
  }

  /// The piece of the tape that instant k belongs to, where gains change.
  TapePiece<N>& open_piece(Eigen::Index k) {
    if (tape_->count > 0) {
      TapePiece<N>& last = tape_->pieces[tape_->count - 1];
      if (last.steady < 0 && k < last.begin + Tape<N>::kPieceSamples) return last;
    }
    const Eigen::Index samples = std::min(Tape<N>::kPieceSamples, record_.samples - k);
    TapePiece<N>& piece = tape_->add(k, Tape<N>::kEntry * record_.ny * samples, -1, state_);
    numbers_ = piece.numbers.size() > 0 ? piece.numbers.data() : nullptr;
    return piece;
  }

  /// @param numbers  where to write what the adjoint pass needs, moved on; may be null
  bool run_samples(Eigen::Index k, Eigen::Index stop, LikelihoodSums<N>& sums, double*& numbers) {
    for (; k < stop; ++k) {
      if (!correct(k, sums, numbers)) return false;
      if (trace_ != nullptr) trace_state(k);
      if (k + 1 < record_.samples) predict(k);
    }
    return true;
  }

  /// The measurements of instant k, one by one.
  bool correct(Eigen::Index k, LikelihoodSums<N>& sums, double*& numbers) {
    const double* y = record_.y + k * record_.ny;
    for (Eigen::Index i = 0; i < record_.ny; ++i) {
      if (std::isnan(y[i])) continue;
      const SparseRow<N> c = row(k, i);
      const double z = model_.measurement(i, y, record_.u + k * record_.nu, whitened_);
      const double e = z - c.dot(state_.x.at);  // e = z - c x
      const Column<N> Pc = c.times(state_.P);   // P cᵀ
      const double R = model_.R[static_cast<std::size_t>(i)];
      const double S = c.dot(Pc.at, R);  // S = R + c P cᵀ
      if (sensitivities_ != nullptr) {
        sensitivities_->whiten(i, model_.L, whitened_);
        sensitivities_->linearize(i, c, state_, Pc);
      }
      if (state_.diffuse_rank > 0 && diffuse_update(c, e, S, Pc, sums, numbers)) continue;
      if (!(S > 0)) {
        sums.bad_sample = k;
        sums.bad_output = i;
        return false;
      }
      if (trace_ != nullptr && !trace_measurement(k, i, e, S)) continue;
      sums.logs.add(S);
      ++sums.used;
      if (!model_.student.empty() && model_.student[static_cast<std::size_t>(i)] > 0) {
        student_update(i, c, e, S, Pc, sums);
        continue;
      }
      const double inverse = 1 / S;
      sums.squares += e * e * inverse;
      if (sensitivities_ != nullptr) sensitivities_->add_measurement(e, S, 1);
      update(c, e, R, inverse, Pc, numbers);
    }
    return true;
  }

  /// x ← x + K e, P ← (I - K c) P (I - K c)ᵀ + K R Kᵀ, K = P cᵀ/S
  /// @param inverse  1/S
  void update(const SparseRow<N>& c, double e, double R, double inverse, const Column<N>& Pc,
              double*& numbers) {
    Column<N> K;
    add_scaled<N>(inverse, Pc.at, K.at);
    if (sensitivities_ != nullptr) sensitivities_->correct(K, e * inverse);
    add_scaled<N>(e, K.at, state_.x.at);
    add_outer<N>(-1, K.at, Pc.at, state_.P);  // P - K (P cᵀ)ᵀ
    if (R * inverse < kLeastShareOfR) {       // Joseph's form: + (K R - P cᵀ) Kᵀ of this P
      Column<N> rest = c.times(state_.P);
      for (double& entry : rest.at) entry = -entry;
      add_scaled<N>(R, K.at, rest.at);
      add_outer<N>(1, rest.at, K.at, state_.P);
    }
    write(K, inverse, e * inverse, numbers);
  }

  static void write(const Column<N>& K, double precision, double weighted, double*& numbers) {
    if (numbers == nullptr) return;
    std::copy_n(K.at, N, numbers);
    numbers[N] = precision;
    numbers[N + 1] = weighted;
    numbers += Tape<N>::kEntry;
  }

  /// Student's density of an innovation of scale S, with ν degrees of freedom. The measurement
  /// corrects the state as a normal one of variance R/w, w = (ν + 1) / (ν + e²/S).
  void student_update(Eigen::Index i, const SparseRow<N>& c, double e, double S,
                      const Column<N>& Pc, LikelihoodSums<N>& sums) {
    const double nu = model_.student[static_cast<std::size_t>(i)];
    const double R = model_.R[static_cast<std::size_t>(i)], square = e * e / S;
    const double weight = (nu + 1) / (nu + square);
    sums.squares += (nu + 1) * std::log(1 + square / nu);
    sums.constants += std::log(nu / 2) + 2 * (std::lgamma(nu / 2) - std::lgamma(nu / 2 + 0.5));
    if (sensitivities_ != nullptr) {
      sensitivities_->add_measurement(e, S, weight);
      sensitivities_->reweight(i, R, weight, nu);
    }
    double* no_tape = nullptr;
    update(c, e, R / weight, 1 / (S - R + R / weight), Pc, no_tape);
  }

  /// A measurement that sees a state of which nothing is known yet: with F = c P_diffuse cᵀ > 0 the
  /// gain is K = P_diffuse cᵀ/F (Koopman and Durbin 2000). K does not depend on θ: L⁻¹ C adds to
  /// a row of C only rows before it, which have been taken out of P_diffuse.
  /// @return  false if it sees none: then it is an ordinary measurement.
  bool diffuse_update(const SparseRow<N>& c, double e, double S, const Column<N>& Pc,
                      LikelihoodSums<N>& sums, double*& numbers) {
    const Column<N> diffuse_Pc = c.times(state_.P_diffuse);
    const double F = c.dot(diffuse_Pc.at);
    double scale = 0;
    for (std::size_t q = 0; q < c.size; ++q)
      for (std::size_t r = 0; r < c.size; ++r)
        scale += std::abs(c.value[q] * c.value[r] * state_.P_diffuse(c.column[q], c.column[r]));
    if (!(F > 1e-8 * scale)) return false;
    Column<N> K;
    add_scaled<N>(1 / F, diffuse_Pc.at, K.at);
    sums.logs.add(F);
    ++sums.diffuse;
    if (sensitivities_ != nullptr) sensitivities_->correct(K, 0);
    add_scaled<N>(e, K.at, state_.x.at);
    add_outer<N>(-1, K.at, diffuse_Pc.at, state_.P_diffuse);
    if (--state_.diffuse_rank == 0) state_.P_diffuse = Square<N>();
    // (I - K c) P (I - K c)ᵀ + K R Kᵀ = P + K hᵀ + h Kᵀ, h = ½ S K - P cᵀ
    Column<N> h;
    add_scaled<N>(0.5 * S, K.at, h.at);
    add_scaled<N>(-1, Pc.at, h.at);
    add_outer<N>(1, K.at, h.at, state_.P);
    add_outer<N>(1, h.at, K.at, state_.P);
    write(K, 0, 0, numbers);
    return true;
  }

  /// x ← F x + B u, P ← F P Fᵀ + Q
  void predict(Eigen::Index k) {
    if (instants_ != nullptr) return predict_linearized(static_cast<std::size_t>(k));
    const Transition<N>& step = model_.transitions[record_.transition[k]];
    Column<N> x;
    multiply<N>(step.F, state_.x.at, x.at);
    const double* u = record_.u + k * record_.nu;
    for (std::size_t j = 0; j < step.B.size(); ++j) add_scaled<N>(u[j], step.B[j].at, x.at);
    state_.x = x;
    propagate<N>(step.F, state_.P, &step.Q);
    if (state_.diffuse_rank > 0) propagate<N>(step.F, state_.P_diffuse, nullptr);
    if (sensitivities_ != nullptr) sensitivities_->predict(step.F, record_.transition[k]);
  }

  /// x ← F x + offset, P ← F P Fᵀ + Σ factor noise
  void predict_linearized(std::size_t k) {
    const Square<N>& F = instants_->F[k];
    Column<N> x;
    multiply<N>(F, state_.x.at, x.at);
    add_scaled<N>(1, instants_->offset[k].at, x.at);
    state_.x = x;
    propagate<N>(F, state_.P, nullptr);
    if (state_.diffuse_rank > 0) propagate<N>(F, state_.P_diffuse, nullptr);
    if (sensitivities_ != nullptr) sensitivities_->predict(F, -1);
    instants_->each_noise(k, [&](std::size_t t, const SymmetricEntry& entry) {
      state_.P.add_symmetric(entry.row, entry.column, model_.factors[t] * entry.value);
      if (sensitivities_ != nullptr) sensitivities_->add_noise(t, entry);
    });
  }

  // --- steady gains ---

  /// Whole blocks of the rest of a segment with the gains of the present P; moves k on.
  bool hold_gains(Eigen::Index& k, Eigen::Index end, LikelihoodSums<N>& sums) {
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
    for (end = k + steady.samples; k < end;) {
      options_.ask();
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
        run_steady(steady, k, stop, sums, numbers);
      k = stop;
    }
    return true;
  }

  /// K, S and their derivatives, by the corrections of one instant, which are then undone.
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

  /// @param numbers  where to write the normalized innovations; may be null
  void run_steady(const SteadyState<N>& steady, Eigen::Index k, Eigen::Index stop,
                  LikelihoodSums<N>& sums, double* numbers) {
    steady.with_sizes([&](auto y_size, auto u_size) {
      run_steady<y_size(), u_size()>(steady, k, stop, sums, numbers);
    });
  }
  template <int y_size, int u_size>
  void run_steady(const SteadyState<N>& steady, Eigen::Index k, Eigen::Index stop,
                  LikelihoodSums<N>& sums, double* numbers) {
    const Eigen::Index e_rows = steady.innovation_rows();
    const Eigen::Index rows = y_size == 4 ? 8 : steady.rows(N);
    alignas(64) double out[2][kMostOutputs + (N + 15) / 8 * 8];
    Vector<4> squares[kMostOutputs / 4] = {};
    const double* x = state_.x.at;
    int side = 0;
    for (; k < stop; k += steady.block, side = 1 - side) {
      const Input<y_size> y = {record_.y + k * record_.ny, steady.block * record_.ny};
      const Input<u_size> u = {record_.u + k * record_.nu, steady.block * record_.nu};
      multiply(steady.forward.data(), rows, out[side], y, u, Input<N>{x});
      x = out[side] + e_rows;
      for (Eigen::Index i = 0; i < e_rows; i += 4) {
        const Vector<4> e = lanes<4>(out[side] + i)->v;
        squares[i / 4] += e * e;
        if (numbers != nullptr) lanes<4>(numbers + i)->v = e;
      }
      if (numbers != nullptr) numbers += e_rows;
    }
    for (const Vector<4>& square : squares)
      for (int i = 0; i < 4; ++i) sums.squares += square[i];
    if (x != state_.x.at) std::copy_n(x, N, state_.x.at);
  }

  /// The same with e'/√S, whose products make up gradient and information.
  template <int y_size, int u_size>
  void run_steady_sensitivities(const SteadyState<N>& steady, Eigen::Index k, Eigen::Index stop,
                                LikelihoodSums<N>& sums) {
    const auto p = static_cast<Eigen::Index>(sensitivities_->slopes.size());
    const Eigen::Index e_rows = steady.innovation_rows();
    const Eigen::Index rows = y_size == 4 ? 8 : steady.rows(N);
    const auto samples = static_cast<double>(stop - k);
    // Columns: of each parameter, and the run itself.
    Eigen::MatrixXd now = Eigen::MatrixXd::Zero(rows, p + 1), next = now;
    std::copy_n(state_.x.at, N, now.col(p).data() + e_rows);
    for (Eigen::Index a = 0; a < p; ++a)
      std::copy_n(sensitivities_->slopes[static_cast<std::size_t>(a)].x.at, N,
                  now.col(a).data() + e_rows);
    Eigen::Matrix4Xd products = Eigen::Matrix4Xd::Zero(4, p * (p + 3) / 2);  // one a pair
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

  /// What S' adds to gradient, -½ Σ (1 - ē²) S'/S, and information, ½ Σ (S'/S)(S'/S)ᵀ.
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

  // --- trace ---

  /// @return  false if the gate refuses the measurement
  [[nodiscard]] bool trace_measurement(Eigen::Index k, Eigen::Index i, double e, double S) const {
    (*trace_->variance)(i, k) = S;
    const bool refused = e * e > model_.gate[static_cast<std::size_t>(i)] * S;
    if (refused)
      (*trace_->refused)(i, k) = 1;
    else
      (*trace_->innovation)(i, k) = e;
    return !refused;
  }

  void trace_state(Eigen::Index k) const {
    if (state_.diffuse_rank > 0) return;
    for (Eigen::Index i = 0; i < trace_->x->rows(); ++i) {
      (*trace_->x)(i, k) = state_.x.at[i];
      (*trace_->x_variance)(i, k) = state_.P(i, i);
    }
  }

  const EngineModel<N>& model_;
  const KernelRecord& record_;
  const LinearizedInstants<N>* instants_;
  const RunOptions& options_;
  Tape<N>* tape_;
  Sensitivities<N>* sensitivities_;
  const RunTrace* trace_;
  FilterState<N> state_;
  double* numbers_ = nullptr;  ///< of the open piece of the tape
  double whitened_[kMostOutputs] = {};
};

}  // namespace quadtune::internal
