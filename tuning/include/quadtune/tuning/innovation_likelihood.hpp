// SPDX-License-Identifier: Apache-2.0
/// The Gaussian likelihood of logs under a filter model, computed from the innovations.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/filter_record.hpp"

namespace quadtune {

/// Outcome of a run of the filter.
enum class LikelihoodStatus {
  not_run,
  computed,
  /// A covariance has a diagonal entry, or an innovation a variance, that is not positive
  not_positive,
  overflowed,  ///< a value exceeded the range of a double
};

/// log p(y | θ) = -½ Σ (log 2π + log S + e²/S) over all scalar innovations e with variance S,
/// processed one by one in the order of the outputs of the model. A measurement that initializes a
/// diffuse state adds only -½ log F∞ (Durbin and Koopman 2012, section 7.2.2, without the constant
/// that depends on the choice of units). For a sensor with Student's distribution, e has that
/// density with scale S, and the measurement corrects the state like one with variance R/w,
/// w = (ν + 1) / (ν + e²/S). Gates are not applied: remove the samples that they reject from the
/// records first.
struct Likelihood {
  LikelihoodStatus status = LikelihoodStatus::not_run;      ///< computed, or why there is no value
  double value = std::numeric_limits<double>::quiet_NaN();  ///< log p(y | θ); NaN unless computed
  Eigen::VectorXd gradient;  ///< (p) with respect to θ, if requested
  /// (p × p) Σ ½ (S'/S)(S'/S)ᵀ + e' e'ᵀ/S, whose expectation is the Fisher information; if
  /// requested.
  Eigen::MatrixXd information;
  Eigen::Index innovations = 0;  ///< number of scalar innovations with a finite variance
  Eigen::Index diffuse = 0;      ///< number of scalars that initialized a diffuse state
  std::string culprit;  ///< e.g. "log.csv: the variance of the innovation of sonar at 3.2 s"

  /// Whether there is a value.
  [[nodiscard]] bool computed() const { return status == LikelihoodStatus::computed; }
};

/// Which derivatives of the likelihood to compute.
enum class LikelihoodOrder { value, gradient, information };

/// Standardized innovations and states of one record.
struct FilterRun {
  LikelihoodStatus status = LikelihoodStatus::not_run;  ///< computed, or why the run ended
  SampleMatrix innovation;  ///< (ny × N) e [unit of the output]; NaN where there is no innovation
  SampleMatrix variance;    ///< (ny × N) S
  SampleMatrix x;           ///< (nx × N) after the measurements; NaN while diffuse
  SampleMatrix x_variance;  ///< (nx × N) diagonal of P after the measurements
  /// (ny × N) 1 where the gate of a sensor rejected a measurement, whose innovation is then NaN.
  SampleArray<std::uint8_t> refused;
  std::string culprit;  ///< what ended the run; empty if computed
};

/// A model with its logs, constructed once and evaluated for many θ. An evaluation allocates only a
/// few small matrices, whatever the length of the logs. Each thread needs its own copy.
class InnovationLikelihood {
 public:
  /// @throws InvalidInput  as validate() of the model and of each record; if there is no record, or
  ///                       if the model has more than 24 states or 64 outputs
  InnovationLikelihood(FilterModel model, std::vector<FilterRecord> records);
  ~InnovationLikelihood();
  InnovationLikelihood(const InnovationLikelihood&);
  InnovationLikelihood(InnovationLikelihood&&) noexcept;
  InnovationLikelihood& operator=(const InnovationLikelihood&);
  InnovationLikelihood& operator=(InnovationLikelihood&&) noexcept;

  [[nodiscard]] const FilterModel& model() const;  ///< the model
  /// The records, in the given order.
  [[nodiscard]] const std::vector<FilterRecord>& records() const;

  /// @param theta  (p) as start_of(); finite.
  /// @param order  which derivatives are computed
  /// @throws InvalidInput  if theta has the wrong size or an entry that is not finite
  /// @throws Interrupted  if the function given to stop_when() returns true
  [[nodiscard]] Likelihood evaluate(const Eigen::Ref<const Eigen::VectorXd>& theta,
                                    LikelihoodOrder order = LikelihoodOrder::value) const;

  /// Runs the filter over one record, with the gates of its sensors.
  /// @param record  its index, 0 ≤ record < records().size()
  /// @param theta   (p) as for evaluate()
  /// @throws InvalidInput  as evaluate(), or if there is no such record
  /// @throws Interrupted   as evaluate()
  [[nodiscard]] FilterRun run(std::size_t record,
                              const Eigen::Ref<const Eigen::VectorXd>& theta) const;

  /// Whether the gains are held constant once the covariance has converged. On by default; tests
  /// switch it off to show that the results do not depend on it.
  void hold_steady_gains(bool hold);

  /// @param stop  called every thousand samples of an evaluation or run, by the thread that
  ///              executes it; if it returns true, the evaluation throws Interrupted. May be empty.
  void stop_when(std::function<bool()> stop);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace quadtune
