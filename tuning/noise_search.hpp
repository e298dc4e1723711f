// SPDX-License-Identifier: Apache-2.0
/// The search for the maximum of a log-likelihood with priors, over the parameters that are free.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "quadtune/tuning/innovation_likelihood.hpp"

namespace quadtune::internal {

/// log-likelihood + log-priors (up to a constant) as a function of all of θ.
class NoiseObjective {
 public:
  explicit NoiseObjective(const InnovationLikelihood& likelihood) : likelihood_(likelihood) {}

  struct Value {
    bool computed = false;
    double value = 0;
    Eigen::VectorXd gradient;     ///< (p)
    Eigen::MatrixXd information;  ///< (p × p) with the priors', where asked for
    double rounding = 0;          ///< more than the sum's, whose terms may cancel
  };
  [[nodiscard]] Value at(const Eigen::VectorXd& theta, LikelihoodOrder order) const;

  /// (p × p) -∂²/∂θ², by central differences of the gradient; zero in rows that are not free.
  [[nodiscard]] Eigen::MatrixXd curvature(const Eigen::VectorXd& theta,
                                          const std::vector<int>& free) const;

  [[nodiscard]] int evaluations() const { return evaluations_; }
  [[nodiscard]] const InnovationLikelihood& likelihood() const { return likelihood_; }

 private:
  const InnovationLikelihood& likelihood_;
  mutable int evaluations_ = 0;
};

struct SearchResult {
  bool computed = false;   ///< whether there is a value at the start
  bool converged = false;  ///< the gradient, in standard deviations, is as good as zero
  Eigen::VectorXd theta;
  double value = 0;
};

/// From `start`, changing the entries in `free` only.
[[nodiscard]] SearchResult search(const NoiseObjective& objective, const Eigen::VectorXd& start,
                                  const std::vector<int>& free, int max_iterations);

}  // namespace quadtune::internal
