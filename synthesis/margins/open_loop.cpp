// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/open_loop.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "lyapunov/eigenvalues.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;

namespace {

template <class Lti>
FrequencyResponse matrix_response(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C,
                                  const MatrixXd& D, double dt) {
  Lti plant;
  plant.A = A;
  plant.B = B;
  plant.C = C;
  plant.D = D;
  if constexpr (std::is_same_v<Lti, DiscreteLti>) plant.dt = dt;
  return FrequencyResponse(plant);
}

FrequencyResponse matrix_response(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C,
                                  const MatrixXd& D, double dt) {
  return dt > 0 ? matrix_response<DiscreteLti>(A, B, C, D, dt)
                : matrix_response<ContinuousLti>(A, B, C, D, dt);
}

/// The sensitivity of the closed loop: u = r - y, y = C x + D u, hence u = (I + D)⁻¹ (r - C x).
FrequencyResponse sensitivity_of(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C,
                                 const MatrixXd& D, double dt) {
  if (D.rows() != D.cols())
    throw InvalidInput("open loop", fmt::format("the loop has {} and {}, expected equal "
                                                "numbers because each output is fed back",
                                                internal::counted(D.rows(), "output"),
                                                internal::counted(D.cols(), "input")));
  const Eigen::PartialPivLU<MatrixXd> lu(MatrixXd::Identity(D.rows(), D.rows()) + D);
  if (!(lu.rcond() > 1e-14))
    throw InvalidInput(
        "open loop", "the closed loop is algebraic (I + D is singular), expected a regular I + D");
  const MatrixXd closing = lu.inverse();
  return matrix_response(A - B * closing * C, B * closing, -closing * C, closing, dt);
}

template <class Lti>
MatrixXd outputs_of(const Lti& plant) {
  validate(plant, "open loop");
  return plant.C.size() ? plant.C : MatrixXd::Identity(plant.A.rows(), plant.A.rows());
}

template <class Lti>
MatrixXd feed_through_of(const Lti& plant) {
  const Index ny = plant.C.size() ? plant.C.rows() : plant.A.rows();
  return plant.D.size() ? plant.D : MatrixXd::Zero(ny, plant.B.cols());
}

}  // namespace

OpenLoop::OpenLoop(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C, const MatrixXd& D,
                   double dt, double delay)
    : A_(A),
      B_(B),
      C_(C),
      D_(D),
      dt_(dt),
      delay_(delay),
      response_(matrix_response(A, B, C, D, dt)),
      sensitivity_(sensitivity_of(A, B, C, D, dt)) {
  if (!(delay >= 0) || !std::isfinite(delay))
    throw InvalidInput("open loop",
                       fmt::format("delay is {} s, expected a finite number >= 0", delay));
  if (delay > 0 && D.rows() > 1)
    throw InvalidInput("open loop",
                       fmt::format("delay is {} s with {} channels, expected one channel (or a "
                                   "discrete loop whose states contain the delay)",
                                   delay, D.rows()));
}

OpenLoop::OpenLoop(const ContinuousLti& L, double delay)
    : OpenLoop(L.A, L.B, outputs_of(L), feed_through_of(L), 0, delay) {}
OpenLoop::OpenLoop(const DiscreteLti& L)
    : OpenLoop(L.A, L.B, outputs_of(L), feed_through_of(L), L.dt, 0) {}
OpenLoop::OpenLoop(const ContinuousTransferFunction& L) : OpenLoop(realize(L), L.delay) {}
OpenLoop::OpenLoop(const DiscreteTransferFunction& L) : OpenLoop(realize(L)) {}

MatrixXcd OpenLoop::at(double w) const {
  if (std::isinf(w)) return D_.cast<std::complex<double>>();
  if (delay_ == 0) return response_.at(w);
  return response_.at(w) * std::polar(1.0, -w * delay_);
}

MatrixXcd OpenLoop::sensitivity(double w) const {
  const MatrixXd I = MatrixXd::Identity(size(), size());
  if (std::isinf(w) || delay_ > 0) return (I + at(w)).inverse();
  return sensitivity_.at(w);
}

VectorXcd OpenLoop::poles() const { return internal::eigenvalues(A_); }

VectorXcd OpenLoop::closed_loop_poles() const {
  const MatrixXd closing = MatrixXd::Identity(size(), size()) + D_;
  return internal::eigenvalues(A_ - B_ * closing.partialPivLu().solve(C_));
}

VectorXcd OpenLoop::zeros() const {
  ContinuousLti plant;
  plant.A = A_;
  plant.B = B_;
  plant.C = C_;
  plant.D = D_;
  return transmission_zeros(plant, 0, 0);
}

OpenLoop OpenLoop::channel(Index index) const {
  if (index < 0 || index >= size())
    throw InvalidInput("open loop",
                       fmt::format("channel is {}, expected 0 to {}", index, size() - 1));
  if (size() == 1) return {A_, B_, C_, D_, dt_, delay_};
  // Eliminate the other channels, y_o = C_o x + D_oi u + D_oo u_o with u_o = -y_o.
  std::vector<Index> others;
  for (Index i = 0; i < size(); ++i)
    if (i != index) others.push_back(i);
  const MatrixXd Bo = B_(Eigen::all, others);
  const MatrixXd closing =
      MatrixXd::Identity(size() - 1, size() - 1) + MatrixXd(D_(others, others));
  const Eigen::PartialPivLU<MatrixXd> lu(closing);
  const MatrixXd Ko = lu.solve(MatrixXd(C_(others, Eigen::all)));  // u_o = -Ko x - Fo u
  const MatrixXd Fo = lu.solve(MatrixXd(D_(others, std::vector{index})));
  const MatrixXd Dio = D_(std::vector{index}, others);
  return {A_ - Bo * Ko,
          B_.col(index) - Bo * Fo,
          C_.row(index) - Dio * Ko,
          D_.block(index, index, 1, 1) - Dio * Fo,
          dt_,
          delay_};
}

OpenLoop OpenLoop::without_delay() const { return {A_, B_, C_, D_, dt_, 0}; }

namespace {

template <class Lti>
Lti with_outputs(const Lti& plant, const MatrixXd& B, const MatrixXd& C) {
  Lti loop = plant;
  loop.B = B;
  loop.C = C;
  loop.D = MatrixXd::Zero(C.rows(), B.cols());
  loop.inputs.clear();
  loop.outputs.clear();
  return loop;
}

template <class Lti>
OpenLoop cut_at_inputs(const Lti& plant, const Eigen::Ref<const MatrixXd>& K) {
  validate(plant, "open loop");
  require_shape(K, plant.B.cols(), plant.A.rows(), "open loop", "K", "inputs x states");
  require_finite(K, "open loop", "K");
  return OpenLoop(with_outputs(plant, plant.B, K));
}

template <class Lti>
OpenLoop cut_at_states(const Lti& plant, const Eigen::Ref<const MatrixXd>& K) {
  validate(plant, "open loop");
  require_shape(K, plant.B.cols(), plant.A.rows(), "open loop", "K", "inputs x states");
  require_finite(K, "open loop", "K");
  const Index nx = plant.A.rows();
  return OpenLoop(with_outputs(plant, plant.B * K, MatrixXd::Identity(nx, nx)));
}

}  // namespace

OpenLoop loop_at_inputs(const ContinuousLti& plant, const Eigen::Ref<const MatrixXd>& K) {
  return cut_at_inputs(plant, K);
}
OpenLoop loop_at_inputs(const DiscreteLti& plant, const Eigen::Ref<const MatrixXd>& K) {
  return cut_at_inputs(plant, K);
}
OpenLoop loop_at_states(const ContinuousLti& plant, const Eigen::Ref<const MatrixXd>& K) {
  return cut_at_states(plant, K);
}
OpenLoop loop_at_states(const DiscreteLti& plant, const Eigen::Ref<const MatrixXd>& K) {
  return cut_at_states(plant, K);
}

}  // namespace quadtune
