// SPDX-License-Identifier: Apache-2.0
/// The Kalman filter that sums up a likelihood, one template over the scalar (double, or a jet that
/// carries derivatives with respect to θ) and the number of states.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "noise/likelihood/convergence.hpp"
#include "noise/likelihood/kernel_model.hpp"

namespace quadtune::internal {

/// One run of the filter.
template <class T, bool correlated, int nx>
class LikelihoodKernel {
 public:
  static constexpr int kMost = nx == -1 ? kMostStates : nx;
  using Row = std::conditional_t<correlated, T, double>;
  using Vector = Eigen::Matrix<T, nx, 1, 0, kMost, 1>;
  using Matrix = Eigen::Matrix<T, nx, nx, 0, kMost, kMost>;
  using Plain = Eigen::Matrix<double, nx, nx, 0, kMost, kMost>;
  using Model = KernelModel<T, Row, nx>;
  using RowOfC = MeasurementRow<Row, nx>;

  LikelihoodKernel(const Model& model, const KernelRecord& record, const RunOptions& how)
      : model_(model), record_(record), how_(how), n_(model.x0.size()) {}

  /// @return  false where an innovation has no positive variance; see sums.
  /// @throws Interrupted  where the options say so
  bool run(KernelSums<T>& sums, const KernelTrace* trace) {
    start();
    const bool one_output =
        record_.ny == 1 && nx != -1 && !correlated && trace == nullptr && model_.student.empty();
    for (std::size_t s = 0; s < record_.segment_count; ++s) {
      const KernelSegment& segment = record_.segments[s];
      Eigen::Index k = segment.begin;
      const bool may_settle = how_.hold_steady_gains && segment.complete && trace == nullptr &&
                              model_.student.empty() && segment.end - segment.begin > 2 * kEvery;
      Settling settling;
      while (k < segment.end) {
        if ((k - segment.begin) % RunOptions::kEvery < kEvery) how_.ask();
        const Eigen::Index stop = std::min(k + kEvery, segment.end);
        if (one_output && segment.complete && rank_ == 0)
          k = few_steps(k, std::min(stop, record_.samples - 1), sums);
        for (; k < stop; ++k) {
          if (!correct(k, sums, trace)) return false;
          if (trace != nullptr) write_down(k, *trace);
          if (k + 1 < record_.samples) predict(k);
        }
        if (may_settle && k < segment.end && rank_ == 0 && settled(settling)) {
          if (!hold_gains(k, segment.end, sums)) return false;
          k = segment.end;
        }
      }
    }
    return true;
  }

 private:
  [[nodiscard]] Eigen::Index n() const {
    if constexpr (nx == -1)
      return n_;
    else
      return nx;
  }

  static constexpr Eigen::Index kEvery = Convergence::kEvery;

  struct Settling {
    Matrix before;
    bool known = false;
    Convergence convergence;
  };

  void start() {
    x_.resize(n());
    PC_.resize(n());
    for (Eigen::Index i = 0; i < n(); ++i) x_(i) = T(model_.x0(i));
    P_.resize(n(), n());
    diffuse_P_.resize(n(), n());
    for (Eigen::Index j = 0; j < n(); ++j)
      for (Eigen::Index i = 0; i < n(); ++i) {
        P_(i, j) = T(model_.P0(i, j));
        diffuse_P_(i, j) = model_.P0_diffuse(i, j);
      }
    rank_ = model_.diffuse_rank;
    if (record_.start == nullptr) return;
    rank_ = 0;
    diffuse_P_.setZero();
    for (Eigen::Index j = 0; j < n(); ++j) {
      x_(j) = T(record_.start->x(j));
      for (Eigen::Index i = 0; i < n(); ++i) P_(i, j) = T(record_.start->P(i, j));
    }
  }

  /// Row i of C at instant k.
  const RowOfC& row_of(Eigen::Index k, Eigen::Index i) {
    if constexpr (nx == -1 && !correlated) {
      if (record_.linearized != nullptr) {
        row_.column.clear();
        row_.value.clear();
        const Eigen::MatrixXd& C = record_.linearized[k].C;
        for (Eigen::Index j = 0; j < n(); ++j)
          if (C(i, j) != 0) {
            row_.column.push_back(static_cast<int>(j));
            row_.value.push_back(C(i, j));
          }
        return row_;
      }
    }
    return model_.C[static_cast<std::size_t>(i)];
  }

  /// Row i of the measurements of instant k, less what the inputs and, where R is full, the
  /// outputs before it say.
  T measured(Eigen::Index k, Eigen::Index i) {
    const double* y = record_.y + k * record_.ny;
    double value = y[i];
    if (model_.D.size() > 0)
      for (Eigen::Index j = 0; j < record_.nu; ++j)
        value -= model_.D(i, j) * record_.u[k * record_.nu + j];
    if constexpr (!correlated) {
      return T(value);
    } else {
      T whitened = T(value);
      for (Eigen::Index j = 0; j < i; ++j)
        if (y[j] == y[j]) whitened -= model_.L(i, j) * whitened_[static_cast<std::size_t>(j)];
      whitened_[static_cast<std::size_t>(i)] = whitened;
      return whitened;
    }
  }

  bool correct(Eigen::Index k, KernelSums<T>& sums, const KernelTrace* trace) {
    const double* y = record_.y + k * record_.ny;
    for (Eigen::Index i = 0; i < record_.ny; ++i) {
      if (y[i] != y[i]) continue;
      const RowOfC& c = row_of(k, i);
      T R = model_.R[static_cast<std::size_t>(i)];
      T e = measured(k, i);
      c.each([&](int j, const Row& C) { e -= C * x_(j); });
      if (rank_ > 0 && take_up(c, e, R, sums)) continue;
      times_row(P_, c, PC_);
      T S = R;
      c.each([&](int j, const Row& C) { S += C * PC_(j); });
      if (!(plain(S) > 0)) {
        sums.bad_sample = k;
        sums.bad_output = i;
        return false;
      }
      if (trace != nullptr) {
        (*trace->variance)(i, k) = plain(S);
        if (plain(e) * plain(e) > model_.gate[static_cast<std::size_t>(i)] * plain(S)) {
          (*trace->refused)(i, k) = 1;
          continue;
        }
        (*trace->innovation)(i, k) = plain(e);
      }
      sums.logs.add(S);
      ++sums.used;
      if (sums.information != nullptr) inform(e, S, 1, sums);
      if (model_.student.empty() || model_.student[static_cast<std::size_t>(i)] == 0)
        sums.squares += e * e / S;
      else
        S += weigh(e, S, model_.student[static_cast<std::size_t>(i)], R, sums);
      const T inverse = T(1) / S;
      // Joseph's form in two rank-one steps.
      const Vector K = PC_ * inverse;
      x_ += K * e;
      subtract_outer(K, PC_);
      Vector rest = K * R;
      c.each([&](int j, const Row& C) { rest -= P_.col(j) * C; });
      for (Eigen::Index j = 0; j < n(); ++j) P_.col(j) += rest * K(j);
    }
    return true;
  }

  /// Student's density of an innovation of scale S.
  /// @param R  to be divided by the weight of the measurement.
  /// @return   what that adds to S
  T weigh(const T& e, const T& S, double freedom, T& R, KernelSums<T>& sums) {
    using std::lgamma, std::log;
    const T square = e * e / S;
    sums.squares += (freedom + 1) * T(log(T(1) + square / freedom));
    sums.constants += std::log(freedom / 2) + 2 * (lgamma(freedom / 2) - lgamma(freedom / 2 + 0.5));
    const T before = R;
    R *= (freedom + square) / (freedom + 1);
    return R - before;
  }

  /// Correction by one output and prediction in one, with everything in registers: what does not
  /// need the innovation's variance is worked out while that is on its way.
  /// @return  the first instant that it did not do: `stop`, or one that needs Joseph's form to keep
  ///          what is left of P.
  Eigen::Index few_steps(Eigen::Index k, Eigen::Index stop, KernelSums<T>& sums) {
    if (k >= stop) return k;
    const RowOfC& c = model_.C[0];
    const T R = model_.R[0];
    const KernelTransition<T, nx>& step = model_.transitions[record_.transition[k]];
    const Plain F = step.F;
    const Matrix Q = step.Q;
    Vector x = x_;
    Matrix P = P_;
    LogSum<T> logs = sums.logs;
    T squares = T(0);
    const Eigen::Index first = k;
    for (; k < stop; ++k) {
      Vector PC(n());
      PC.setConstant(T(0));
      c.each([&](int j, const Row& C) { PC += P.col(j) * C; });
      T S = R;
      c.each([&](int j, const Row& C) { S += C * PC(j); });
      if (!(plain(R) > kLeastShareOfR * plain(S))) break;
      T e = measured(k, 0);
      c.each([&](int j, const Row& C) { e -= C * x(j); });
      const T inverse = T(1) / S;
      logs.add(S);
      squares += e * e * inverse;
      if (sums.information != nullptr) inform(e, S, 1, sums);
      const Vector g = multiply(F, PC);
      x = multiply(F, x) + g * (e * inverse);
      for (Eigen::Index j = 0; j < record_.nu; ++j)
        for (Eigen::Index i = 0; i < n(); ++i) x(i) += step.B(i, j) * record_.u[k * record_.nu + j];
      propagate(F, P);
      for (Eigen::Index j = 0; j < n(); ++j)
        for (Eigen::Index i = j; i < n(); ++i) {
          P(i, j) += Q(i, j) - g(i) * (g(j) * inverse);
          P(j, i) = P(i, j);
        }
    }
    x_ = x;
    P_ = P;
    sums.logs = logs;
    sums.squares += squares;
    sums.used += k - first;
    return k;
  }

  template <class V>
  void times_row(const Matrix& P, const RowOfC& c, V& result) {
    result.setConstant(typename V::Scalar(0));
    c.each([&](int j, const Row& C) { result += P.col(j) * C; });
  }

  void subtract_outer(const Vector& a, const Vector& b) {
    for (Eigen::Index j = 0; j < n(); ++j) P_.col(j) -= a * b(j);
  }

  /// A measurement that sees a state of which nothing is known yet (Koopman and Durbin 2000).
  /// @return  false where it sees none: then it is an ordinary measurement.
  bool take_up(const RowOfC& c, const T& e, const T& R, KernelSums<T>& sums) {
    Eigen::Matrix<double, nx, 1, 0, kMost, 1> PC =
        Eigen::Matrix<double, nx, 1, 0, kMost, 1>::Zero(n());
    double F = 0, scale = 0;
    for (std::size_t q = 0; q < c.column.size(); ++q)
      PC += diffuse_P_.col(c.column[q]) * plain(c.value[q]);
    for (std::size_t q = 0; q < c.column.size(); ++q) {
      F += plain(c.value[q]) * PC(c.column[q]);
      for (std::size_t r = 0; r < c.column.size(); ++r)
        scale +=
            std::abs(plain(c.value[q]) * plain(c.value[r]) * diffuse_P_(c.column[q], c.column[r]));
    }
    if (!(F > 1e-8 * scale)) return false;
    Vector K(n());
    T F_T = T(F);
    if constexpr (!correlated) {
      for (Eigen::Index i = 0; i < n(); ++i) K(i) = T(PC(i) / F);
    } else {
      // The rows depend on θ, and so does what they see.
      Vector PC_T(n());
      for (Eigen::Index i = 0; i < n(); ++i) {
        PC_T(i) = T(0);
        for (std::size_t q = 0; q < c.column.size(); ++q)
          PC_T(i) += c.value[q] * diffuse_P_(i, c.column[q]);
      }
      F_T = T(0);
      for (std::size_t q = 0; q < c.column.size(); ++q) F_T += c.value[q] * PC_T(c.column[q]);
      K = PC_T / F_T;
    }
    sums.logs.add(F_T);
    ++sums.diffuse;
    x_ += K * e;
    Matrix A(n(), n());  // I - K C
    A.setIdentity();
    for (std::size_t q = 0; q < c.column.size(); ++q) A.col(c.column[q]) -= K * T(c.value[q]);
    const Matrix AP = A.lazyProduct(P_);
    P_ = AP.lazyProduct(A.transpose());
    P_ += K.lazyProduct(K.transpose()) * R;
    diffuse_P_ -= PC * PC.transpose() / F;
    if (--rank_ == 0) diffuse_P_.setZero();
    return true;
  }

  void inform(const T& e, const T& S, double times, KernelSums<T>& sums) {
    if constexpr (is_jet<T>) {
      const auto s = (S.v / S.a).eval();
      sums.information->noalias() += (0.5 * times) * s * s.transpose();
      sums.information->noalias() += e.v * e.v.transpose() / S.a;
    }
  }

  void predict_linearized(Eigen::Index k) {
    const LinearizedInstant& step = record_.linearized[k];
    const Plain F = step.F;
    const Vector x = multiply(F, x_);
    for (Eigen::Index i = 0; i < n(); ++i) x_(i) = x(i) + step.offset(i);
    propagate(F, P_);
    for (std::size_t t = 0; t < step.noise.size(); ++t)
      for (Eigen::Index j = 0; j < n(); ++j)
        for (Eigen::Index i = 0; i < n(); ++i)
          if (step.noise[t](i, j) != 0) P_(i, j) += model_.variances[t] * step.noise[t](i, j);
  }

  void predict(Eigen::Index k) {
    if constexpr (nx == -1 && !correlated) {
      if (record_.linearized != nullptr) {
        predict_linearized(k);
        return;
      }
    }
    const KernelTransition<T, nx>& step = model_.transitions[record_.transition[k]];
    const Vector x = multiply(step.F, x_);
    x_ = x;
    for (Eigen::Index j = 0; j < record_.nu; ++j)
      for (Eigen::Index i = 0; i < n(); ++i) x_(i) += step.B(i, j) * record_.u[k * record_.nu + j];
    propagate(step.F, P_);
    P_ += step.Q;
    if (rank_ > 0) {
      const Plain FP = step.F.lazyProduct(diffuse_P_);
      diffuse_P_ = FP.lazyProduct(step.F.transpose());
      diffuse_P_ = (0.5 * (diffuse_P_ + diffuse_P_.transpose())).eval();
    }
  }

  Vector multiply(const Plain& F, const Vector& x) {
    Vector result(n());
    for (Eigen::Index i = 0; i < n(); ++i) {
      T sum = F(i, 0) * x(0);
      for (Eigen::Index j = 1; j < n(); ++j) sum += F(i, j) * x(j);
      result(i) = sum;
    }
    return result;
  }

  /// P ← F P Fᵀ, symmetric to the bit.
  void propagate(const Plain& F, Matrix& P) {
    Matrix FP(n(), n());
    for (Eigen::Index j = 0; j < n(); ++j) {
      FP.col(j) = F.col(0).template cast<T>() * P(0, j);
      for (Eigen::Index q = 1; q < n(); ++q) FP.col(j) += F.col(q).template cast<T>() * P(q, j);
    }
    for (Eigen::Index j = 0; j < n(); ++j) {
      P.col(j) = FP.col(0) * T(F(j, 0));
      for (Eigen::Index q = 1; q < n(); ++q) P.col(j) += FP.col(q) * T(F(j, q));
    }
    for (Eigen::Index j = 0; j < n(); ++j)
      for (Eigen::Index i = 0; i < j; ++i) P(i, j) = P(j, i);
  }

  /// Greatest change of P since the last look, in correlations; of derivatives likewise.
  double change_since(const Matrix& before) const {
    double greatest = 0;
    for (Eigen::Index j = 0; j < n(); ++j)
      for (Eigen::Index i = j; i < n(); ++i) {
        const double scale = std::sqrt(plain(P_(i, i)) * plain(P_(j, j)));
        double change = std::abs(plain(P_(i, j)) - plain(before(i, j)));
        if constexpr (is_jet<T>)
          change = std::max(change, (P_(i, j).v - before(i, j).v).cwiseAbs().maxCoeff());
        if (change > 0)
          greatest = std::max(greatest, change / scale);  // not finite where scale is 0
      }
    return greatest;
  }

  bool settled(Settling& settling) const {
    const bool is = settling.known && settling.convergence.reached(change_since(settling.before));
    settling.before = P_;
    settling.known = true;
    return is;
  }

  /// The rest of a segment with the gains of the present P: x⁺ = A x + K y + B u, e = W (y - C x).
  bool hold_gains(Eigen::Index k, Eigen::Index end, KernelSums<T>& sums) {
    const Eigen::Index m = record_.ny;
    const KernelTransition<T, nx>& step = model_.transitions[record_.transition[k]];
    // One by one at this P, as correct() does: the state after all is A x + K y, e_i is y_i less
    // a row of the state and of the outputs before.
    using Wide = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
    Matrix A(n(), n());
    A.setIdentity();
    Wide K = Wide::Constant(n(), m, T(0));
    Wide state_part(m, n()), output_part = Wide::Constant(m, m, T(0));
    std::vector<T> S(static_cast<std::size_t>(m));
    const Matrix P = P_;
    const std::int64_t count = end - k;
    for (Eigen::Index i = 0; i < m; ++i) {
      const RowOfC& c = model_.C[static_cast<std::size_t>(i)];
      times_row(P_, c, PC_);
      T variance = model_.R[static_cast<std::size_t>(i)];
      c.each([&](int j, const Row& C) { variance += C * PC_(j); });
      if (!(plain(variance) > 0)) {
        sums.bad_sample = k;
        sums.bad_output = i;
        return false;
      }
      S[static_cast<std::size_t>(i)] = variance;
      for (Eigen::Index j = 0; j < n(); ++j) {
        T sum = T(0);
        c.each([&](int q, const Row& C) { sum += C * A(q, j); });
        state_part(i, j) = sum;
      }
      for (Eigen::Index j = 0; j < m; ++j) {
        T sum = T(j == i ? 1 : 0);
        c.each([&](int q, const Row& C) { sum -= C * K(q, j); });
        output_part(i, j) = sum;
      }
      const Vector gain = PC_ / variance;
      A -= gain.lazyProduct(state_part.row(i));
      K += gain.lazyProduct(output_part.row(i));
      subtract_outer(gain, PC_);
      sums.logs.add(variance, count);
    }
    Matrix closed(n(), n());
    Wide input(n(), m);
    for (Eigen::Index i = 0; i < n(); ++i) {
      for (Eigen::Index j = 0; j < n(); ++j) {
        T sum = T(0);
        for (Eigen::Index q = 0; q < n(); ++q) sum += step.F(i, q) * A(q, j);
        closed(i, j) = sum;
      }
      for (Eigen::Index j = 0; j < m; ++j) {
        T sum = T(0);
        for (Eigen::Index q = 0; q < n(); ++q) sum += step.F(i, q) * K(q, j);
        input(i, j) = sum;
      }
    }
    P_ = P;
    if (m == 1 && nx == 2 && !correlated)
      two_states(k, end, step, closed, input, state_part, S[0], sums);
    else
      many_states(k, end, step, closed, input, state_part, output_part, S, sums);
    sums.used += count * m;
    if (sums.information != nullptr) {
      for (const T& variance : S) inform(T(0), variance, static_cast<double>(count), sums);
    }
    return true;
  }

  template <class Wide>
  void many_states(Eigen::Index k, Eigen::Index end, const KernelTransition<T, nx>& step,
                   const Matrix& closed, const Wide& input, const Wide& state_part,
                   const Wide& output_part, const std::vector<T>& S, KernelSums<T>& sums) {
    const Eigen::Index m = record_.ny;
    std::vector<T> squares(static_cast<std::size_t>(m), T(0)), y(static_cast<std::size_t>(m));
    Vector x = x_, next(n());
    for (; k < end; ++k) {
      if (k % RunOptions::kEvery == 0) how_.ask();
      for (Eigen::Index i = 0; i < m; ++i) y[static_cast<std::size_t>(i)] = measured(k, i);
      for (Eigen::Index i = 0; i < m; ++i) {
        T e = output_part(i, 0) * y[0];
        for (Eigen::Index j = 1; j <= i; ++j)
          e += output_part(i, j) * y[static_cast<std::size_t>(j)];
        for (Eigen::Index j = 0; j < n(); ++j) e -= state_part(i, j) * x(j);
        squares[static_cast<std::size_t>(i)] += e * e;
        if (sums.information != nullptr) inform(e, S[static_cast<std::size_t>(i)], 0, sums);
      }
      for (Eigen::Index i = 0; i < n(); ++i) {
        T sum = T(0);
        for (Eigen::Index j = 0; j < record_.nu; ++j)
          sum += step.B(i, j) * record_.u[k * record_.nu + j];
        for (Eigen::Index j = 0; j < m; ++j) sum += input(i, j) * y[static_cast<std::size_t>(j)];
        for (Eigen::Index j = 0; j < n(); ++j) sum += closed(i, j) * x(j);
        next(i) = sum;
      }
      x.swap(next);
    }
    x_ = x;
    for (std::size_t i = 0; i < S.size(); ++i) sums.squares += squares[i] / S[i];
  }

  /// As many_states(), without a loop: two states and one output.
  template <class Wide>
  void two_states(Eigen::Index k, Eigen::Index end, const KernelTransition<T, nx>& step,
                  const Matrix& closed, const Wide& input, const Wide& state_part, const T& S,
                  KernelSums<T>& sums) {
    const T &a00 = closed(0, 0), &a01 = closed(0, 1), &a10 = closed(1, 0), &a11 = closed(1, 1);
    const T &k0 = input(0, 0), &k1 = input(1, 0);
    const double c0 = plain(state_part(0, 0)), c1 = plain(state_part(0, 1));
    T x0 = x_(0), x1 = x_(1), squares = T(0);
    const bool one_input = record_.nu == 1 && model_.D.size() == 0;
    const double b0 = one_input ? step.B(0, 0) : 0, b1 = one_input ? step.B(1, 0) : 0;
    SlopeOuter<T> outer;
    if (one_input || record_.nu == 0) {
      // Two samples at once: the state waits for its predecessor half as often.
      const T aa00 = a00 * a00 + a01 * a10, aa01 = a00 * a01 + a01 * a11,
              aa10 = a10 * a00 + a11 * a10, aa11 = a10 * a01 + a11 * a11;
      const T ca0 = c0 * a00 + c1 * a10, ca1 = c0 * a01 + c1 * a11;
      const T ak0 = a00 * k0 + a01 * k1, ak1 = a10 * k0 + a11 * k1, ck = c0 * k0 + c1 * k1;
      const T ab0 = a00 * b0 + a01 * b1, ab1 = a10 * b0 + a11 * b1;
      const double cb = c0 * b0 + c1 * b1;
      T more = T(0);
      for (; k + 1 < end; k += 2) {
        const double y = record_.y[k], y_next = record_.y[k + 1];
        const double u = one_input ? record_.u[k] : 0, u_next = one_input ? record_.u[k + 1] : 0;
        const T e = y - (c0 * x0 + c1 * x1);
        const T e_next = ((y_next - cb * u) - ck * y) - (ca0 * x0 + ca1 * x1);
        add_square(e, squares);
        add_square(e_next, more);
        if (sums.information != nullptr) {
          outer.add(e);
          outer.add(e_next);
        }
        const T known0 = (ak0 * y + ab0 * u) + (k0 * y_next + b0 * u_next);
        const T known1 = (ak1 * y + ab1 * u) + (k1 * y_next + b1 * u_next);
        const T next0 = aa00 * x0 + (aa01 * x1 + known0);
        x1 = aa11 * x1 + (aa10 * x0 + known1);
        x0 = next0;
      }
      squares += more;
    }
    for (; k < end; ++k) {
      double y = record_.y[k], u0 = 0, u1 = 0;
      if (one_input) {
        const double u = record_.u[k];
        u0 = b0 * u;
        u1 = b1 * u;
      } else {
        for (Eigen::Index j = 0; j < record_.nu; ++j) {
          const double u = record_.u[k * record_.nu + j];
          u0 += step.B(0, j) * u;
          u1 += step.B(1, j) * u;
          if (model_.D.size() > 0) y -= model_.D(0, j) * u;
        }
      }
      const T e = y - (c0 * x0 + c1 * x1);
      add_square(e, squares);
      if (sums.information != nullptr) outer.add(e);
      const T next0 = a00 * x0 + a01 * x1 + (k0 * y + u0);
      x1 = a10 * x0 + a11 * x1 + (k1 * y + u1);
      x0 = next0;
    }
    x_(0) = x0;
    x_(1) = x1;
    sums.squares += squares / S;
    if (sums.information != nullptr) outer.add_to(*sums.information, 1 / plain(S));
  }

  /// sum += e²
  static void add_square(const T& e, T& sum) {
    if constexpr (is_jet<T>) {
      sum.a += e.a * e.a;
      sum.v += (2 * e.a) * e.v;
    } else {
      sum += e * e;
    }
  }

  void write_down(Eigen::Index k, const KernelTrace& trace) {
    for (Eigen::Index i = 0; i < n(); ++i) {
      if (rank_ > 0) continue;
      (*trace.x)(i, k) = plain(x_(i));
      (*trace.x_variance)(i, k) = plain(P_(i, i));
    }
  }

  const Model& model_;
  const KernelRecord& record_;
  const RunOptions& how_;
  Eigen::Index n_;
  Vector x_, PC_;
  Matrix P_;
  Plain diffuse_P_;
  int rank_ = 0;
  RowOfC row_;
  std::array<T, correlated ? kMostOutputs : 1> whitened_{};
};

}  // namespace quadtune::internal
