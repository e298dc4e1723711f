// SPDX-License-Identifier: Apache-2.0
/// What a log says to a filter model: all measurements and inputs in the order of their times.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/samples.hpp"

namespace quadtune {

/// A nonlinear model near a trajectory, at one instant: y = C x + v, and to the next instant
/// x⁺ = F x + offset + w, w of covariance Σ exp(θ) noise over the terms of Q.
struct LinearizedInstant {
  Eigen::MatrixXd C;                   ///< (ny × nx) of all sensors
  Eigen::MatrixXd F;                   ///< (nx × nx)
  Eigen::VectorXd offset;              ///< (nx)
  std::vector<Eigen::MatrixXd> noise;  ///< (nx × nx) one a term of FilterModel::Q.scaled
};

/// What is known of the state at a record's first instant.
struct FilterStart {
  Eigen::VectorXd x;  ///< (nx)
  Eigen::MatrixXd P;  ///< (nx × nx) of its error
};

/// Samples of a model's sensors and inputs over one stretch of time. Several records may be of one
/// flight, parted by what is left out.
struct FilterRecord {
  std::string name;  ///< e.g. the log's file
  Samples time;      ///< N instants [s], increasing
  SampleMatrix y;    ///< (ny × N) all sensors' outputs in order; NaN: not measured then
  SampleMatrix u;    ///< (nu × N) from this instant to the next
  /// Empty, or of each instant, in place of the model's A, B, C, G; the measurements are then less
  /// what the linearization says besides C x.
  std::vector<LinearizedInstant> linearized = {};
  std::optional<FilterStart> start = {};  ///< in place of the model's x0, P0 and diffuse
  /// Empty, or (nx × N) what the states truly were, where a log tells; else NaN. No filter sees it.
  SampleMatrix truth = {};

  [[nodiscard]] Eigen::Index samples() const { return static_cast<Eigen::Index>(time.size()); }
};

/// A stretch of a log that a filter can make nothing of.
struct LeftOutRecord {
  std::string name;               ///< as FilterRecord::name
  double from = 0, to = 0;        ///< its first and last instant [s]
  Eigen::Index measurements = 0;  ///< instants of it at which anything was measured
};

/// @return  that of the record
[[nodiscard]] LeftOutRecord left_out(const FilterRecord& record);

/// Checks the samples as validate() does, and nothing of what is linearized.
/// @throws InvalidInput  naming the sample.
void validate_samples(const FilterRecord& record, const FilterModel& model,
                      const std::string& where);

/// Checks shapes, that the times increase and are multiples of the period where the model is
/// discrete, and that every sensor's sample is whole where its R is not diagonal.
/// @throws InvalidInput  naming the sample.
void validate(const FilterRecord& record, const FilterModel& model, const std::string& where);

}  // namespace quadtune
