// SPDX-License-Identifier: Apache-2.0
/// The derivatives of a filter's run with respect to each parameter, for the information.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "noise/dense/dense_model.hpp"

namespace quadtune::internal {

/// With ' for the derivative by one parameter, a measurement of row c with gain K and innovation e
/// of variance S makes of x' and P'
///     S' = R' + c P' cᵀ,  e' = -c x',
///     x' ← x' + (e/S) P'cᵀ + (e' - e S'/S) K,  P' ← P' - h Kᵀ - K hᵀ,  h = P'cᵀ - ½ S' K,
/// and a step of time x' ← F x', P' ← F P' Fᵀ + Q'. The information is the sum of
/// ½ (S'/S)(S'/S)ᵀ + e' e'ᵀ/S over all pairs of parameters (Harvey 1989, section 3.4.5).
template <int N>
class DenseTangents {
 public:
  /// @param by_R     (p × ny) derivatives of each output's variance
  /// @param of_term  the parameter whose exponential scales each term of Q.scaled
  DenseTangents(Eigen::MatrixXd by_R, std::vector<int> of_term)
      : by_R_(std::move(by_R)),
        of_term_(std::move(of_term)),
        slopes_(static_cast<std::size_t>(by_R_.rows())),
        variance_(by_R_.rows()),
        innovation_(by_R_.rows()),
        gradient_(Eigen::VectorXd::Zero(by_R_.rows())),
        information_(Eigen::MatrixXd::Zero(by_R_.rows(), by_R_.rows())) {}

  /// At the beginning of a record the state depends on no parameter.
  void start() {
    for (Slope& slope : slopes_) slope = Slope();
  }

  /// @param inverse  1/S
  void correct(Eigen::Index output, const SparseRow& c, const double* K, double inverse, double e) {
    const double weighed = e * inverse, root = std::sqrt(inverse);
    for (std::size_t a = 0; a < slopes_.size(); ++a) {
      Slope& slope = slopes_[a];
      const auto p = static_cast<Eigen::Index>(a);
      double S = by_R_(p, output), e_slope = 0;
      Column<N> h;
      if (slope.moves) {
        for (std::size_t q = 0; q < c.size; ++q)
          add_scaled<N>(c.value[q], slope.P.column(c.column[q]), h.at);
        for (std::size_t q = 0; q < c.size; ++q) {
          S += c.value[q] * h.at[c.column[q]];
          e_slope -= c.value[q] * slope.x.at[c.column[q]];
        }
      }
      variance_(p) = S * inverse;
      innovation_(p) = e_slope * root;
      gradient_(p) -= 0.5 * S * inverse * (1 - e * weighed) + e_slope * weighed;
      if (!slope.moves && S == 0) continue;
      slope.moves = true;
      add_scaled<N>(weighed, h.at, slope.x.at);
      add_scaled<N>(e_slope - S * weighed, K, slope.x.at);
      add_scaled<N>(-0.5 * S, K, h.at);
      for (int j = 0; j < N; ++j) {
        add_scaled<N>(-K[j], h.at, slope.P.column(j));
        add_scaled<N>(-h.at[j], K, slope.P.column(j));
      }
    }
    for (Eigen::Index b = 0; b < information_.cols(); ++b)
      information_.col(b) += (0.5 * variance_(b)) * variance_ + innovation_(b) * innovation_;
  }

  /// F P' Fᵀ; what the noise of the step adds comes by add_noise().
  void predict(const Square<N>& F) {
    for (Slope& slope : slopes_) {
      if (!slope.moves) continue;
      Column<N> x;
      multiply<N>(F.at, slope.x.at, N, x.at);
      slope.x = x;
      propagate<N>(F, slope.P, nullptr);
    }
  }
  /// @param value  of the entry and its mirror image: what of Q the term is, and its derivative by
  ///               the logarithm of its factor
  void add_noise(std::size_t term, int row, int column, double value) {
    Slope& slope = slopes_[static_cast<std::size_t>(of_term_[term])];
    slope.moves = true;
    slope.P.add_symmetric(row, column, value);
  }

  /// (p) of the log-likelihood of all records so far
  [[nodiscard]] const Eigen::VectorXd& gradient() const { return gradient_; }
  /// (p × p)
  [[nodiscard]] const Eigen::MatrixXd& information() const { return information_; }

 private:
  struct Slope {
    bool moves = false;  ///< x or P is not 0
    Column<N> x;
    Square<N> P;
  };

  Eigen::MatrixXd by_R_;
  std::vector<int> of_term_;
  std::vector<Slope> slopes_;              ///< p
  Eigen::VectorXd variance_, innovation_;  ///< (p) S'/S and e'/√S of one innovation
  Eigen::VectorXd gradient_;
  Eigen::MatrixXd information_;
};

}  // namespace quadtune::internal
