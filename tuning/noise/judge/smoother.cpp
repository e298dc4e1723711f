// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/smoother.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "noise/autocovariance/sparse_ldl.hpp"
#include "noise/likelihood/prepared_noise.hpp"
#include "quadtune/tuning/innovation_likelihood.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::SparseMatrix;
using Eigen::VectorXd;
using internal::PreparedModel;
using internal::PreparedTransition;
using internal::SparseLdl;

/// The system of one record. The unknowns of each instant are the multipliers of the step to it,
/// and its state.
class System {
 public:
  System(const PreparedModel& prepared, const VectorXd& theta)
      : prepared_(prepared),
        record_(prepared.records[0]),
        nx_(prepared.model.A.rows()),
        N_(record_.samples()) {
    const std::vector<double> factors = internal::noise_factors(prepared.model.Q, theta.data());
    const auto add_noise = [&](MatrixXd Q, const std::vector<MatrixXd>& shapes) {
      for (std::size_t s = 0; s < shapes.size(); ++s) Q += factors[s] * shapes[s];
      noises_.push_back(std::move(Q));
    };
    for (const PreparedTransition& step : prepared.transitions) add_noise(step.fixed, step.shapes);
    for (const LinearizedInstant& at : record_.linearized)
      add_noise(MatrixXd::Zero(nx_, nx_), at.noise);
    for (std::size_t s = 0; s < prepared.model.sensors.size(); ++s) {
      const FilterSensor& sensor = prepared.model.sensors[s];
      R_.push_back(covariance(sensor.R, theta));
    }
    x0_ = record_.start ? record_.start->x : prepared.model.x0;
    for (Index i = 0; i < nx_ && !record_.start; ++i)
      if (prepared.model.diffuse[static_cast<std::size_t>(i)]) diffuse_.push_back(i);
  }

  SmoothedStates solve() {
    SmoothedStates result;
    measure();
    // Diffuse states first have a prior of a finite width, which is then removed again; a width of
    // about their own standard deviation minimizes rounding errors.
    VectorXd width = VectorXd::Ones(static_cast<Index>(diffuse_.size()));
    std::optional<SparseLdl> ldl;
    MatrixXd columns, V;
    for (int round = 0; round <= kMaxRounds; ++round) {
      P0_ = record_.start ? record_.start->P : prepared_.model.P0;
      for (std::size_t d = 0; d < diffuse_.size(); ++d)
        P0_(diffuse_[d], diffuse_[d]) = width(static_cast<Index>(d));
      ldl.emplace(matrix());
      if (!ldl->factored()) return singular(result, ldl->bad_row());
      if (diffuse_.empty()) break;
      columns = columns_of(*ldl);
      V = at_start(columns);
      Index narrow = -1;
      for (Index d = 0; d < width.size(); ++d)
        if (V(d, d) > 0.5 * width(d)) {
          width(d) *= 1e3;
          narrow = d;
        }
      if (narrow < 0) break;
      if (round == kMaxRounds)
        return singular(result, state(0) + diffuse_[static_cast<std::size_t>(narrow)]);
    }
    result.x = states(ldl->solve(right_side()));
    finish(*ldl, result, columns, V, width);
    return result;
  }

 private:
  /// Maximum number of times that a prior is widened, by 1e3 each. A state that the measurements
  /// still do not determine after that is not observable.
  static constexpr int kMaxRounds = 5;

  [[nodiscard]] Index multiplier(Index k) const { return 2 * nx_ * k; }
  [[nodiscard]] Index state(Index k) const { return 2 * nx_ * k + nx_; }
  [[nodiscard]] bool linearized() const { return !record_.linearized.empty(); }
  [[nodiscard]] const LinearizedInstant& instant(Index k) const {
    return record_.linearized[static_cast<std::size_t>(k)];
  }
  [[nodiscard]] std::uint32_t transition(Index k) const {
    return linearized() ? static_cast<std::uint32_t>(k)
                        : prepared_.prepared[0].transition[static_cast<std::size_t>(k)];
  }
  /// From instant k to the next: x⁺ = F x + moved.
  [[nodiscard]] const MatrixXd& F(Index k) const {
    return linearized() ? instant(k).F : prepared_.transitions[transition(k)].F;
  }
  [[nodiscard]] VectorXd moved(Index k) const {
    if (linearized()) return instant(k).offset;
    return prepared_.transitions[transition(k)].B * record_.u.col(k);
  }
  [[nodiscard]] const MatrixXd& noise(Index k) const {
    return k == 0 ? P0_ : noises_[transition(k - 1)];
  }

  /// Information of the measurements of each instant: Cᵀ R⁻¹ C and Cᵀ R⁻¹ (y - D u).
  void measure() {
    information_.assign(static_cast<std::size_t>(N_), MatrixXd::Zero(nx_, nx_));
    pull_ = MatrixXd::Zero(nx_, N_);
    for (Index k = 0; k < N_; ++k)
      each_sample(k, [&](const MatrixXd& C, const VectorXd& y, const Eigen::LLT<MatrixXd>& R) {
        information_[static_cast<std::size_t>(k)] += C.transpose() * R.solve(C);
        pull_.col(k) += C.transpose() * R.solve(y);
        const MatrixXd L = R.matrixL();
        log_R_ += 2 * L.diagonal().array().log().sum();
        measured_ += y.size();
      });
  }

  /// The measured outputs of each sensor at an instant: C, y - D u, R.
  template <class Function>
  void each_sample(Index k, Function&& function) const {
    for (std::size_t s = 0; s < prepared_.model.sensors.size(); ++s) {
      const FilterSensor& sensor = prepared_.model.sensors[s];
      std::vector<Index> rows;
      for (Index i = 0; i < sensor.C.rows(); ++i)
        if (!std::isnan(record_.y(prepared_.first_output[s] + i, k))) rows.push_back(i);
      if (rows.empty()) continue;
      const MatrixXd C = linearized()
                             ? MatrixXd(instant(k).C.middleRows(prepared_.first_output[s],
                                                                sensor.C.rows())(rows, Eigen::all))
                             : MatrixXd(sensor.C(rows, Eigen::all));
      VectorXd y(static_cast<Index>(rows.size()));
      for (Index i = 0; i < y.size(); ++i)
        y(i) = record_.y(prepared_.first_output[s] + rows[static_cast<std::size_t>(i)], k);
      if (sensor.D.size() > 0) y -= sensor.D(rows, Eigen::all) * record_.u.col(k);
      const Eigen::LLT<MatrixXd> R(MatrixXd(R_[s](rows, rows)));
      function(C, y, R);
    }
  }

  [[nodiscard]] SparseMatrix<double> matrix() const {
    std::vector<Eigen::Triplet<double>> entries;
    const auto put = [&](Index row, Index col, const MatrixXd& block) {
      for (Index j = 0; j < nx_; ++j)
        for (Index i = 0; i < nx_; ++i)
          if (row + i >= col + j) entries.emplace_back(row + i, col + j, block(i, j));
    };
    for (Index k = 0; k < N_; ++k) {
      put(multiplier(k), multiplier(k), -noise(k));
      put(state(k), state(k), information_[static_cast<std::size_t>(k)]);
      for (Index i = 0; i < nx_; ++i) entries.emplace_back(state(k) + i, multiplier(k) + i, 1);
      if (k + 1 < N_) put(multiplier(k + 1), state(k), -F(k));
    }
    SparseMatrix<double> lower(2 * nx_ * N_, 2 * nx_ * N_);
    lower.setFromTriplets(entries.begin(), entries.end());
    return lower;
  }

  [[nodiscard]] VectorXd right_side() const {
    VectorXd b(2 * nx_ * N_);
    for (Index k = 0; k < N_; ++k) {
      b.segment(multiplier(k), nx_) = k == 0 ? x0_ : moved(k - 1);
      b.segment(state(k), nx_) = pull_.col(k);
    }
    return b;
  }

  [[nodiscard]] MatrixXd states(const VectorXd& solution) const {
    MatrixXd x(nx_, N_);
    for (Index k = 0; k < N_; ++k) x.col(k) = solution.segment(state(k), nx_);
    return x;
  }

  /// Covariances of all states with the diffuse states at the start.
  [[nodiscard]] MatrixXd columns_of(const SparseLdl& ldl) const {
    MatrixXd columns(nx_ * N_, static_cast<Index>(diffuse_.size()));
    for (std::size_t d = 0; d < diffuse_.size(); ++d) {
      VectorXd unit = VectorXd::Zero(2 * nx_ * N_);
      unit(state(0) + diffuse_[d]) = 1;
      columns.col(static_cast<Index>(d)) = states(ldl.solve(unit)).reshaped();
    }
    return columns;
  }

  [[nodiscard]] MatrixXd at_start(const MatrixXd& columns) const {
    MatrixXd V(columns.cols(), columns.cols());
    for (Index d = 0; d < V.rows(); ++d)
      V.row(d) = columns.row(diffuse_[static_cast<std::size_t>(d)]);
    return 0.5 * (V + V.transpose());
  }

  /// Twice the cost at the states x, whose steps must be in the range of Q.
  [[nodiscard]] double residual(const MatrixXd& x, const VectorXd& solution) const {
    double sum = 0;
    for (Index k = 0; k < N_; ++k) {
      const VectorXd multipliers = solution.segment(multiplier(k), nx_);
      sum += multipliers.dot(noise(k) * multipliers);
      each_sample(k, [&](const MatrixXd& C, const VectorXd& y, const Eigen::LLT<MatrixXd>& R) {
        const VectorXd e = y - C * x.col(k);
        sum += e.dot(R.solve(e));
      });
    }
    return sum;
  }

  void finish(const SparseLdl& ldl, SmoothedStates& result, const MatrixXd& columns,
              const MatrixXd& V, const VectorXd& width) {
    const VectorXd solution = ldl.solve(right_side());
    double value = -0.5 * (static_cast<double>(measured_) * std::log(2 * std::numbers::pi) +
                           ldl.log_determinant() + log_R_ + residual(result.x, solution));
    const SparseMatrix<double> inverse = ldl.inverse_on_pattern();
    result.P.resize(nx_, nx_ * N_);
    for (Index k = 0; k < N_; ++k)
      for (Index j = 0; j < nx_; ++j)
        for (Index i = 0; i < nx_; ++i)
          result.P(i, nx_ * k + j) =
              inverse.coeff(state(k) + std::max(i, j), state(k) + std::min(i, j));
    if (!diffuse_.empty()) {
      // Removing a measurement is adding one of negative variance.
      const MatrixXd left = MatrixXd(width.asDiagonal()) - V;
      const Eigen::LLT<MatrixXd> llt(left);
      if (llt.info() != Eigen::Success) {
        singular(result, state(0) + unseen(left));
        return;
      }
      VectorXd off(width.size());
      for (Index d = 0; d < off.size(); ++d) {
        const Index i = diffuse_[static_cast<std::size_t>(d)];
        off(d) = result.x(i, 0) - x0_(i);
      }
      const VectorXd shift = llt.solve(off);
      const MatrixXd L = llt.matrixL();
      value +=
          0.5 * (width.array().log().sum() +
                 static_cast<double>(width.size()) * std::log(2 * std::numbers::pi) +
                 off.dot(shift) + width.array().log().sum() - 2 * L.diagonal().array().log().sum());
      result.x += (columns * shift).reshaped(nx_, N_);
      for (Index k = 0; k < N_; ++k) {
        const MatrixXd K = columns.middleRows(nx_ * k, nx_);
        result.P.middleCols(nx_ * k, nx_) += K * llt.solve(K.transpose());
      }
    }
    result.log_likelihood = value;
    result.status = std::isfinite(value) && result.x.allFinite() && result.P.allFinite()
                        ? SmootherStatus::solved
                        : SmootherStatus::overflowed;
  }

  [[nodiscard]] Index unseen(const MatrixXd& left) const {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(left);
    Index worst = 0;
    eigen.eigenvectors().col(0).cwiseAbs().maxCoeff(&worst);
    return diffuse_[static_cast<std::size_t>(worst)];
  }

  SmoothedStates& singular(SmoothedStates& result, Index row) const {
    const Index k = row / (2 * nx_);
    const Index i = row % nx_;
    result = {};
    result.status = SmootherStatus::singular;
    result.culprit =
        fmt::format("{}: state '{}' at {} s is known exactly or not observable", record_.name,
                    prepared_.model.states[static_cast<std::size_t>(i)].name,
                    record_.time[static_cast<std::size_t>(k)]);
    return result;
  }

  const PreparedModel& prepared_;
  const FilterRecord& record_;
  Index nx_, N_;
  std::vector<MatrixXd> noises_, R_, information_;
  MatrixXd pull_, P0_;
  VectorXd x0_;
  std::vector<Index> diffuse_;
  double log_R_ = 0;
  Index measured_ = 0;
};

}  // namespace

SmoothedStates smooth(const FilterModel& model, const Eigen::Ref<const Eigen::VectorXd>& theta,
                      const FilterRecord& record) {
  // Validates the input in the same way.
  const InnovationLikelihood checked(model, {record});
  const PreparedModel prepared(model, {record});
  return System(prepared, theta).solve();
}

}  // namespace quadtune
