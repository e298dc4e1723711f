// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/output_feedback.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <cstddef>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using std::size_t;
/// Row-major storage, so that products accumulate whole rows.
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr const char* kWhere = "output feedback";

/// A matrix that multiplies others, entry by entry if most of its entries are 0.
class Factor {
 public:
  explicit Factor(MatrixXd A) : A_(std::move(A)) {
    constexpr double kFew = 0.3;
    const auto few = static_cast<Index>(kFew * static_cast<double>(A_.size()));
    if ((A_.array() != 0).count() > few) return;
    sparse_ = true;
    for (Index i = 0; i < A_.rows(); ++i)
      for (Index j = 0; j < A_.cols(); ++j)
        if (A_(i, j) != 0) entries_.push_back({i, j});
  }

  /// product = A S
  void times(const Rows& S, Rows& product) const {
    if (!sparse_) {
      product.noalias() = A_ * S;
      return;
    }
    product.setZero(A_.rows(), S.cols());
    for (const auto& [i, j] : entries_) product.row(i).noalias() += A_(i, j) * S.row(j);
  }
  /// product = Aᵀ S
  void transposed_times(const Rows& S, Rows& product) const {
    if (!sparse_) {
      product.noalias() = A_.transpose() * S;
      return;
    }
    product.setZero(A_.cols(), S.cols());
    for (const auto& [i, j] : entries_) product.row(j).noalias() += A_(i, j) * S.row(i);
  }
  /// left A
  [[nodiscard]] MatrixXd after(const MatrixXd& left) const {
    if (!sparse_) return left * A_;
    MatrixXd product = MatrixXd::Zero(left.rows(), A_.cols());
    for (const auto& [i, j] : entries_) product.col(j) += A_(i, j) * left.col(i);
    return product;
  }

 private:
  MatrixXd A_;
  bool sparse_ = false;
  std::vector<std::pair<Index, Index>> entries_;
};

/// Solves X = ΦᵀXΦ + V, given X = V, by iterating X ← X + ΦᵀXΦ, Φ ← Φ² (Smith 1968). It converges
/// if and only if all eigenvalues of Φ lie inside the unit circle.
/// @return  whether it converged
bool smith(MatrixXd Phi, MatrixXd& X) {
  constexpr int kMaxDoublings = 40;  // 2^40 periods
  constexpr double kConverged = 1e-15;
  MatrixXd half(Phi.rows(), Phi.cols()), added(Phi.rows(), Phi.cols());
  for (int i = 0; i < kMaxDoublings; ++i) {
    half.noalias() = X * Phi;
    added.noalias() = Phi.transpose() * half;
    const double size = X.diagonal().cwiseAbs().sum();
    const double change = added.cwiseAbs().maxCoeff();
    if (!std::isfinite(change) || !std::isfinite(size)) return false;
    X += added;
    half.noalias() = Phi * Phi;
    Phi.swap(half);
    // The powers of Φ must vanish too: a marginally stable mode may be unobservable in the cost.
    if (change <= kConverged * size && Phi.cwiseAbs().maxCoeff() < 1e-3) return true;
  }
  return false;
}

void require(const OutputFeedbackProblem& problem, const MatrixXd& F) {
  validate(problem.plant, kWhere);
  const Index nx = problem.plant.A.front().rows(), nu = problem.plant.B.front().cols();
  require_shape(problem.Q, nx, nx, kWhere, "Q", "one row and column per state");
  require_shape(problem.R, nu, nu, kWhere, "R", "one row and column per input");
  require_shape(problem.start, nx, problem.start.cols(), kWhere, "start", "one row per state");
  require_shape(F, nu, problem.plant.C.rows(), kWhere, "F", "inputs by outputs of the plant");
  require_finite(problem.Q, kWhere, "Q");
  require_finite(problem.R, kWhere, "R");
  require_finite(problem.start, kWhere, "start");
  require_finite(F, kWhere, "F");
}

}  // namespace

OutputFeedbackCost output_feedback_cost(const OutputFeedbackProblem& problem, const MatrixXd& F) {
  require(problem, F);
  const PeriodicLti& plant = problem.plant;
  const size_t N = plant.period();
  const Index nx = plant.A.front().rows(), nu = plant.B.front().cols();
  OutputFeedbackCost result;
  result.slope = MatrixXd::Constant(nu, plant.C.rows(), std::nan(""));
  const MatrixXd K = F * plant.C;
  const MatrixXd RK = problem.R * K;
  const Rows Q = problem.Q + K.transpose() * RK;
  // Most states of a flown plant are delayed samples, which only shift: few entries of A are not 0,
  // and sparse products with them are cheap. A symmetric S gives A S Aᵀ = A (A S)ᵀ.
  std::vector<Factor> A;
  A.reserve(N);
  for (size_t k = 0; k < N; ++k) A.emplace_back(plant.A[k] - plant.B[k] * K);
  Rows half(nx, nx), turned(nx, nx), next(nx, nx);
  // Over one period: Φ = A[N-1] … A[0], X = Q + A[0]ᵀ(Q + A[1]ᵀ(… Q …)A[1])A[0].
  Rows Phi = plant.A[0] - plant.B[0] * K, X = Q;
  for (size_t k = 1; k < N; ++k) {
    A[k].times(Phi, next);
    Phi.swap(next);
  }
  const auto add_cost = [&](size_t k, const Rows& after, Rows& before) {
    A[k].transposed_times(after, half);
    turned = half.transpose();
    A[k].transposed_times(turned, before);
    before += Q;
  };
  for (size_t k = N - 1; k-- > 0;) {
    add_cost(k, X, next);
    X.swap(next);
  }
  MatrixXd cost_to_go = X;
  if (!smith(Phi, cost_to_go)) return result;
  MatrixXd reached = problem.start * problem.start.transpose();
  if (!smith(Phi.transpose(), reached)) return result;
  result.stable = true;
  result.cost = problem.start.cwiseProduct(cost_to_go * problem.start).sum();
  // P[k] = Q + Aᵀ[k] P[k+1] A[k], Σ[k+1] = A[k] Σ[k] Aᵀ[k].
  std::vector<Rows> P(N, Rows(nx, nx));
  P[0] = cost_to_go;
  for (size_t k = N - 1; k > 0; --k) add_cost(k, P[(k + 1) % N], P[k]);
  Rows S = reached;
  MatrixXd slope = MatrixXd::Zero(nu, nx);
  for (size_t k = 0; k < N; ++k) {
    slope.noalias() += (RK - A[k].after(plant.B[k].transpose() * P[(k + 1) % N])) * S;
    A[k].times(S, half);
    turned = half.transpose();
    A[k].times(turned, S);
  }
  result.slope = 2 * slope * plant.C.transpose();
  return result;
}

PeriodicLti with_integrals(const PeriodicLti& plant, const std::vector<Index>& outputs,
                           double now) {
  validate(plant, kWhere);
  const Index nx = plant.A.front().rows(), nu = plant.B.front().cols(), ny = plant.C.rows();
  const Index ni = std::ssize(outputs);
  PeriodicLti result = plant;
  MatrixXd integrated(ni, nx);
  for (Index j = 0; j < ni; ++j) {
    const Index output = outputs[static_cast<size_t>(j)];
    if (output < 0 || output >= ny)
      throw InvalidInput(
          kWhere, fmt::format("output {} cannot be integrated, expected an index from 0 to {}",
                              output, ny - 1));
    integrated.row(j) = plant.C.row(output);
    const auto name = [&](const std::vector<Signal>& of) {
      return of.empty() ? Signal{} : of[static_cast<size_t>(output)];
    };
    const Signal of = name(plant.outputs);
    if (!plant.states.empty()) result.states.push_back({"integral of " + of.name, of.unit + " s"});
    if (!plant.outputs.empty()) result.outputs.push_back({"int_" + of.name, of.unit + " s"});
  }
  for (size_t k = 0; k < plant.period(); ++k) {
    result.A[k] = MatrixXd::Identity(nx + ni, nx + ni);
    result.A[k].topLeftCorner(nx, nx) = plant.A[k];
    result.A[k].bottomLeftCorner(ni, nx) = plant.dt * integrated;
    result.B[k] = MatrixXd::Zero(nx + ni, nu);
    result.B[k].topRows(nx) = plant.B[k];
  }
  result.C = MatrixXd::Zero(ny + ni, nx + ni);
  result.C.topLeftCorner(ny, nx) = plant.C;
  result.C.bottomLeftCorner(ni, nx) = now * plant.dt * integrated;
  result.C.bottomRightCorner(ni, ni).setIdentity();
  return result;
}

MarginPenalty margin_penalty(const Eigen::MatrixXcd& response, const Eigen::RowVectorXd& F,
                             const MarginBounds& bounds) {
  if (response.rows() != F.size())
    throw InvalidInput(kWhere, fmt::format("the response has {} outputs, expected {}, one for each "
                                           "gain",
                                           response.rows(), F.size()));
  MarginPenalty result;
  result.slope = Eigen::RowVectorXd::Zero(F.size());
  for (Index i = 0; i < response.cols(); ++i) {
    const Eigen::VectorXcd G = response.col(i);
    const std::complex<double> L = (F * G)(0);
    const std::complex<double> plus = 1.0 + L, minus = 1.0 - L;
    const double p = std::abs(plus), m = std::abs(minus);
    if (!std::isfinite(p) || !(p > 0)) continue;
    // ∂|1 ± L|/∂F = ±Re(conj(1 ± L) G)/|1 ± L|
    const Eigen::RowVectorXd dp = (std::conj(plus) * G).real().transpose() / p;
    if (const double c = 1 - bounds.Ms * p; c > 0) {
      result.penalty += c * c;
      result.slope -= 2 * c * bounds.Ms * dp;
    }
    if (const double c = bounds.disk * m / 2 - p; c > 0 && m > 0) {
      result.penalty += c * c;
      const Eigen::RowVectorXd dm = -(std::conj(minus) * G).real().transpose() / m;
      result.slope += 2 * c * (bounds.disk / 2 * dm - dp);
    }
  }
  return result;
}

}  // namespace quadtune
