// SPDX-License-Identifier: Apache-2.0
/// Stretches of logs in which all sensors are measured simultaneously and periodically.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/filter_record.hpp"

namespace quadtune::internal {

/// Instants first … last of a record: at both, and every dt seconds in between, all outputs in use
/// are measured. At other instants in between only inputs change.
struct UniformStretch {
  std::size_t record = 0;
  Eigen::Index first = 0, last = 0;
  Eigen::Index samples = 0;  ///< number of samples, each of all outputs
};

struct UniformStretches {
  double dt = 0;                      ///< [s]
  std::vector<Eigen::Index> outputs;  ///< outputs in use: measured at least once
  std::vector<UniformStretch> stretches;
  Eigen::Index typical = 0;  ///< half of all samples are in stretches of at least this length
  std::string culprit;       ///< why they are short, if they are
};

[[nodiscard]] UniformStretches find_uniform_stretches(const FilterModel& model,
                                                      const std::vector<FilterRecord>& records);

/// Whether an output in use is measured at that instant.
[[nodiscard]] bool is_measured(const FilterRecord& record, Eigen::Index instant,
                               const std::vector<Eigen::Index>& outputs);

}  // namespace quadtune::internal
