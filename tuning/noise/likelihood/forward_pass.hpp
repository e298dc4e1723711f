// SPDX-License-Identifier: Apache-2.0
/// The Kalman filter over one record: likelihood, sensitivities, a trace, and the tape of the
/// adjoint pass.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "noise/likelihood/convergence.hpp"
#include "noise/likelihood/engine_model.hpp"
#include "noise/likelihood/sensitivities.hpp"
#include "noise/likelihood/steady_pass.hpp"
#include "noise/likelihood/steady_state.hpp"
#include "noise/likelihood/tape.hpp"
#include "noise/log_gamma.hpp"

namespace quadtune::internal {

template <int N>
class ForwardPass {
 public:
  /// Optional outputs of a run in addition to the likelihood; any may be null. A tape requires
  /// uncorrelated and normal measurements.
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
        trace_(extras.trace),
        steady_(model, record, options, state_, tape_, sensitivities_) {}
  ForwardPass(const ForwardPass&) = delete;
  ForwardPass& operator=(const ForwardPass&) = delete;

  /// @return  false if the variance of an innovation is not positive; sums then contains its
  ///          position.
  /// @throws Interrupted  if requested by the options
  bool run(LikelihoodSums<N>& sums) {
    start();
    for (std::size_t s = 0; s < record_.segment_count; ++s)
      if (!run_segment(record_.segments[s], sums)) return false;
    return true;
  }

  /// Recomputes the numbers of a piece that did not fit on the tape.
  void repeat(const TapePiece<N>& piece, double* numbers) {
    LikelihoodSums<N> ignored;
    state_ = piece.start;
    if (piece.steady < 0)
      run_samples(piece.begin, piece.end, ignored, numbers);
    else
      steady_.run_piece(tape_->steady[static_cast<std::size_t>(piece.steady)], piece.begin,
                        piece.end, ignored, numbers);
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
    const bool one_output = segment.complete && record_.ny == 1 && record_.nu <= 1 &&
                            instants_ == nullptr && trace_ == nullptr &&
                            sensitivities_ == nullptr && model_.student.empty();
    SteadyTest<N> steady;
    for (Eigen::Index k = segment.begin; k < segment.end;) {
      if ((k - segment.begin) % RunOptions::kEvery < kEvery) options_.ask();
      Eigen::Index stop = std::min(k + kEvery, segment.end);
      if (tape_ != nullptr) {
        TapePiece<N>& piece = open_piece(k);
        stop = std::min(stop, piece.begin + Tape<N>::kPieceSamples);
        piece.end = stop;
      }
      if constexpr (N == 2)
        if (one_output && state_.diffuse_rank == 0)
          k = run_two_states(k, std::min(stop, record_.samples - 1), sums);
      if (!run_samples(k, stop, sums, numbers_)) return false;
      k = stop;
      if (may_settle && k < segment.end && (k - segment.begin) % kEvery == 0 &&
          state_.diffuse_rank == 0 && steady.reached(state_.P, sensitivities_)) {
        may_settle = false;
        if (!steady_.run(k, segment.end, sums)) return false;
      }
    }
    return true;
  }

  /// The piece of the tape that contains instant k, in a part with varying gains.
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

  /// @param numbers  output for the adjoint pass, advanced by the call; may be null
  bool run_samples(Eigen::Index k, Eigen::Index stop, LikelihoodSums<N>& sums, double*& numbers) {
    for (; k < stop; ++k) {
      if (!correct(k, sums, numbers)) return false;
      if (trace_ != nullptr) trace_state(k);
      if (k + 1 < record_.samples) predict(k);
    }
    return true;
  }

  /// Two states and one output, a correction and a time step combined:
  /// P⁺ = F P Fᵀ + Q - g gᵀ/S, g = F P cᵀ. The critical path is the recursion of P⁺, so that
  /// everything that does not need 1/S is computed during the division.
  /// @return  the first instant not processed: `stop`, or one that requires the Joseph form
  Eigen::Index run_two_states(Eigen::Index k, Eigen::Index stop, LikelihoodSums<N>& sums) {
    if (k >= stop) return k;
    const SparseRow<N> c = model_.C[0];
    const double c0 = c.value[0], c1 = c.value[1], R = model_.R[0];
    const Transition<N>& step = model_.transitions[record_.transition[k]];
    const double F00 = step.F(0, 0), F01 = step.F(0, 1), F10 = step.F(1, 0), F11 = step.F(1, 1);
    const double Q00 = step.Q(0, 0), Q10 = step.Q(1, 0), Q11 = step.Q(1, 1);
    const Column<N> B = record_.nu == 0 ? Column<N>() : step.B[0];
    const double D = model_.D.size() == 0 ? 0 : model_.D(0, 0);
    double x0 = state_.x.at[0], x1 = state_.x.at[1];
    double P00 = state_.P(0, 0), P10 = state_.P(1, 0), P11 = state_.P(1, 1);
    LogSum logs = sums.logs;
    double squares = 0;
    const Eigen::Index first = k;
    for (; k < stop; ++k) {
      const double S = (R + c0 * c0 * P00) + (2 * c0 * c1 * P10 + c1 * c1 * P11);
      const double inverse = 1 / S;
      if (!(R * inverse > kMinShareOfR)) break;
      const double Pc0 = c0 * P00 + c1 * P10, Pc1 = c0 * P10 + c1 * P11;
      const double u = record_.nu == 0 ? 0 : record_.u[k];
      const double e = record_.y[k] - D * u - (c0 * x0 + c1 * x1), weighted = e * inverse;
      const double g0 = F00 * Pc0 + F01 * Pc1, g1 = F10 * Pc0 + F11 * Pc1;
      logs.add(S);
      squares += e * weighted;
      write({{Pc0 * inverse, Pc1 * inverse}}, inverse, weighted, numbers_);
      const double next = (F00 * x0 + (F01 * x1 + B.at[0] * u)) + g0 * weighted;
      x1 = (F10 * x0 + (F11 * x1 + B.at[1] * u)) + g1 * weighted;
      x0 = next;
      const double FP00 = F00 * P00 + F01 * P10, FP01 = F00 * P10 + F01 * P11;
      const double FP10 = F10 * P00 + F11 * P10, FP11 = F10 * P10 + F11 * P11;
      P00 = (FP00 * F00 + (FP01 * F01 + Q00)) - g0 * g0 * inverse;
      P10 = (FP10 * F00 + (FP11 * F01 + Q10)) - g0 * g1 * inverse;
      P11 = (FP10 * F10 + (FP11 * F11 + Q11)) - g1 * g1 * inverse;
    }
    state_.x = {{x0, x1}};
    state_.P = {{P00, P10, P10, P11}};
    sums.logs = logs;
    sums.squares += squares;
    sums.used += k - first;
    return k;
  }

  /// Processes the measurements of instant k, one by one.
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
    if (R * inverse < kMinShareOfR) {         // Joseph form: + (K R - P cᵀ) Kᵀ of this P
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
    sums.constants += std::log(nu / 2) + 2 * (log_gamma(nu / 2) - log_gamma(nu / 2 + 0.5));
    if (sensitivities_ != nullptr) {
      sensitivities_->add_measurement(e, S, weight);
      sensitivities_->reweight(i, R, weight, nu);
    }
    double* no_tape = nullptr;
    update(c, e, R / weight, 1 / (S - R + R / weight), Pc, no_tape);
  }

  /// A measurement that depends on a diffuse state: with F = c P_diffuse cᵀ > 0 the gain is
  /// K = P_diffuse cᵀ/F (Koopman and Durbin 2000). K does not depend on θ: L⁻¹ C adds to a row of C
  /// only earlier rows, which have been removed from P_diffuse.
  /// @return  false if it does not depend on one: then it is an ordinary measurement.
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

  // --- trace ---

  /// @return  false if the gate rejects the measurement
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
  SteadyPass<N> steady_;
  double* numbers_ = nullptr;  ///< of the open piece of the tape
  double whitened_[kMaxOutputs] = {};
};

}  // namespace quadtune::internal
