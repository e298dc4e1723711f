// SPDX-License-Identifier: Apache-2.0
/// The least squares of autocovariances over noise parameters that are constrained to valid
/// covariances.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "noise/autocovariance/autocovariance_map.hpp"
#include "quadtune/estimation/filter_model.hpp"

namespace quadtune::internal {

struct LeastSquares {
  bool converged = false;
  Eigen::VectorXd theta;      ///< (p); kNothing for a variance that is zero
  double cost = 0;            ///< ½ Σ r², including the priors
  std::vector<bool> at_zero;  ///< (p) a variance ended at zero
};

/// Coordinates z of the free parameters.
struct Coordinates {
  std::vector<int> free;
  std::vector<double> scale;  ///< z is a variance divided by this; 0: z is θ
};

/// Logarithm of a variance that is effectively zero.
inline constexpr double kNothing = -600;

/// r(θ) = W (moments - constant - map values(θ)) for one weighting. Variances that only scale a
/// term are coordinates themselves, ≥ 0, in which r is linear; the coordinates of others are their
/// logarithms.
class AutocovarianceProblem {
 public:
  /// @param covariance  of the moments
  AutocovarianceProblem(const SampledModel& sampled, const FilterModel& model, const MomentMap& map,
                        const Eigen::VectorXd& moments, const Eigen::MatrixXd& covariance);

  /// Searches from θ, changing only the entries in `free`.
  [[nodiscard]] LeastSquares solve(const Eigen::VectorXd& theta,
                                   const std::vector<int>& free) const;

  /// ½ Σ r² without priors (misfit) and with them (cost).
  [[nodiscard]] double misfit(const Eigen::VectorXd& theta) const;
  [[nodiscard]] double cost(const Eigen::VectorXd& theta) const;

  /// (p × p) Jᵀ J including the priors, J = ∂r/∂θ; zero rows for parameters that are not free.
  [[nodiscard]] Eigen::MatrixXd information(const Eigen::VectorXd& theta,
                                            const std::vector<int>& free) const;

  /// Distance of the moments that two θ predict, in standard deviations.
  [[nodiscard]] double distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;

  /// Whether only a combination of a variance with others is determined.
  [[nodiscard]] bool is_vague(int parameter) const {
    return vague_[static_cast<std::size_t>(parameter)];
  }

  /// Standard deviation of a variance if all others were known; infinite if the moments do not
  /// depend on it.
  [[nodiscard]] double resolution(int parameter) const;

 private:
  [[nodiscard]] Coordinates coordinates(const std::vector<int>& free) const;
  [[nodiscard]] LeastSquares search(const Eigen::VectorXd& theta,
                                    const std::vector<int>& free) const;

  const SampledModel& sampled_;
  const FilterModel& model_;
  Eigen::MatrixXd map_;      // whitened
  Eigen::VectorXd moments_;  // whitened, minus the constant
  // (p) variances that only scale a term, without prior, determined individually
  std::vector<bool> linear_;
  std::vector<bool> vague_;  // (p) part of a direction that no weighting determines
};

}  // namespace quadtune::internal
