// SPDX-License-Identifier: Apache-2.0
/// The filter with the constant gains of a converged covariance: linear maps of a block of samples,
/// so that the latency of the state recursion occurs once per block.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "noise/likelihood/convergence.hpp"
#include "noise/likelihood/engine_model.hpp"
#include "noise/likelihood/sensitivities.hpp"

namespace quadtune::internal {

/// Whether P, and P' of each parameter if they are computed, have converged.
template <int N>
class SteadyTest {
 public:
  bool reached(const Square<N>& P, const Sensitivities<N>* sensitivities) {
    double change = change_of(P, before_, P);
    before_ = P;
    if (sensitivities != nullptr) {
      slopes_before_.resize(sensitivities->slopes.size());
      for (std::size_t a = 0; a < slopes_before_.size(); ++a) {
        const Square<N>& slope = sensitivities->slopes[a].P;
        change = std::max(change, change_of(slope, slopes_before_[a], P));
        slopes_before_[a] = slope;
      }
    }
    return std::exchange(known_, true) && convergence_.reached(change);
  }

 private:
  /// Change relative to the standard deviations; infinite if one of them is 0.
  static double change_of(const Square<N>& now, const Square<N>& before, const Square<N>& P) {
    double max = 0;
    for (int j = 0; j < N; ++j)
      for (int i = j; i < N; ++i) {
        const double change = std::abs(now(i, j) - before(i, j));
        if (change > 0) max = std::max(max, change / std::sqrt(P(i, i) * P(j, j)));
      }
    return max;
  }

  Square<N> before_;
  std::vector<Square<N>> slopes_before_;
  bool known_ = false;
  Convergence convergence_;
};

/// Gains that are held constant for some samples. Innovations are normalized, ē = e/√S. Their rows
/// and those of the state are padded, so that vectors do not cross cache lines.
template <int N>
struct SteadyState {
  std::uint32_t transition = 0;
  Eigen::Index samples = 0;  ///< a multiple of `block`
  Eigen::Index block = 1;    ///< samples per application of the maps: at least four innovations
  Eigen::Index ny = 0, nu = 0;
  std::vector<Column<N>> K;        ///< ny
  std::vector<double> S;           ///< ny
  std::vector<Column<N>> K_slope;  ///< K' and S' of output i for parameter a: [i p + a]
  std::vector<double> S_slope;

  Eigen::MatrixXd forward;                     ///< [ē; x⁺] of [y; u; x]
  std::vector<Eigen::MatrixXd> forward_slope;  ///< p times [e'/√S; x'⁺] of [y; u; x; x']
  Eigen::MatrixXd backward;                    ///< [u; r of each sample, last first] of [ē; r]
  Square<N> backward_step;                     ///< r before one sample, of r after it

  [[nodiscard]] Eigen::Index innovation_rows() const { return (block * ny + 3) / 4 * 4; }
  /// @param n  number of rows after the innovations
  [[nodiscard]] Eigen::Index rows(Eigen::Index n) const {
    return (innovation_rows() + n + 7) / 8 * 8;
  }

  /// Calls f(number of outputs, of inputs of a block): compile-time constants for two states and
  /// one output, for which a sample takes only a few instructions; otherwise -1.
  template <class Function>
  void with_sizes(Function&& f) const {
    using std::integral_constant;
    if constexpr (N == 2) {
      if (ny == 1 && nu == 0) return f(integral_constant<int, 4>(), integral_constant<int, 0>());
      if (ny == 1 && nu == 1) return f(integral_constant<int, 4>(), integral_constant<int, 4>());
    }
    f(integral_constant<int, -1>(), integral_constant<int, -1>());
  }

  /// Computes the forward maps from the response of the filter to unit vectors.
  void fill_forward(const EngineModel<N>& model, Sensitivities<N>* sensitivities) {
    const std::size_t p = sensitivities == nullptr ? 0 : sensitivities->slopes.size();
    const Eigen::Index e_rows = innovation_rows(), inputs = block * (ny + nu);
    forward.setZero(rows(N), inputs + N);
    forward_slope.assign(p, {});
    for (Eigen::MatrixXd& map : forward_slope)
      map.setZero(forward.rows(), inputs + Eigen::Index{2} * N);
    std::vector<double> unit(static_cast<std::size_t>(inputs + N));
    std::vector<Column<N>> x_slope(p);
    for (Eigen::Index column = 0; column < inputs + N; ++column) {
      std::fill(unit.begin(), unit.end(), 0);
      unit[static_cast<std::size_t>(column)] = 1;
      const double *y = unit.data(), *u = y + block * ny;
      Column<N> x;
      std::copy_n(unit.data() + inputs, N, x.at);
      std::fill(x_slope.begin(), x_slope.end(), Column<N>());
      for (Eigen::Index sample = 0; sample < block; ++sample, y += ny, u += nu)
        forward_sample(model, sensitivities, y, u, x, x_slope, sample * ny, column);
      std::copy_n(x.at, N, forward.col(column).data() + e_rows);
      for (std::size_t a = 0; a < p; ++a)
        std::copy_n(x_slope[a].at, N, forward_slope[a].col(column).data() + e_rows);
    }
    for (Eigen::MatrixXd& map : forward_slope) map.rightCols(N) = forward.rightCols(N);
  }

  /// Likewise for the adjoint in adjoint_pass.hpp.
  void fill_backward(const EngineModel<N>& model) {
    const Eigen::Index e_rows = innovation_rows(), inputs = block * ny;
    backward.setZero(rows(block * N), inputs + N);
    for (Eigen::Index column = 0; column < inputs + N; ++column) {
      Column<N> r;
      if (column >= inputs) r.at[column - inputs] = 1;
      double* to = backward.col(column).data();
      for (Eigen::Index sample = block; sample-- > 0;) {
        Column<N> before;
        multiply<N>(model.transitions[transition].F_transposed, r.at, before.at);
        for (Eigen::Index i = ny; i-- > 0;) {
          const auto q = static_cast<std::size_t>(i);
          const double normalized = column == sample * ny + i ? 1 : 0;
          const double u = normalized / std::sqrt(S[q]) - dot<N>(K[q].at, before.at);
          to[sample * ny + i] = u;
          model.C[q].add_to(before.at, u);
        }
        r = before;
        std::copy_n(r.at, N, to + e_rows + (block - 1 - sample) * N);
      }
      if (column >= inputs) std::copy_n(to + e_rows, N, backward_step.column(column - inputs));
    }
  }

 private:
  void forward_sample(const EngineModel<N>& model, Sensitivities<N>* sensitivities, const double* y,
                      const double* u, Column<N>& x, std::vector<Column<N>>& x_slope,
                      Eigen::Index row, Eigen::Index column) {
    const Transition<N>& step = model.transitions[transition];
    double z[kMaxOutputs];
    for (Eigen::Index i = 0; i < ny; ++i) {
      const auto q = static_cast<std::size_t>(i);
      const SparseRow<N> c = model.C[q];
      const double e = model.measurement(i, y, u, z) - c.dot(x.at), root = std::sqrt(S[q]);
      forward(row + i, column) = e / root;
      if (!x_slope.empty()) sensitivities->whiten(i, model.L, z);
      for (std::size_t a = 0; a < x_slope.size(); ++a) {
        const double e_slope = sensitivities->innovation(a, i, c, x.at, x_slope[a].at);
        forward_slope[a](row + i, column) = e_slope / root;
        add_scaled<N>(e_slope, K[q].at, x_slope[a].at);
        add_scaled<N>(e, K_slope[q * x_slope.size() + a].at, x_slope[a].at);
      }
      add_scaled<N>(e, K[q].at, x.at);
    }
    const auto advance = [&](Column<N>& state) {
      Column<N> next;
      multiply<N>(step.F, state.at, next.at);
      state = next;
    };
    advance(x);
    for (Column<N>& slope : x_slope) advance(slope);
    for (Eigen::Index j = 0; j < nu; ++j)
      add_scaled<N>(u[j], step.B[static_cast<std::size_t>(j)].at, x.at);
  }
};

}  // namespace quadtune::internal
