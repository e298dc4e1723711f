// SPDX-License-Identifier: Apache-2.0
/// What a log says to a filter model: all measurements and inputs in the order of their times.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"

namespace quadtune {

/// Samples of a model's sensors and inputs over one stretch of time. Several records may be of one
/// flight, parted by what is left out.
struct FilterRecord {
  std::string name;          ///< e.g. the log's file
  std::vector<double> time;  ///< N instants [s], increasing
  Eigen::MatrixXd y;         ///< (ny × N) all sensors' outputs in order; NaN: not measured then
  Eigen::MatrixXd u;         ///< (nu × N) from this instant to the next

  [[nodiscard]] Eigen::Index samples() const { return static_cast<Eigen::Index>(time.size()); }
};

/// Checks shapes, that the times increase and are multiples of the period where the model is
/// discrete, and that every sensor's sample is whole where its R is not diagonal.
/// @throws InvalidInput  naming the sample.
void validate(const FilterRecord& record, const FilterModel& model, const std::string& where);

}  // namespace quadtune
