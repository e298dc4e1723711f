// SPDX-License-Identifier: Apache-2.0
/// Maximization of a log-likelihood with priors over the free parameters.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "quadtune/tuning/innovation_likelihood.hpp"

namespace quadtune::internal {

/// log-likelihood + log-priors (up to a constant) as a function of all of θ. For one thread; it
/// makes copies if several threads are used.
class NoiseObjective {
 public:
  /// @param report callback with the value after each evaluation that has one; may be empty
  explicit NoiseObjective(const InnovationLikelihood& likelihood, std::size_t threads = 1,
                          std::function<void(double value)> report = {})
      : likelihood_(likelihood), threads_(threads), report_(std::move(report)) {}

  struct Value {
    bool computed = false;
    double value = 0;
    Eigen::VectorXd gradient;     ///< (p)
    Eigen::MatrixXd information;  ///< (p × p) with the priors included, if requested
    double rounding = 0;          ///< estimate for the sum of absolute terms, which may cancel
  };
  /// @throws Interrupted  as the likelihood does
  [[nodiscard]] Value at(const Eigen::VectorXd& theta, LikelihoodOrder order) const;

  /// The best θ of all evaluations, the result of an interrupted search.
  struct Best {
    Eigen::VectorXd theta;  ///< empty: no evaluation has succeeded
    double value = 0;
    Likelihood likelihood;  ///< without derivatives
  };
  [[nodiscard]] const Best& best() const { return best_; }

  /// (p × p) -∂²/∂θ², by central differences of the gradient; zero in rows of parameters that are
  /// not free.
  [[nodiscard]] Eigen::MatrixXd curvature(const Eigen::VectorXd& theta,
                                          const std::vector<int>& free) const;

  [[nodiscard]] int evaluations() const { return evaluations_; }
  [[nodiscard]] const InnovationLikelihood& likelihood() const { return likelihood_; }

  /// Runs one(part, objective) for each part in parallel, with a separate objective for each
  /// thread. The result depends on the parts only.
  void in_parallel(std::size_t parts,
                   const std::function<void(std::size_t part, const NoiseObjective&)>& one) const;

 private:
  const InnovationLikelihood& likelihood_;
  std::size_t threads_;
  std::function<void(double)> report_;
  mutable int evaluations_ = 0;
  mutable Best best_;
};

struct SearchResult {
  bool computed = false;   ///< whether the objective can be computed at the start
  bool converged = false;  ///< the gradient, in standard deviations, is negligible
  Eigen::VectorXd theta;
  double value = 0;
  Eigen::MatrixXd information;  ///< (p × p) at theta, as NoiseObjective::Value
};

struct SearchOptions {
  int max_iterations = 200;  ///< maximum number of iterations of each quasi-Newton search
  /// Whether a hundredth of a standard deviation from the maximum is close enough, for use where
  /// only the value matters or the maximum is about to move.
  bool rough = false;
  bool strides = true;  ///< whether to take long steps along flat directions
};

/// Searches from `start`, changing only the entries in `free`.
/// @throws Interrupted  as the likelihood does; the objective then has the best point.
[[nodiscard]] SearchResult search(const NoiseObjective& objective, const Eigen::VectorXd& start,
                                  const std::vector<int>& free, const SearchOptions& options);

}  // namespace quadtune::internal
