// SPDX-License-Identifier: Apache-2.0
/// Forward sensitivities: the derivatives of a run of a filter with respect to each parameter, for
/// the information, and for the gradient of models that the adjoint pass does not support.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "noise/likelihood/engine_model.hpp"

namespace quadtune::internal {

/// With ' for the derivative with respect to one parameter, a measurement z = c x + v with gain K,
/// innovation e of variance S changes x' and P' by
///     b = P'cᵀ + P c'ᵀ,  S' = R' + c b + c' P cᵀ,  e' = z' - c' x - c x',
///     x' ← x' + K e' + (b - S' K) e/S,  P' ← P' - h Kᵀ - K hᵀ,  h = b - ½ S' K,
/// and a time step x' ← F x', P' ← F P' Fᵀ + Q'. The information is the sum of
/// ½ (S'/S)(S'/S)ᵀ + e' e'ᵀ/S over all pairs of parameters (Harvey 1989, section 3.4.5).
template <int N>
class Sensitivities {
 public:
  struct Slope {
    Column<N> x;
    Square<N> P;
    // For the measurement for which linearize() was called.
    Column<N> b;
    double S = 0, e = 0, square = 0;  ///< S', e', (e²/S)'
  };

  explicit Sensitivities(ModelSlopes<N> of)
      : slopes(static_cast<std::size_t>(of.R.rows())),
        gradient(Eigen::VectorXd::Zero(of.R.rows())),
        information(Eigen::MatrixXd::Zero(of.R.rows(), of.R.rows())),
        by_(std::move(of)),
        whitened_(Eigen::MatrixXd::Zero(by_.R.rows(), by_.R.cols())),
        variance_(by_.R.rows()),
        innovation_(by_.R.rows()) {}

  std::vector<Slope> slopes;    ///< p
  Eigen::VectorXd gradient;     ///< (p) of the log-likelihood of all records so far
  Eigen::MatrixXd information;  ///< (p × p)

  /// At the beginning of a record the state depends on no parameter.
  void start() {
    for (Slope& slope : slopes) slope = Slope();
  }

  /// z' of EngineModel::measurement(): with z = y - D u - (L - I) z, z' = -L' z - (L - I) z'.
  void whiten(Eigen::Index i, const Eigen::MatrixXd& L, const double* z) {
    for (std::size_t a = 0; a < by_.L.size(); ++a) {
      double sum = 0;
      for (Eigen::Index j = 0; j < i; ++j)
        sum -= by_.L[a](i, j) * z[j] + L(i, j) * whitened_(static_cast<Eigen::Index>(a), j);
      whitened_(static_cast<Eigen::Index>(a), i) = sum;
    }
  }

  /// e' = z' - c' x - c x'
  [[nodiscard]] double innovation(std::size_t a, Eigen::Index i, const SparseRow<N>& c,
                                  const double* x, const double* x_slope) const {
    double e = -c.dot(x_slope);
    if (!by_.C.empty())
      e += whitened_(static_cast<Eigen::Index>(a), i) -
           dot<N>(by_.C[a][static_cast<std::size_t>(i)].at, x);
    return e;
  }

  /// b, S' and e' of a measurement.
  /// @param Pc  P cᵀ
  void linearize(Eigen::Index i, const SparseRow<N>& c, const FilterState<N>& at,
                 const Column<N>& Pc) {
    for (std::size_t a = 0; a < slopes.size(); ++a) {
      Slope& slope = slopes[a];
      slope.b = c.times(slope.P);
      slope.S = by_.R(static_cast<Eigen::Index>(a), i);
      if (!by_.C.empty()) {
        const Column<N>& c_slope = by_.C[a][static_cast<std::size_t>(i)];
        Column<N> P_c_slope;
        multiply<N>(at.P, c_slope.at, P_c_slope.at);
        add_scaled<N>(1, P_c_slope.at, slope.b.at);
        slope.S += dot<N>(c_slope.at, Pc.at);
      }
      slope.S += c.dot(slope.b.at);
      slope.e = innovation(a, i, c, at.x.at, slope.x.at);
    }
  }

  /// @param weight  of a measurement with Student's distribution; 1 if it is normal
  void add_measurement(double e, double S, double weight) {
    const double inverse = 1 / S, root = std::sqrt(inverse);
    for (std::size_t a = 0; a < slopes.size(); ++a) {
      Slope& slope = slopes[a];
      const auto p = static_cast<Eigen::Index>(a);
      variance_(p) = slope.S * inverse;
      innovation_(p) = slope.e * root;
      slope.square = e * inverse * (2 * slope.e - e * variance_(p));
      gradient(p) -= 0.5 * (variance_(p) + weight * slope.square);
    }
    for (Eigen::Index b = 0; b < information.cols(); ++b)
      information.col(b) += (0.5 * variance_(b)) * variance_ + innovation_(b) * innovation_;
  }

  /// S' after R was divided by the weight w = (ν + 1) / (ν + e²/S).
  void reweight(Eigen::Index i, double R, double weight, double freedom) {
    for (std::size_t a = 0; a < slopes.size(); ++a)
      slopes[a].S += by_.R(static_cast<Eigen::Index>(a), i) * (1 / weight - 1) +
                     R * slopes[a].square / (freedom + 1);
  }

  /// @param weighted  e/S; 0 if K does not depend on θ
  void correct(const Column<N>& K, double weighted) {
    for (Slope& slope : slopes) {
      add_scaled<N>(weighted, slope.b.at, slope.x.at);
      add_scaled<N>(slope.e - slope.S * weighted, K.at, slope.x.at);
      add_scaled<N>(-0.5 * slope.S, K.at, slope.b.at);
      add_outer<N>(-1, slope.b.at, K.at, slope.P);
      add_outer<N>(-1, K.at, slope.b.at, slope.P);
    }
  }

  /// @param transition  index, or negative if add_noise() adds Q'
  void predict(const Square<N>& F, std::ptrdiff_t transition) {
    for (std::size_t a = 0; a < slopes.size(); ++a) {
      Column<N> x;
      multiply<N>(F, slopes[a].x.at, x.at);
      slopes[a].x = x;
      propagate<N>(F, slopes[a].P,
                   transition < 0
                       ? nullptr
                       : &by_.Q[static_cast<std::size_t>(transition) * slopes.size() + a]);
    }
  }
  /// Adds the noise of a linearized instant, whose terms are variances with one parameter each.
  void add_noise(std::size_t term, const SymmetricEntry& entry) {
    for (std::size_t a = 0; a < slopes.size(); ++a) {
      const double slope =
          by_.factors(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(term));
      if (slope != 0) slopes[a].P.add_symmetric(entry.row, entry.column, slope * entry.value);
    }
  }

 private:
  ModelSlopes<N> by_;
  Eigen::MatrixXd whitened_;               ///< (p × ny) z'
  Eigen::VectorXd variance_, innovation_;  ///< (p) S'/S and e'/√S of one innovation
};

}  // namespace quadtune::internal
