// SPDX-License-Identifier: Apache-2.0
#include "noise/autocovariance/steady_innovations.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>

#include "noise/likelihood/prepared_model.hpp"
#include "quadtune/synthesis/kalman.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Largest remaining effect of the initial state, relative to the standard deviation of an
/// innovation.
constexpr double kForgotten = 0.02;
/// Maximum number of samples from which the initial state of a stretch is estimated.
constexpr Index kMaxOfStart = 20000;

MatrixXd root_of(const MatrixXd& P) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(P);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
}

/// Number of samples until S^-½ C (F (I - M C))ⁿ P^½ is small; `most` + 1 if it takes longer.
Index memory_of(const SampledModel& model, const MatrixXd& M, const MatrixXd& P, const MatrixXd& S,
                Index max) {
  const Eigen::LLT<MatrixXd> factor(S);
  if (factor.info() != Eigen::Success) return max + 1;
  const MatrixXd root = root_of(P);
  const MatrixXd closed = model.F - model.F * M * model.C;
  MatrixXd seen = factor.matrixL().solve(model.C);
  for (Index n = 0; n <= max; ++n) {
    if ((seen * root).norm() <= kForgotten) return n;
    seen = (seen * closed).eval();
  }
  return max + 1;
}

/// One step of time between two instants of a record.
struct Step {
  MatrixXd F, B;
};

/// Steps by their length; each is computed once.
class Steps {
 public:
  explicit Steps(const FilterModel& model) : model_(model) {}

  const Step& of(double dt) {
    const std::int64_t key = step_key(model_, dt);
    if (last_ != nullptr && key == last_key_) return *last_;
    const auto [found, is_new] = known_.try_emplace(key);
    if (is_new) {
      PreparedTransition prepared = prepare_transition(model_, step_of_key(model_, key));
      found->second = {std::move(prepared.F), std::move(prepared.B)};
    }
    last_key_ = key;
    last_ = &found->second;
    return *last_;
  }

 private:
  const FilterModel& model_;
  std::map<std::int64_t, Step> known_;
  std::int64_t last_key_ = 0;
  const Step* last_ = nullptr;
};

/// The predictor over one stretch.
class Predictor {
 public:
  Predictor(const SampledModel& sampled, const FilterModel& model,
            const std::vector<FilterRecord>& records, const SteadyGain& gain)
      : sampled_(sampled), records_(records), gain_(gain), steps_(model) {}

  /// Innovations (ny × samples) from the state x before the first measurement.
  SampleMatrix innovations(const UniformStretch& stretch, VectorXd x) {
    const FilterRecord& record = records_[stretch.record];
    const auto ny = sampled_.C.rows();
    const bool has_input = record.u.rows() > 0;
    SampleMatrix e(ny, stretch.samples);
    VectorXd moved(x.size());
    Index n = 0;
    for (Index k = stretch.first; k <= stretch.last; ++k) {
      if (is_measured(record, k, sampled_.outputs)) {
        auto now = e.col(n++);
        for (Index a = 0; a < ny; ++a)
          now(a) = record.y(sampled_.outputs[static_cast<std::size_t>(a)], k);
        now.noalias() -= sampled_.C * x;
        if (has_input) now.noalias() -= sampled_.D * record.u.col(k);
        x.noalias() += gain_.M * now;
      }
      if (k == stretch.last) break;
      const auto at = static_cast<std::size_t>(k);
      const Step& step = steps_.of(record.time[at + 1] - record.time[at]);
      moved.noalias() = step.F * x;
      if (has_input) moved.noalias() += step.B * record.u.col(k);
      x.swap(moved);
    }
    return e;
  }

  /// Estimates the state before the first measurement by minimizing the first innovations.
  VectorXd start(const UniformStretch& stretch) {
    const auto nx = sampled_.F.rows(), ny = sampled_.C.rows();
    UniformStretch first = stretch;
    first.samples = std::min({stretch.samples, kMaxOfStart, std::max(gain_.memory, nx)});
    if (first.samples < stretch.samples) first.last = instant_of(stretch, first.samples);
    const Eigen::LLT<MatrixXd> S(gain_.S);
    MatrixXd e = innovations(first, VectorXd::Zero(nx));
    S.matrixL().solveInPlace(e);
    MatrixXd map(e.size(), nx);
    const MatrixXd closed = sampled_.F - sampled_.F * gain_.M * sampled_.C;
    MatrixXd seen = S.matrixL().solve(sampled_.C);
    for (Index n = 0; n < first.samples; ++n) {
      map.middleRows(n * ny, ny) = seen;
      seen = (seen * closed).eval();
    }
    return Eigen::CompleteOrthogonalDecomposition<MatrixXd>(map).solve(e.reshaped());
  }

 private:
  /// The instant of the measurement with this number.
  Index instant_of(const UniformStretch& stretch, Index number) const {
    Index k = stretch.first;
    for (Index n = 0;; ++k) {
      n += is_measured(records_[stretch.record], k, sampled_.outputs);
      if (n == number) return k;
    }
  }

  const SampledModel& sampled_;
  const std::vector<FilterRecord>& records_;
  const SteadyGain& gain_;
  Steps steps_;
};

}  // namespace

SteadyGain steady_gain(const SampledModel& sampled, const FilterModel& model, const MatrixXd& Q,
                       const MatrixXd& R, Index max) {
  SteadyGain best;
  for (int attempt = 0; attempt < 6; ++attempt) {
    // With the model α F, the poles of the closed loop are inside the unit circle, so those with F
    // are inside 1/α (Anderson and Moore 1979). α follows from the required decay within this
    // number of samples.
    const double alpha =
        attempt == 0
            ? 1
            : std::exp(-std::log(kForgotten) * std::pow(2, attempt - 1) / static_cast<double>(max));
    DiscreteLti hastened;
    hastened.A = alpha * sampled.F;
    hastened.C = sampled.C;
    hastened.dt = sampled.dt;
    hastened.states = model.states;
    const KalmanResult filter = kalman(hastened, {{}, Q, R, {}});
    if (!filter.solved()) {
      if (!best.found) best.culprit = filter.culprit;
      if (filter.status == RiccatiStatus::not_detectable) break;
      continue;
    }
    const MatrixXd S = sampled.C * filter.P * sampled.C.transpose() + R;
    const Index memory = memory_of(sampled, filter.M, filter.P, S, max);
    if (!best.found || memory < best.memory) best = {true, filter.M, S, memory, {}};
    if (memory <= max) break;
  }
  return best;
}

SampleAutocovariances sample_autocovariances(const SampledModel& sampled, const FilterModel& model,
                                             const std::vector<FilterRecord>& records,
                                             const UniformStretches& uniform,
                                             const SteadyGain& gain, int lags) {
  const auto ny = sampled.C.rows();
  const auto count = static_cast<std::size_t>(lags) + 1;
  SampleAutocovariances result{std::vector<MatrixXd>(count, MatrixXd::Zero(ny, ny)),
                               std::vector<double>(count, 0)};
  Predictor predictor(sampled, model, records, gain);
  for (const UniformStretch& stretch : uniform.stretches) {
    const Index used = stretch.samples - gain.memory;
    if (used <= Index{2} * lags || used <= gain.memory) continue;
    const SampleMatrix whole = predictor.innovations(stretch, predictor.start(stretch));
    const auto e = whole.rightCols(used);
    for (Index j = 0; j <= lags; ++j) {
      const auto at = static_cast<std::size_t>(j);
      result.of[at].noalias() += e.rightCols(used - j) * e.leftCols(used - j).transpose();
      result.pairs[at] += static_cast<double>(used - j);
    }
  }
  for (std::size_t j = 0; j < count; ++j)
    if (result.pairs[j] > 0) result.of[j] /= result.pairs[j];
  return result;
}

}  // namespace quadtune::internal
