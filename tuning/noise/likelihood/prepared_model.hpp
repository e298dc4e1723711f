// SPDX-License-Identifier: Apache-2.0
/// The part of a model and its records that does not depend on θ, computed once.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "noise/likelihood/kernel_record.hpp"
#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/filter_record.hpp"

namespace quadtune::internal {

/// One step of time. The noise of a step is linear in Q: Q_d = fixed + Σ factor(θ) shape, with the
/// factors of noise_factors().
struct PreparedTransition {
  Eigen::MatrixXd F;      ///< (nx × nx)
  Eigen::MatrixXd B;      ///< (nx × nu)
  Eigen::MatrixXd fixed;  ///< (nx × nx)
  /// (nx × nx) one per term of Q.scaled, then one per entry (i, j), j ≤ i, row by row, of each term
  /// of Q.full
  std::vector<Eigen::MatrixXd> shapes;
};

struct PreparedRecord {
  SamplesOf<std::uint32_t> transition;
  std::vector<KernelSegment> segments;
  KernelRecord view;  ///< points into the record and the vectors above
};

struct PreparedModel {
  FilterModel model;
  std::vector<FilterRecord> records;
  std::vector<PreparedTransition> transitions;
  std::vector<PreparedRecord> prepared;    ///< one per record
  Eigen::MatrixXd C, D;                    ///< of all sensors; D empty where all are zero
  std::vector<Eigen::Index> first_output;  ///< of each sensor
  bool correlated = false;                 ///< whether an R is not diagonal

  PreparedModel(FilterModel of, std::vector<FilterRecord> with);
  PreparedModel(const PreparedModel&) = delete;
  PreparedModel& operator=(const PreparedModel&) = delete;
};

/// Describes where the variance of an innovation is not positive.
[[nodiscard]] std::string not_positive(const PreparedModel& prepared, std::size_t record,
                                       Eigen::Index sample, Eigen::Index output);

/// An integer that is the same for equal steps, and the length of such a step.
[[nodiscard]] std::int64_t step_key(const FilterModel& model, double dt);
[[nodiscard]] double step_of_key(const FilterModel& model, std::int64_t key);

/// The step of `model` over dt seconds.
[[nodiscard]] PreparedTransition prepare_transition(const FilterModel& model, double dt);

}  // namespace quadtune::internal
