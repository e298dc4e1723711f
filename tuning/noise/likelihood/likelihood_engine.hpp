// SPDX-License-Identifier: Apache-2.0
/// The interface of the offline Kalman filter, independent of the number of states.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "noise/likelihood/prepared_model.hpp"
#include "quadtune/tuning/innovation_likelihood.hpp"

namespace quadtune::internal {

class LikelihoodEngine {
 public:
  virtual ~LikelihoodEngine() = default;
  /// Likelihood of all records.
  virtual void evaluate(const Eigen::Ref<const Eigen::VectorXd>& theta, LikelihoodOrder order,
                        const RunOptions& options, Likelihood& result) = 0;
  /// Innovations and states of one record, with the gates of the sensors.
  virtual void run(const Eigen::Ref<const Eigen::VectorXd>& theta, std::size_t record,
                   const RunOptions& options, FilterRun& result) = 0;
  /// Copy for another thread: shares the data that does not depend on θ.
  [[nodiscard]] virtual std::unique_ptr<LikelihoodEngine> copy() const = 0;
};

/// @param prepared  must outlive the engine.
[[nodiscard]] std::unique_ptr<LikelihoodEngine> make_likelihood_engine(
    const PreparedModel& prepared);

/// @tparam N  states, padded with states that are always zero
template <int N>
[[nodiscard]] std::unique_ptr<LikelihoodEngine> make_likelihood_engine_of(
    const PreparedModel& prepared);

}  // namespace quadtune::internal
