// SPDX-License-Identifier: Apache-2.0
/// The search for the maximum of a log-likelihood with priors, over the parameters that are free.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "quadtune/tuning/innovation_likelihood.hpp"

namespace quadtune::internal {

/// log-likelihood + log-priors (up to a constant) as a function of all of θ. For one thread; where
/// it is given more, it makes copies for them.
class NoiseObjective {
 public:
  /// @param told  called after each evaluation that has a value, with that; may be empty
  explicit NoiseObjective(const InnovationLikelihood& likelihood, std::size_t threads = 1,
                          std::function<void(double value)> told = {})
      : likelihood_(likelihood), threads_(threads), told_(std::move(told)) {}

  struct Value {
    bool computed = false;
    double value = 0;
    Eigen::VectorXd gradient;     ///< (p)
    Eigen::MatrixXd information;  ///< (p × p) with the priors', where asked for
    double rounding = 0;          ///< more than the sum's, whose terms may cancel
  };
  /// @throws Interrupted  as the likelihood does
  [[nodiscard]] Value at(const Eigen::VectorXd& theta, LikelihoodOrder order) const;

  /// The best θ of all evaluations, for those who are interrupted.
  struct Best {
    Eigen::VectorXd theta;  ///< empty: there was none
    double value = 0;
    Likelihood likelihood;  ///< without derivatives
  };
  [[nodiscard]] const Best& best() const { return best_; }

  /// (p × p) -∂²/∂θ², by central differences of the gradient; zero in rows that are not free.
  [[nodiscard]] Eigen::MatrixXd curvature(const Eigen::VectorXd& theta,
                                          const std::vector<int>& free) const;

  [[nodiscard]] int evaluations() const { return evaluations_; }
  [[nodiscard]] const InnovationLikelihood& likelihood() const { return likelihood_; }

  /// What other threads did: one(part, objective) of each part, with an objective of its thread.
  /// The result depends on the parts alone.
  void in_parallel(std::size_t parts,
                   const std::function<void(std::size_t part, const NoiseObjective&)>& one) const;

 private:
  const InnovationLikelihood& likelihood_;
  std::size_t threads_;
  std::function<void(double)> told_;
  mutable int evaluations_ = 0;
  mutable Best best_;
};

struct SearchResult {
  bool computed = false;   ///< whether there is a value at the start
  bool converged = false;  ///< the gradient, in standard deviations, is as good as zero
  Eigen::VectorXd theta;
  double value = 0;
  Eigen::MatrixXd information;  ///< (p × p) at theta, as NoiseObjective::Value
};

struct SearchOptions {
  int max_iterations = 200;  ///< of each quasi-Newton search
  /// A hundredth of a standard deviation from the maximum is near enough, where the value counts
  /// more than the place, or where the maximum is about to move.
  bool rough = false;
  bool strides = true;  ///< whether flat directions are searched far and wide
};

/// From `start`, changing the entries in `free` only.
/// @throws Interrupted  as the likelihood does; the objective has the best then.
[[nodiscard]] SearchResult search(const NoiseObjective& objective, const Eigen::VectorXd& start,
                                  const std::vector<int>& free, const SearchOptions& options);

}  // namespace quadtune::internal
