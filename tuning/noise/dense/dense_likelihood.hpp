// SPDX-License-Identifier: Apache-2.0
/// The likelihood of many states, or with many parameters, behind one face whatever its size.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "noise/likelihood/prepared_model.hpp"
#include "quadtune/tuning/innovation_likelihood.hpp"

namespace quadtune::internal {

class DenseLikelihood {
 public:
  virtual ~DenseLikelihood() = default;
  /// Sums up all records; with what `order` asks for, of which information only where
  /// has_information().
  virtual void evaluate(const Eigen::Ref<const Eigen::VectorXd>& theta, LikelihoodOrder order,
                        const RunOptions& how, Likelihood& result) = 0;
  /// Whether all records are linearized.
  [[nodiscard]] virtual bool has_information() const = 0;
  /// For another thread: it shares what does not depend on θ.
  [[nodiscard]] virtual std::unique_ptr<DenseLikelihood> copy() const = 0;
};

/// @return  null where it does not apply: outputs correlated, or errors with long tails
[[nodiscard]] std::unique_ptr<DenseLikelihood> make_dense_likelihood(const PreparedModel& prepared);

/// @tparam N  states, padded to a multiple of four
template <int N>
[[nodiscard]] std::unique_ptr<DenseLikelihood> make_dense_likelihood_of(
    const PreparedModel& prepared);
extern template std::unique_ptr<DenseLikelihood> make_dense_likelihood_of<4>(const PreparedModel&);
extern template std::unique_ptr<DenseLikelihood> make_dense_likelihood_of<8>(const PreparedModel&);
extern template std::unique_ptr<DenseLikelihood> make_dense_likelihood_of<12>(const PreparedModel&);
extern template std::unique_ptr<DenseLikelihood> make_dense_likelihood_of<16>(const PreparedModel&);
extern template std::unique_ptr<DenseLikelihood> make_dense_likelihood_of<24>(const PreparedModel&);

}  // namespace quadtune::internal
