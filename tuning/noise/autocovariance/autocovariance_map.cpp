// SPDX-License-Identifier: Apache-2.0
#include "noise/autocovariance/autocovariance_map.hpp"

#include <algorithm>
#include <cmath>

#include "noise/likelihood/prepared_model.hpp"
#include "quadtune/synthesis/lyapunov.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Inserts the covariance of one sensor at the indices of its outputs among those in use.
MatrixXd placed(const MatrixXd& of_sensor, Index first, const std::vector<Index>& outputs) {
  const auto ny = static_cast<Index>(outputs.size());
  MatrixXd result = MatrixXd::Zero(ny, ny);
  const auto inside = [&](Index i) { return i >= first && i < first + of_sensor.rows(); };
  for (Index a = 0; a < ny; ++a)
    for (Index b = 0; b < ny; ++b) {
      const Index i = outputs[static_cast<std::size_t>(a)],
                  j = outputs[static_cast<std::size_t>(b)];
      if (inside(i) && inside(j)) result(a, b) = of_sensor(i - first, j - first);
    }
  return result;
}

void add_process_terms(const FilterModel& model, const PreparedTransition& step,
                       SampledModel& sampled) {
  const MatrixXd none = MatrixXd::Zero(sampled.C.rows(), sampled.C.rows());
  auto shape = step.shapes.begin();
  for (const ScaledCovariance& term : model.Q.scaled)
    sampled.terms.push_back({term.parameter, -1, 0, *shape++, none});
  for (const FullCovariance& term : model.Q.full)
    for (int i = 0; i < static_cast<int>(term.entries.size()); ++i)
      for (int j = 0; j <= i; ++j)
        sampled.terms.push_back({term.first_parameter, i, j, *shape++, none});
}

void add_sensor_terms(const FilterSensor& sensor, Index first, SampledModel& sampled) {
  const MatrixXd none = MatrixXd::Zero(sampled.F.rows(), sampled.F.rows());
  sampled.R += placed(sensor.R.fixed, first, sampled.outputs);
  for (const ScaledCovariance& term : sensor.R.scaled)
    sampled.terms.push_back(
        {term.parameter, -1, 0, none, placed(term.shape, first, sampled.outputs)});
  for (const FullCovariance& term : sensor.R.full)
    for (int i = 0; i < static_cast<int>(term.entries.size()); ++i)
      for (int j = 0; j <= i; ++j) {
        MatrixXd unit = MatrixXd::Zero(sensor.R.size(), sensor.R.size());
        const int a = term.entries[static_cast<std::size_t>(i)];
        const int b = term.entries[static_cast<std::size_t>(j)];
        unit(a, b) = unit(b, a) = 1;
        sampled.terms.push_back(
            {term.first_parameter, i, j, none, placed(unit, first, sampled.outputs)});
      }
}

/// Covariance of the prediction error; empty if F (I - M C) is not stable.
MatrixXd prediction_covariance(const SampledModel& model, const MatrixXd& M, const MatrixXd& Q,
                               const MatrixXd& R) {
  const MatrixXd L = model.F * M;
  const MatrixXd closed = model.F - L * model.C;
  MatrixXd noise = Q + L * R * L.transpose();
  noise = (0.5 * (noise + noise.transpose())).eval();
  const LyapunovResult solution = lyapunov_discrete(closed, noise);
  return solution.solved() ? solution.X : MatrixXd();
}

std::vector<MatrixXd> autocovariances_of(const SampledModel& model, const MatrixXd& M,
                                         const MatrixXd& P, const MatrixXd& R, int lags) {
  const MatrixXd L = model.F * M;
  const MatrixXd closed = model.F - L * model.C;
  std::vector<MatrixXd> result;
  result.reserve(static_cast<std::size_t>(lags) + 1);
  result.push_back(model.C * P * model.C.transpose() + R);
  MatrixXd moved = closed * P * model.C.transpose() - L * R;
  for (int j = 1; j <= lags; ++j) {
    result.push_back(model.C * moved);
    moved = (closed * moved).eval();
  }
  return result;
}

}  // namespace

SampledModel sample_model(const FilterModel& model, double dt, const std::vector<Index>& outputs) {
  const PreparedTransition step = prepare_transition(model, dt);
  const auto ny = static_cast<Index>(outputs.size());
  SampledModel sampled;
  sampled.dt = dt;
  sampled.outputs = outputs;
  sampled.F = step.F;
  sampled.C.resize(ny, model.A.rows());
  sampled.D = MatrixXd::Zero(ny, model.B.cols());
  sampled.Q = step.fixed;
  sampled.R = MatrixXd::Zero(ny, ny);
  add_process_terms(model, step, sampled);
  Index first = 0;
  for (const FilterSensor& sensor : model.sensors) {
    for (Index a = 0; a < ny; ++a) {
      const Index i = outputs[static_cast<std::size_t>(a)] - first;
      if (i < 0 || i >= sensor.C.rows()) continue;
      sampled.C.row(a) = sensor.C.row(i);
      if (sensor.D.size() > 0) sampled.D.row(a) = sensor.D.row(i);
    }
    add_sensor_terms(sensor, first, sampled);
    first += sensor.C.rows();
  }
  return sampled;
}

VectorXd term_values(const SampledModel& model, const VectorXd& theta) {
  VectorXd values(static_cast<Index>(model.terms.size()));
  for (Index t = 0; t < values.size(); ++t) {
    const NoiseTerm& term = model.terms[static_cast<std::size_t>(t)];
    values(t) = term.row < 0 ? std::exp(theta(term.parameter))
                             : full_entry(theta.data() + term.parameter, term.row, term.column);
  }
  return values;
}

std::pair<MatrixXd, MatrixXd> noise_at(const SampledModel& model, const VectorXd& theta) {
  const VectorXd values = term_values(model, theta);
  std::pair<MatrixXd, MatrixXd> noise(model.Q, model.R);
  for (std::size_t t = 0; t < model.terms.size(); ++t) {
    noise.first += values(static_cast<Index>(t)) * model.terms[t].Q;
    noise.second += values(static_cast<Index>(t)) * model.terms[t].R;
  }
  return noise;
}

std::vector<MatrixXd> autocovariances(const SampledModel& model, const MatrixXd& M,
                                      const MatrixXd& Q, const MatrixXd& R, int lags) {
  const MatrixXd P = prediction_covariance(model, M, Q, R);
  if (P.size() == 0) return {};
  return autocovariances_of(model, M, P, R, lags);
}

LagGroups lag_groups(int last, int count) {
  LagGroups groups;
  for (double ratio = 1; groups.empty() || static_cast<int>(groups.size()) > count; ratio += 0.01) {
    groups.clear();
    for (int first = 1; first <= last;) {
      const int next = std::max(first + 1, static_cast<int>(std::lround(first * ratio)));
      groups.emplace_back(first, std::min(next - 1, last));
      first = next;
    }
  }
  return groups;
}

VectorXd moments_of(const std::vector<MatrixXd>& lags, const LagGroups& groups) {
  const Index ny = lags.front().rows();
  VectorXd moments(ny * (ny + 1) / 2 + static_cast<Index>(groups.size()) * ny * ny);
  Index at = 0;
  for (Index b = 0; b < ny; ++b)
    for (Index a = b; a < ny; ++a) moments(at++) = lags[0](a, b);
  for (const auto& [first, last] : groups) {
    MatrixXd mean = MatrixXd::Zero(ny, ny);
    for (int j = first; j <= last; ++j) mean += lags[static_cast<std::size_t>(j)];
    mean /= last - first + 1;
    moments.segment(at, ny * ny) = mean.reshaped();
    at += ny * ny;
  }
  return moments;
}

MatrixXd moment_covariance(const std::vector<MatrixXd>& gamma, const LagGroups& groups,
                           const std::vector<double>& pairs) {
  const Index ny = gamma.front().rows();
  const auto T = static_cast<Index>(gamma.size()) - 1;
  const auto last = static_cast<Index>(groups.empty() ? 0 : groups.back().second);
  // Column τ + T: Γ(τ) = E e[t + τ] e[t]ᵀ.
  MatrixXd all(ny * ny, 2 * T + 1);
  for (Index tau = -T; tau <= T; ++tau) {
    const MatrixXd& of = gamma[static_cast<std::size_t>(std::abs(tau))];
    all.col(tau + T) = tau < 0 ? of.transpose().reshaped().eval() : of.reshaped().eval();
  }
  // X(s) = Σ_τ Γ_xy(τ + s) Γ_zw(τ), s = -last … 2 last.
  std::vector<MatrixXd> X;
  X.reserve(static_cast<std::size_t>(3 * last + 1));
  for (Index s = -last; s <= 2 * last; ++s) {
    const Index count = all.cols() - std::abs(s);
    if (count <= 0)
      X.push_back(MatrixXd::Zero(ny * ny, ny * ny));
    else
      X.push_back(all.middleCols(std::max<Index>(s, 0), count) *
                  all.middleCols(std::max<Index>(-s, 0), count).transpose());
  }
  struct Moment {
    Index a, b;
    int first, last;
  };
  std::vector<Moment> moments;
  for (Index b = 0; b < ny; ++b)
    for (Index a = b; a < ny; ++a) moments.push_back({a, b, 0, 0});
  for (const auto& [first, final] : groups)
    for (Index b = 0; b < ny; ++b)
      for (Index a = 0; a < ny; ++a) moments.push_back({a, b, first, final});
  std::vector<double> share;
  share.reserve(pairs.size());
  for (const double count : pairs) share.push_back(1 / std::sqrt(count));
  const auto m = static_cast<Index>(moments.size());
  MatrixXd covariance(m, m);
  for (Index p = 0; p < m; ++p)
    for (Index q = 0; q <= p; ++q) {
      const auto& [a, b, j0, j1] = moments[static_cast<std::size_t>(p)];
      const auto& [c, d, l0, l1] = moments[static_cast<std::size_t>(q)];
      double sum = 0;
      for (int j = j0; j <= j1; ++j)
        for (int l = l0; l <= l1; ++l) {
          const MatrixXd& straight = X[static_cast<std::size_t>(j - l + last)];
          const MatrixXd& crossed = X[static_cast<std::size_t>(j + l + last)];
          sum += (straight(a + ny * c, b + ny * d) + crossed(a + ny * d, b + ny * c)) *
                 share[static_cast<std::size_t>(j)] * share[static_cast<std::size_t>(l)];
        }
      covariance(p, q) = covariance(q, p) = sum / ((j1 - j0 + 1) * (l1 - l0 + 1));
    }
  return covariance;
}

MomentMap moment_map(const SampledModel& model, const MatrixXd& M, const LagGroups& groups) {
  const int lags = groups.empty() ? 0 : groups.back().second;
  const std::vector<MatrixXd> fixed = autocovariances(model, M, model.Q, model.R, lags);
  MomentMap map;
  if (fixed.empty()) return map;
  map.constant = moments_of(fixed, groups);
  map.of.resize(map.constant.size(), static_cast<Index>(model.terms.size()));
  for (std::size_t t = 0; t < model.terms.size(); ++t) {
    const NoiseTerm& term = model.terms[t];
    const MatrixXd P = prediction_covariance(model, M, term.Q, term.R);
    if (P.size() == 0) return {};
    const auto column = static_cast<Index>(t);
    map.of.col(column) = moments_of(autocovariances_of(model, M, P, term.R, lags), groups);
    // Set contributions that are only rounding errors to zero.
    const MatrixXd size = model.C.cwiseAbs() * P.cwiseAbs() * model.C.cwiseAbs().transpose();
    if (term.R.isZero(0) && map.of.col(column).cwiseAbs().maxCoeff() <= 1e-13 * size.maxCoeff())
      map.of.col(column).setZero();
  }
  return map;
}

}  // namespace quadtune::internal
