// SPDX-License-Identifier: Apache-2.0
/// How likely logs are under a filter model: the Gaussian likelihood of the innovations.
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

enum class LikelihoodStatus {
  not_run,
  computed,
  not_positive,  ///< a covariance lost its positive diagonal, or an innovation its variance
  overflowed,    ///< a number left the range of a double
};

/// log p(y | θ) = -½ Σ (log 2π + log S + e²/S) over all scalar innovations e of variance S, taken
/// one by one in the order of the model's outputs. A measurement that a diffuse state takes up adds
/// -½ log F∞ only (Durbin and Koopman 2012, section 7.2.2, without the constant that the choice of
/// units makes). Of a sensor with Student's distribution the density of e is that, of scale S, and
/// the measurement corrects the state as one of variance R/w, w = (ν + 1) / (ν + e²/S). Gates are
/// not looked at: what they refuse is to be taken out of the records first.
struct Likelihood {
  LikelihoodStatus status = LikelihoodStatus::not_run;
  double value = std::numeric_limits<double>::quiet_NaN();
  Eigen::VectorXd gradient;  ///< (p) with respect to θ, where asked for
  /// (p × p) Σ ½ (S'/S)(S'/S)ᵀ + e' e'ᵀ/S, whose expectation is Fisher's; where asked for.
  Eigen::MatrixXd information;
  Eigen::Index innovations = 0;  ///< scalars that were compared with their variance
  Eigen::Index diffuse = 0;      ///< scalars that a diffuse state took up
  std::string culprit;  ///< e.g. "log.csv: the variance of the innovation of sonar at 3.2 s"

  [[nodiscard]] bool computed() const { return status == LikelihoodStatus::computed; }
};

/// What the likelihood is asked for besides its value.
enum class LikelihoodOrder { value, gradient, information };

/// Standardized innovations and states of one record.
struct FilterRun {
  LikelihoodStatus status = LikelihoodStatus::not_run;
  SampleMatrix innovation;  ///< (ny × N) e [unit of the output]; NaN where nothing was compared
  SampleMatrix variance;    ///< (ny × N) S
  SampleMatrix x;           ///< (nx × N) after the measurements; NaN while diffuse
  SampleMatrix x_variance;  ///< (nx × N) diagonal of P after the measurements
  /// (ny × N) 1 where a sensor's gate refused a measurement; its innovation is NaN.
  SampleArray<std::uint8_t> refused;
  std::string culprit;
};

/// A model with its logs, made once and evaluated for many θ: an evaluation allocates a few small
/// matrices, whatever the length of the logs. Several threads need a copy each.
class InnovationLikelihood {
 public:
  /// @throws InvalidInput  as validate() of the model and of each record.
  InnovationLikelihood(FilterModel model, std::vector<FilterRecord> records);
  ~InnovationLikelihood();
  InnovationLikelihood(const InnovationLikelihood&);
  InnovationLikelihood(InnovationLikelihood&&) noexcept;
  InnovationLikelihood& operator=(const InnovationLikelihood&);
  InnovationLikelihood& operator=(InnovationLikelihood&&) noexcept;

  [[nodiscard]] const FilterModel& model() const;
  [[nodiscard]] const std::vector<FilterRecord>& records() const;

  /// @param theta  (p) as start_of(); finite.
  /// @throws Interrupted  as stop_when() says
  [[nodiscard]] Likelihood evaluate(const Eigen::Ref<const Eigen::VectorXd>& theta,
                                    LikelihoodOrder order = LikelihoodOrder::value) const;

  /// The filter over one record, with the gates of its sensors.
  [[nodiscard]] FilterRun run(std::size_t record,
                              const Eigen::Ref<const Eigen::VectorXd>& theta) const;

  /// Whether gains are held once the covariance has converged; on unless switched off to see that
  /// nothing depends on it.
  void hold_steady_gains(bool hold);

  /// @param stop  asked every thousand samples of an evaluation or run, by the thread that makes
  ///              it; where it returns true, that ends with Interrupted. Empty: nothing is asked.
  void stop_when(std::function<bool()> stop);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace quadtune
