// SPDX-License-Identifier: Apache-2.0
/// The Kalman filter of many states in plain numbers, and the way back through it that gives the
/// likelihood's derivatives by all covariances at once, whatever the number of parameters.
#pragma once

#include <algorithm>
#include <cmath>

#include "noise/dense/dense_model.hpp"
#include "noise/dense/dense_tangents.hpp"
#include "noise/dense/steady_information.hpp"
#include "noise/likelihood/convergence.hpp"

namespace quadtune::internal {

/// One record. Where measurements are uncorrelated and normal.
///
/// The way back is the adjoint of the filter: with r = ∂ log p/∂x and ½ (r rᵀ - N) = ∂ log p/∂P of
/// a prediction, a measurement with gain K, innovation e of variance S and row c makes of them
///     u = e/S - K·r,  D = 1/S + K·N K,  r ← r + cᵀ u,
///     N ← (I - K c)ᵀ N (I - K c) + cᵀ c/S,  ∂ log p/∂R = ½ (u² - D),
/// and a step of time ∂ log p/∂Q = ½ (r rᵀ - N), r ← Fᵀ r, N ← Fᵀ N F (Koopman and Shephard 1992).
template <int N>
class DenseFilter {
 public:
  /// @param instants  of a linearized record; else null
  DenseFilter(const DenseModel<N>& model, const KernelRecord& record,
              const DenseInstants<N>* instants, const RunOptions& how, DenseWorkspace<N>& workspace)
      : model_(model), record_(record), instants_(instants), how_(how), work_(workspace) {}

  /// @param slopes    whether sums.by_… are added to.
  /// @param tangents  of a linearized record, taken along where not null
  /// @return          false where an innovation has no positive variance; see sums.
  /// @throws Interrupted  where the options say so
  bool run(DenseSums<N>& sums, bool slopes, DenseTangents<N>* tangents = nullptr) {
    start();
    slopes_ = slopes;
    tangents_ = tangents;
    if (tangents != nullptr) tangents->start();
    work_.piece_count = 0;
    work_.steady.clear();
    tape_ = nullptr;
    tape_left_ = kMostTape;
    for (std::size_t s = 0; s < record_.segment_count; ++s)
      if (!go(record_.segments[s], sums)) return false;
    if (slopes) go_back(sums);
    return true;
  }

 private:
  static constexpr Eigen::Index kEvery = Convergence::kEvery;
  static constexpr Eigen::Index kPiece = 1024;
  static constexpr Eigen::Index kEntry = N + 4;  ///< numbers on the tape of one measurement
  static constexpr int kAtOnce = 4;              ///< steps back of steady gains
  /// Numbers that all tapes may have; what has none goes through its stretch twice.
  static constexpr Eigen::Index kMostTape = Eigen::Index{1} << 23;

  struct Settling {
    Square<N> before;
    bool known = false;
    Convergence convergence;

    bool settled(const Square<N>& P) {
      double greatest = 0;
      for (int j = 0; known && j < N; ++j)
        for (int i = j; i < N; ++i) {
          const double moved = std::abs(P(i, j) - before(i, j));
          if (moved > 0) greatest = std::max(greatest, moved / std::sqrt(P(i, i) * P(j, j)));
        }
      const bool is = known && convergence.reached(greatest);
      before = P;
      known = true;
      return is;
    }
  };

  // --- forth ---

  void start() {
    at_ = DenseState<N>();
    const Eigen::VectorXd& x0 = record_.start != nullptr ? record_.start->x : model_.x0;
    const Eigen::MatrixXd& P0 = record_.start != nullptr ? record_.start->P : model_.P0;
    for (Eigen::Index j = 0; j < x0.size(); ++j) {
      at_.x.at[j] = x0(j);
      for (Eigen::Index i = 0; i < x0.size(); ++i)
        at_.P(static_cast<int>(i), static_cast<int>(j)) = P0(i, j);
      if (record_.start == nullptr && model_.diffuse[static_cast<std::size_t>(j)]) {
        at_.diffuse_P(static_cast<int>(j), static_cast<int>(j)) = 1;
        ++at_.rank;
      }
    }
  }

  bool go(const KernelSegment& segment, DenseSums<N>& sums) {
    const bool may_settle =
        how_.hold_steady_gains && segment.complete && segment.end - segment.begin > 2 * kEvery;
    Settling settling;
    for (Eigen::Index k = segment.begin; k < segment.end;) {
      if ((k - segment.begin) % RunOptions::kEvery < kEvery) how_.ask();
      Eigen::Index stop = std::min(k + kEvery, segment.end);
      if (slopes_) {
        DensePiece<N>& piece = open_piece(k);
        stop = std::min(stop, piece.begin + kPiece);
        piece.end = stop;
      }
      if (!steps(k, stop, sums, tape_)) return false;
      k = stop;
      if (may_settle && k < segment.end && (k - segment.begin) % kEvery == 0 && at_.rank == 0 &&
          settling.settled(at_.P))
        return hold(k, segment.end, sums);
    }
    return true;
  }

  /// The piece that instant k belongs to, where gains change.
  DensePiece<N>& open_piece(Eigen::Index k) {
    if (work_.piece_count > 0) {
      DensePiece<N>& last = work_.pieces[work_.piece_count - 1];
      if (last.steady < 0 && k < last.begin + kPiece) return last;
    }
    DensePiece<N>& piece =
        add_piece(k, kEntry * record_.ny * std::min(kPiece, record_.samples - k));
    tape_ = piece.tape.size() > 0 ? piece.tape.data() : nullptr;
    return piece;
  }

  DensePiece<N>& add_piece(Eigen::Index begin, Eigen::Index tape) {
    if (work_.piece_count == work_.pieces.size()) work_.pieces.emplace_back();
    DensePiece<N>& piece = work_.pieces[work_.piece_count++];
    piece.begin = begin;
    piece.steady = -1;
    piece.start = at_;
    piece.tape.resize(tape <= tape_left_ ? tape : 0);
    tape_left_ -= piece.tape.size();
    return piece;
  }

  /// @param tape  where to write what the way back needs, moved on; null: nowhere.
  bool steps(Eigen::Index k, Eigen::Index stop, DenseSums<N>& sums, double*& tape) {
    for (; k < stop; ++k) {
      if (!correct(k, sums, tape)) return false;
      if (k + 1 < record_.samples) predict(k);
    }
    return true;
  }

  [[nodiscard]] SparseRow row_of(Eigen::Index k, Eigen::Index i) const {
    if (instants_ == nullptr) return model_.C[static_cast<std::size_t>(i)];
    return instants_->C[static_cast<std::size_t>(k * record_.ny + i)];
  }

  /// Row i of the measurements of instant k, less what the inputs say.
  [[nodiscard]] double measured(Eigen::Index k, Eigen::Index i) const {
    double value = record_.y[k * record_.ny + i];
    if (model_.D.size() > 0)
      for (Eigen::Index j = 0; j < record_.nu; ++j)
        value -= model_.D(i, j) * record_.u[k * record_.nu + j];
    return value;
  }

  static double product(const SparseRow& c, const double* x) {
    double sum = 0;
    for (std::size_t q = 0; q < c.size; ++q) sum += c.value[q] * x[c.column[q]];
    return sum;
  }
  static void product(const Square<N>& P, const SparseRow& c, double* result) {
    for (int i = 0; i < N; ++i) result[i] = 0;
    for (std::size_t q = 0; q < c.size; ++q)
      add_scaled<N>(c.value[q], P.column(c.column[q]), result);
  }

  bool correct(Eigen::Index k, DenseSums<N>& sums, double*& tape) {
    for (Eigen::Index i = 0; i < record_.ny; ++i) {
      const double y = record_.y[k * record_.ny + i];
      if (y != y) continue;
      const SparseRow c = row_of(k, i);
      const double R = model_.R[static_cast<std::size_t>(i)];
      const double e = measured(k, i) - product(c, at_.x.at);
      Column<N> PC, K;
      if (at_.rank > 0 && take_up(c, e, R, sums, K)) {
        write(K, 0, 0, tape);
        continue;
      }
      product(at_.P, c, PC.at);
      const double S = R + product(c, PC.at);
      if (!(S > 0)) {
        sums.bad_sample = k;
        sums.bad_output = i;
        return false;
      }
      const double inverse = 1 / S;
      sums.logs.add(S);
      sums.squares += e * e * inverse;
      ++sums.used;
      add_scaled<N>(inverse, PC.at, K.at);
      if (tangents_ != nullptr) tangents_->correct(i, c, K.at, inverse, e);
      add_scaled<N>(e, K.at, at_.x.at);
      add_outer(-1, K.at, PC.at, at_.P);
      if (R < kLeastShareOfR * S) {  // the rest of Joseph's form
        product(at_.P, c, PC.at);
        Column<N> rest;
        add_scaled<N>(R, K.at, rest.at);
        add_scaled<N>(-1, PC.at, rest.at);
        add_outer(1, rest.at, K.at, at_.P);
      }
      write(K, inverse, e * inverse, tape);
    }
    return true;
  }

  static void write(const Column<N>& K, double precision, double weighed, double*& tape) {
    if (tape == nullptr) return;
    std::copy_n(K.at, N, tape);
    tape[N] = precision;
    tape[N + 1] = weighed;
    tape += kEntry;
  }

  /// A measurement that sees a state of which nothing is known yet: LikelihoodKernel::take_up().
  bool take_up(const SparseRow& c, double e, double R, DenseSums<N>& sums, Column<N>& K) {
    Column<N> PC;
    product(at_.diffuse_P, c, PC.at);
    const double F = product(c, PC.at);
    double scale = 0;
    for (std::size_t q = 0; q < c.size; ++q)
      for (std::size_t r = 0; r < c.size; ++r)
        scale += std::abs(c.value[q] * c.value[r] * at_.diffuse_P(c.column[q], c.column[r]));
    if (!(F > 1e-8 * scale)) return false;
    add_scaled<N>(1 / F, PC.at, K.at);
    sums.logs.add(F);
    ++sums.diffuse;
    add_scaled<N>(e, K.at, at_.x.at);
    add_outer(-1, K.at, PC.at, at_.diffuse_P);
    if (--at_.rank == 0) at_.diffuse_P = Square<N>();
    // (I - K c) P (I - K c)ᵀ + K R Kᵀ = P - K (P c)ᵀ - (P c) Kᵀ + K (c·P c + R) Kᵀ
    product(at_.P, c, PC.at);
    const double inside = product(c, PC.at) + R;
    Column<N> half;
    add_scaled<N>(0.5 * inside, K.at, half.at);
    add_scaled<N>(-1, PC.at, half.at);
    add_outer(1, K.at, half.at, at_.P);
    add_outer(1, half.at, K.at, at_.P);
    return true;
  }

  void predict(Eigen::Index k) {
    if (instants_ != nullptr) {
      predict_linearized(static_cast<std::size_t>(k));
      return;
    }
    const DenseTransition<N>& step = model_.transitions[record_.transition[k]];
    Column<N> x;
    multiply<N>(step.F.at, at_.x.at, N, x.at);
    add_inputs(step, k, x.at);
    at_.x = x;
    propagate<N>(step.F, at_.P, &step.Q);
    if (at_.rank > 0) propagate<N>(step.F, at_.diffuse_P, nullptr);
  }

  /// A linearized record's start is known: nothing is diffuse.
  void predict_linearized(std::size_t k) {
    const Square<N>& F = instants_->F[k];
    Column<N> x;
    multiply<N>(F.at, at_.x.at, N, x.at);
    add_scaled<N>(1, instants_->offset[k].at, x.at);
    at_.x = x;
    propagate<N>(F, at_.P, nullptr);
    if (tangents_ != nullptr) tangents_->predict(F);
    instants_->each_noise(k, [&](std::size_t t, const SymmetricEntry& entry) {
      const double part = model_.variances[t] * entry.value;
      at_.P.add_symmetric(entry.row, entry.column, part);
      if (tangents_ != nullptr) tangents_->add_noise(t, entry.row, entry.column, part);
    });
  }

  void add_inputs(const DenseTransition<N>& step, Eigen::Index k, double* x) const {
    for (Eigen::Index j = 0; j < record_.nu; ++j)
      add_scaled<N>(record_.u[k * record_.nu + j], step.B.col(j).data(), x);
  }

  // --- settled ---

  /// The rest of a segment with the gains of the present P.
  bool hold(Eigen::Index k, Eigen::Index end, DenseSums<N>& sums) {
    SteadyGains<N>& gains = work_.steady.emplace_back();
    gains.transition = record_.transition[k];
    gains.samples = end - k;
    const auto ny = static_cast<std::size_t>(record_.ny);
    const Square<N> P = at_.P;
    for (std::size_t i = 0; i < ny; ++i) {
      const SparseRow c = model_.C[i];
      Column<N> PC, K;
      product(at_.P, c, PC.at);
      const double S = model_.R[i] + product(c, PC.at);
      if (!(S > 0)) {
        sums.bad_sample = k;
        sums.bad_output = static_cast<Eigen::Index>(i);
        return false;
      }
      add_scaled<N>(1 / S, PC.at, K.at);
      add_outer(-1, K.at, PC.at, at_.P);
      gains.gain.push_back(K);
      gains.variance.push_back(S);
      sums.logs.add(S, end - k);
    }
    at_.P = P;
    fill_steady(gains);
    sums.used += record_.ny * (end - k);
    const Eigen::Index padded = gains.precision.size();
    while (k < end) {
      how_.ask();
      const Eigen::Index stop = slopes_ ? std::min(k + kPiece, end) : end;
      double* tape = nullptr;
      if (slopes_) {
        DensePiece<N>& piece = add_piece(k, padded * (stop - k));
        piece.end = stop;
        piece.steady = static_cast<int>(work_.steady.size()) - 1;
        if (piece.tape.size() > 0) tape = piece.tape.data();
      }
      steady_steps(gains, k, stop, sums, tape);
      k = stop;
    }
    return true;
  }

  /// Columns of the steady matrices: what one unit of each state and measurement does.
  void fill_steady(SteadyGains<N>& gains) const {
    const DenseTransition<N>& step = model_.transitions[gains.transition];
    const Eigen::Index ny = record_.ny, padded = (ny + 3) / 4 * 4;
    gains.precision.setZero(padded);
    for (Eigen::Index i = 0; i < ny; ++i)
      gains.precision(i) = 1 / gains.variance[static_cast<std::size_t>(i)];
    gains.next.setZero(N, N + ny);
    gains.innovations.setZero(padded, N + ny);
    gains.before.setZero(N, N + ny);
    gains.weights.setZero(padded, N + ny);
    for (Eigen::Index column = 0; column < N + ny; ++column) {
      Column<N> x, r;
      if (column < N) x.at[column] = r.at[column] = 1;
      for (Eigen::Index i = 0; i < ny; ++i) {
        const auto q = static_cast<std::size_t>(i);
        const double e = (column == N + i ? 1 : 0) - product(model_.C[q], x.at);
        gains.innovations(i, column) = e;
        add_scaled<N>(e, gains.gain[q].at, x.at);
      }
      multiply<N>(step.F.at, x.at, N, gains.next.col(column).data());
      Column<N> before;
      multiply<N>(step.F_transposed.at, r.at, N, before.at);
      for (Eigen::Index i = ny - 1; i >= 0; --i) {
        const auto q = static_cast<std::size_t>(i);
        const double u = (column == N + i ? 1 : 0) - dot<N>(gains.gain[q].at, before.at);
        gains.weights(i, column) = u;
        add_row(model_.C[q], u, before.at);
      }
      std::copy_n(before.at, N, gains.before.col(column).data());
    }
  }

  void steady_steps(const SteadyGains<N>& gains, Eigen::Index k, Eigen::Index end,
                    DenseSums<N>& sums, double* tape) {
    const DenseTransition<N>& step = model_.transitions[gains.transition];
    const auto padded = static_cast<int>(gains.precision.size());
    const auto columns = static_cast<int>(N + record_.ny);
    alignas(64) double known[N + kMostOutputs] = {}, e[kMostOutputs] = {}, sum[kMostOutputs] = {};
    std::copy_n(at_.x.at, N, known);
    for (; k < end; ++k) {
      for (Eigen::Index i = 0; i < record_.ny; ++i) known[N + i] = measured(k, i);
      multiply(gains.innovations.data(), padded, known, columns, e);
      Column<N> next;
      multiply<N>(gains.next.data(), known, columns, next.at);
      add_inputs(step, k, next.at);
      std::copy_n(next.at, N, known);
      for (int i = 0; i < padded; i += 4) {
        const Four weighed = *fours(e + i) * *fours(gains.precision.data() + i);
        *fours(sum + i) += *fours(e + i) * weighed;
        if (tape != nullptr) *fours(tape + i) = weighed;
      }
      if (tape != nullptr) tape += padded;
    }
    for (const double square : sum) sums.squares += square;
    std::copy_n(known, N, at_.x.at);
  }

  // --- back ---

  static void add_row(const SparseRow& c, double factor, double* r) {
    for (std::size_t q = 0; q < c.size; ++q) r[c.column[q]] += c.value[q] * factor;
  }

  void go_back(DenseSums<N>& sums) {
    r_ = Column<N>();
    N_ = Square<N>();
    held_ = -1;
    DenseSums<N> again;  // counted already
    for (std::size_t p = work_.piece_count; p-- > 0;) {
      how_.ask();
      DensePiece<N>& piece = work_.pieces[p];
      const Eigen::VectorXd* tape = &piece.tape;
      if (tape->size() == 0) {
        at_ = piece.start;
        tape = &work_.scratch_tape;
        work_.scratch_tape.resize((piece.end - piece.begin) * kEntry * record_.ny);
        double* to = work_.scratch_tape.data();
        if (piece.steady < 0)
          steps(piece.begin, piece.end, again, to);
        else
          steady_steps(work_.steady[static_cast<std::size_t>(piece.steady)], piece.begin, piece.end,
                       again, to);
      }
      if (piece.steady < 0)
        steps_back(piece, tape->data(), sums);
      else
        steady_back(piece, tape->data(), sums);
    }
  }

  void steps_back(const DensePiece<N>& piece, const double* tape, DenseSums<N>& sums) {
    held_ = -1;
    // Missing measurements leave the tape shorter than it might be.
    for (Eigen::Index j = piece.begin * record_.ny; j < piece.end * record_.ny; ++j)
      if (record_.y[j] == record_.y[j]) tape += kEntry;
    for (Eigen::Index k = piece.end; k-- > piece.begin;) {
      predict_back(k, sums);
      for (Eigen::Index i = record_.ny; i-- > 0;) {
        if (record_.y[k * record_.ny + i] != record_.y[k * record_.ny + i]) continue;
        tape -= kEntry;
        correct_back(row_of(k, i), tape, tape[N], tape[N + 1],
                     sums.by_R[static_cast<std::size_t>(i)]);
      }
    }
  }

  void predict_back(Eigen::Index k, DenseSums<N>& sums) {
    if (k + 1 >= record_.samples) return;
    if (instants_ == nullptr) {
      add_slope(sums.by_Q[record_.transition[k]]);
      predict_back(model_.transitions[record_.transition[k]].F_transposed);
      return;
    }
    instants_->each_noise(static_cast<std::size_t>(k), [&](std::size_t t, const auto& entry) {
      const double share = entry.row == entry.column ? 0.5 : 1;
      sums.by_variances[t] +=
          share * entry.value *
          (r_.at[entry.row] * r_.at[entry.column] - N_(entry.row, entry.column));
    });
    transpose<N>(instants_->F[static_cast<std::size_t>(k)], F_transposed_);
    predict_back(F_transposed_);
  }
  void predict_back(const Square<N>& F_transposed) {
    Column<N> r;
    multiply<N>(F_transposed.at, r_.at, N, r.at);
    r_ = r;
    propagate<N>(F_transposed, N_, nullptr);
  }

  /// ½ (r rᵀ - N)
  void add_slope(Square<N>& by_Q) const {
    for (int j = 0; j < N; ++j) {
      const Four factor = all_four(0.5 * r_.at[j]), half = all_four(0.5);
      for (int i = 0; i < N / 4; ++i)
        fours(by_Q.column(j))[i] += factor * fours(r_.at)[i] - half * fours(N_.column(j))[i];
    }
  }

  void correct_back(const SparseRow& c, const double* K, double precision, double weighed,
                    double& by_R) {
    const double u = weighed - dot<N>(K, r_.at);
    by_R += 0.5 * (u * u - inform(c, K, precision));
    add_row(c, u, r_.at);
  }

  /// N before a measurement.
  /// @return  D
  double inform(const SparseRow& c, const double* K, double precision) {
    Column<N> NK;
    multiply<N>(N_.at, K, N, NK.at);
    const double D = precision + dot<N>(K, NK.at);
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

  void steady_back(const DensePiece<N>& piece, const double* tape, DenseSums<N>& sums) {
    const SteadyGains<N>& gains = work_.steady[static_cast<std::size_t>(piece.steady)];
    if (held_ != piece.steady) take_information_back(gains, sums);
    held_ = piece.steady;
    take_steps_back(gains, piece.end - piece.begin, tape, sums);
  }

  /// N through the whole of a stretch, and what its steps say of Q and R.
  void take_information_back(const SteadyGains<N>& gains, DenseSums<N>& sums) {
    const DenseTransition<N>& step = model_.transitions[gains.transition];
    const Square<N> start = N_;
    N_ = Square<N>();
    for (Eigen::Index i = record_.ny; i-- > 0;) inform(gains, i);
    const SteadyInformation<N> information =
        steady_information<N>(gains.before.data(), N_, start, gains.samples);
    const auto samples = static_cast<double>(gains.samples);
    for (int j = 0; j < N; ++j)
      add_scaled<N>(-0.5, information.sum.column(j), sums.by_Q[gains.transition].column(j));
    // D is linear in N: its sum is of the mean.
    N_ = Square<N>();
    for (int j = 0; j < N; ++j) add_scaled<N>(1 / samples, information.sum.column(j), N_.column(j));
    propagate<N>(step.F_transposed, N_, nullptr);
    for (Eigen::Index i = record_.ny; i-- > 0;)
      sums.by_R[static_cast<std::size_t>(i)] -= 0.5 * samples * inform(gains, i);
    N_ = information.last;
  }
  double inform(const SteadyGains<N>& gains, Eigen::Index i) {
    const auto q = static_cast<std::size_t>(i);
    return inform(model_.C[q], gains.gain[q].at, gains.precision(i));
  }

  /// r through a piece of it.
  void take_steps_back(const SteadyGains<N>& gains, Eigen::Index left, const double* tape,
                       DenseSums<N>& sums) {
    const Eigen::Index padded = gains.precision.size();
    alignas(64) double squares[kMostOutputs] = {};
    Square<N>& by_Q = sums.by_Q[gains.transition];
    for (; left >= kAtOnce; left -= kAtOnce)
      steady_steps_back<kAtOnce>(gains, tape + (left - kAtOnce) * padded, by_Q, squares);
    for (; left > 0; --left) steady_steps_back<1>(gains, tape + (left - 1) * padded, by_Q, squares);
    for (std::size_t i = 0; i < sums.by_R.size(); ++i) sums.by_R[i] += 0.5 * squares[i];
  }

  /// `count` samples, whose tape starts at `tape`: only r itself has to be gone through one by one,
  /// all else that is made of it shares what it loads.
  template <int count>
  void steady_steps_back(const SteadyGains<N>& gains, const double* tape, Square<N>& by_Q,
                         double* squares) {
    const auto padded = static_cast<int>(gains.precision.size());
    const auto ny = static_cast<int>(record_.ny);
    alignas(64) double known[count][N + kMostOutputs], pushed[count][N], u[count][kMostOutputs];
    for (std::ptrdiff_t q = 0; q < count; ++q)
      for (int i = 0; i < padded; i += 4)
        *fours(known[q] + N + i) = *fours(tape + (count - 1 - q) * padded + i);
    multiply_each<N, count>(gains.before.data() + N * N, N, known[0] + N, N + kMostOutputs, ny,
                            pushed[0], N);
    std::copy_n(r_.at, N, known[0]);
    for (int q = 0; q + 1 < count; ++q)
      multiply_onto<N>(gains.before.data(), known[q], pushed[q], known[q + 1]);
    multiply_onto<N>(gains.before.data(), known[count - 1], pushed[count - 1], r_.at);
    int row = 0;
    for (; row + 8 <= padded; row += 8)
      multiply_each_of_eight<count>(gains.weights.data() + row, padded, known[0], N + kMostOutputs,
                                    N + ny, u[0] + row, kMostOutputs);
    if (row < padded)
      multiply_each<4, count>(gains.weights.data() + row, padded, known[0], N + kMostOutputs,
                              N + ny, u[0] + row, kMostOutputs);
    for (int i = 0; i < padded; i += 4)
      for (int q = 0; q < count; ++q) *fours(squares + i) += *fours(u[q] + i) * *fours(u[q] + i);
    for (const NoiseEntries& entries : model_.noise_entries) {
      Four sum{};
      for (int q = 0; q < count; ++q)
        sum += all_four(known[q][entries.column]) * *fours(known[q] + entries.row);
      *fours(by_Q.column(entries.column) + entries.row) += all_four(0.5) * sum;
    }
  }

  const DenseModel<N>& model_;
  const KernelRecord& record_;
  const DenseInstants<N>* instants_;
  const RunOptions& how_;
  DenseWorkspace<N>& work_;
  DenseTangents<N>* tangents_ = nullptr;
  bool slopes_ = false;
  Eigen::Index tape_left_ = 0;
  double* tape_ = nullptr;  ///< of the open piece
  DenseState<N> at_;
  // On the way back.
  Column<N> r_;
  Square<N> N_, F_transposed_;
  int held_ = -1;  ///< index of the steady gains that N has been taken through
};

}  // namespace quadtune::internal
