// SPDX-License-Identifier: Apache-2.0
/// The least squares of autocovariances over noise parameters that stay what covariances can be.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "noise/autocovariance/autocovariance_map.hpp"
#include "quadtune/estimation/filter_model.hpp"

namespace quadtune::internal {

struct LeastSquares {
  bool converged = false;
  Eigen::VectorXd theta;      ///< (p); kNothing where a variance is zero
  double cost = 0;            ///< ½ Σ r², with the priors
  std::vector<bool> at_zero;  ///< (p) a variance ended at zero
};

/// Coordinates z of the free parameters.
struct Coordinates {
  std::vector<int> free;
  std::vector<double> scale;  ///< z is a variance over this; 0: z is θ
};

/// log of a variance that is as good as zero.
inline constexpr double kNothing = -600;

/// r(θ) = W (moments - constant - map values(θ)) for one weighting. Variances that only scale are
/// coordinates of their own, ≥ 0, in which r is linear; others are taken as their logarithms.
class AutocovarianceProblem {
 public:
  /// @param covariance  of the moments
  AutocovarianceProblem(const SampledModel& sampled, const FilterModel& model, const MomentMap& map,
                        const Eigen::VectorXd& moments, const Eigen::MatrixXd& covariance);

  /// From θ, changing the entries in `free` only.
  [[nodiscard]] LeastSquares solve(const Eigen::VectorXd& theta,
                                   const std::vector<int>& free) const;

  /// ½ Σ r² without priors, and the priors'.
  [[nodiscard]] double misfit(const Eigen::VectorXd& theta) const;
  [[nodiscard]] double cost(const Eigen::VectorXd& theta) const;

  /// (p × p) Jᵀ J with the priors', J = ∂r/∂θ; zero rows for what is not free.
  [[nodiscard]] Eigen::MatrixXd information(const Eigen::VectorXd& theta,
                                            const std::vector<int>& free) const;

  /// How far apart what two θ say of the moments is, in standard deviations.
  [[nodiscard]] double distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;

  /// Whether a variance is not told apart from others.
  [[nodiscard]] bool is_vague(int parameter) const {
    return vague_[static_cast<std::size_t>(parameter)];
  }

  /// Standard deviation that a variance would have if all others were known; infinite where the
  /// moments do not depend on it.
  [[nodiscard]] double resolution(int parameter) const;

 private:
  [[nodiscard]] Coordinates coordinates(const std::vector<int>& free) const;
  [[nodiscard]] LeastSquares search(const Eigen::VectorXd& theta,
                                    const std::vector<int>& free) const;

  const SampledModel& sampled_;
  const FilterModel& model_;
  Eigen::MatrixXd map_;       // whitened
  Eigen::VectorXd moments_;   // whitened, less the constant
  std::vector<bool> linear_;  // (p) variances that only scale, without prior, told apart
  std::vector<bool> vague_;   // (p) of a direction that no weighting sees
};

}  // namespace quadtune::internal
