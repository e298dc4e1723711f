// SPDX-License-Identifier: Apache-2.0
/// The measurements and inputs of a filter model that a log contains, in chronological order.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/samples.hpp"

namespace quadtune {

/// A nonlinear model linearized about a trajectory at one instant: y = C x + v, and for the next
/// instant x⁺ = F x + offset + w, w with covariance Σ exp(θ) noise, summed over the terms of Q.
struct LinearizedInstant {
  Eigen::MatrixXd C;                   ///< (ny × nx), rows of all sensors
  Eigen::MatrixXd F;                   ///< (nx × nx)
  Eigen::VectorXd offset;              ///< (nx)
  std::vector<Eigen::MatrixXd> noise;  ///< (nx × nx), one per term of FilterModel::Q.scaled
};

/// Initial state of a record and its uncertainty.
struct FilterStart {
  Eigen::VectorXd x;  ///< (nx)
  Eigen::MatrixXd P;  ///< (nx × nx) covariance of the error of x
};

/// Samples of a model's sensors and inputs over one interval of time. A flight gives several
/// records if unusable intervals between them are left out.
struct FilterRecord {
  std::string name;  ///< e.g. the log's file
  Samples time;      ///< N instants [s], strictly increasing
  /// (ny × N) outputs of all sensors in order; NaN: not measured at that instant
  SampleMatrix y;
  SampleMatrix u;  ///< (nu × N) constant from this instant to the next
  /// Empty, or one linearization per instant, used instead of the model's A, B, C and G. The
  /// measurements y are then residuals: the linearization's constant term is already subtracted.
  std::vector<LinearizedInstant> linearized = {};
  std::optional<FilterStart> start = {};  ///< replaces x0, P0 and diffuse of the model
  /// Empty, or (nx × N) true states if the log contains them, NaN where unknown. For evaluation
  /// only; no filter uses it.
  SampleMatrix truth = {};

  /// N, the number of instants.
  [[nodiscard]] Eigen::Index samples() const { return static_cast<Eigen::Index>(time.size()); }
};

/// An interval of a log that a filter cannot use.
struct LeftOutRecord {
  std::string name;               ///< as FilterRecord::name
  double from = 0,                ///< first instant [s]
      to = 0;                     ///< last instant [s]
  Eigen::Index measurements = 0;  ///< number of instants with a measurement
};

/// Describes a record as left out.
[[nodiscard]] LeftOutRecord left_out(const FilterRecord& record);

/// Checks the samples as validate() does, but not the linearization.
/// @throws InvalidInput  naming the sample
void validate_samples(const FilterRecord& record, const FilterModel& model,
                      const std::string& where);

/// Checks shapes, that times increase and, if the model is discrete, that they are multiples of its
/// period, and that a sensor whose R is not diagonal has either all or none of its outputs at an
/// instant.
/// @throws InvalidInput  naming the sample
void validate(const FilterRecord& record, const FilterModel& model, const std::string& where);

}  // namespace quadtune
