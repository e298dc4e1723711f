// SPDX-License-Identifier: Apache-2.0
/// The kernel behind one face, whatever its scalar and number of states.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "noise/likelihood/prepared_model.hpp"
#include "quadtune/tuning/innovation_likelihood.hpp"

namespace quadtune::internal {

class LikelihoodEvaluator {
 public:
  virtual ~LikelihoodEvaluator() = default;
  /// Sums up all records. Derivatives are those with respect to `jets` entries of θ from `first`
  /// on; result.gradient and result.information, of the size of θ, are filled there.
  virtual void evaluate(const Eigen::Ref<const Eigen::VectorXd>& theta, Eigen::Index first,
                        bool information, const RunOptions& how, Likelihood& result) = 0;
  /// One record, written down.
  virtual void trace(const Eigen::Ref<const Eigen::VectorXd>& theta, std::size_t record,
                     const RunOptions& how, FilterRun& run) = 0;
};

/// @param jets  0, or how many derivatives at once: 2, 4, 8, 16.
template <int nx>
[[nodiscard]] std::unique_ptr<LikelihoodEvaluator> make_evaluator(const PreparedModel& prepared,
                                                                  int jets);
extern template std::unique_ptr<LikelihoodEvaluator> make_evaluator<1>(const PreparedModel&, int);
extern template std::unique_ptr<LikelihoodEvaluator> make_evaluator<2>(const PreparedModel&, int);
extern template std::unique_ptr<LikelihoodEvaluator> make_evaluator<3>(const PreparedModel&, int);
extern template std::unique_ptr<LikelihoodEvaluator> make_evaluator<4>(const PreparedModel&, int);
extern template std::unique_ptr<LikelihoodEvaluator> make_evaluator<-1>(const PreparedModel&, int);

}  // namespace quadtune::internal
