// SPDX-License-Identifier: Apache-2.0
/// An extended Kalman filter of 15 states over logs, linearized to the linear model that has the
/// same innovations.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/filter_record.hpp"
#include "quadtune/estimation/nonlinear_filter.hpp"

namespace quadtune::internal {

inline constexpr int kExtendedStates = 15;
using ExtendedVector = Eigen::Matrix<double, kExtendedStates, 1>;
using ExtendedMatrix = Eigen::Matrix<double, kExtendedStates, kExtendedStates>;

/// The inputs of one record, divided into steps between its measurements.
struct Drive {
  std::vector<double> dt;             ///< of each step [s]
  Eigen::MatrixXd u;                  ///< (nu × steps)
  std::vector<Eigen::Index> arrival;  ///< number of steps before each measurement
};

/// A record split into its measurements and the steps between them.
struct DrivenRecord {
  FilterRecord measured;  ///< instants with measurements only; u is 0
  Drive drive;
  std::size_t of = 0;      ///< index of the original record
  Eigen::Index first = 0;  ///< index of the first measurement's instant in it
};

/// @param mean     true: inputs are samples at both ends of a step; false: they are constant over
///                 it
/// @param longest  maximum step [s]; longer ones are divided
/// @return         empty if there are fewer than two instants with measurements
/// @throws InvalidInput  as validate_samples(); if a step is more than a thousand times `longest`
[[nodiscard]] std::optional<DrivenRecord> driven_record(const FilterModel& model,
                                                        const FilterRecord& record, bool mean,
                                                        double longest);

/// Base of extended filters of 15 states over logs.
class ExtendedFilter : public NonlinearFilter {
 public:
  [[nodiscard]] const FilterModel& model() const override { return model_; }
  [[nodiscard]] LinearizedLogs linearize(const Eigen::Ref<const Eigen::VectorXd>& theta,
                                         const std::function<bool()>& stop) const override;
  [[nodiscard]] const std::vector<FilterRecord>& measurements() const override {
    return measurements_;
  }
  [[nodiscard]] const std::vector<LeftOutRecord>& left_out() const override { return left_out_; }

 protected:
  /// Keeps the records for which driven_record() returns a value.
  /// @throws InvalidInput  if there is none
  ExtendedFilter(FilterModel model, const std::vector<FilterRecord>& records, bool mean,
                 double longest);

  /// Runs the filter over one of the records.
  /// @return  false if a number exceeded the range of a double, at time `failed_at`
  [[nodiscard]] virtual bool run(std::size_t record, const Eigen::Ref<const Eigen::VectorXd>& theta,
                                 const std::function<bool()>& stop, FilterRecord& into,
                                 double& failed_at) const = 0;

  FilterModel model_;
  std::vector<DrivenRecord> driven_;

 private:
  std::vector<FilterRecord> measurements_;
  std::vector<LeftOutRecord> left_out_;
};

/// Creates the two filters; each rejects a model of other dynamics.
[[nodiscard]] std::unique_ptr<NonlinearFilter> inertial_filter(
    FilterModel model, const std::vector<FilterRecord>& records, const std::function<bool()>& stop);
[[nodiscard]] std::unique_ptr<NonlinearFilter> rigid_body_filter(
    FilterModel model, const std::vector<FilterRecord>& records);

/// One run of an extended filter. Motion is the nonlinear model: move() propagates the state over a
/// step of inputs and stores what advance(), M ← F M, and add_noise(), N += G shape Gᵀ dt, need;
/// observe() returns the measurement expected at a state and its derivative; difference() subtracts
/// it from y; absorb() moves the part of the state that Motion keeps itself (such as an attitude)
/// from the state vector into Motion; relate() expresses true values in the states before absorb().
template <class Motion>
class ExtendedRun {
 public:
  /// Initial state and covariance of its error.
  ExtendedVector x;
  ExtendedMatrix P;

  double log_likelihood = 0;  ///< up to a constant
  double failed_at = 0;       ///< [s] at which a number exceeded the range of a double

  /// @param stop  called periodically; run() ends with Interrupted if it returns true
  ExtendedRun(const FilterModel& model, const DrivenRecord& record,
              const Eigen::Ref<const Eigen::VectorXd>& theta, Motion motion,
              const std::function<bool()>& stop)
      : x(model.x0),
        P(model.P0),
        model_(model),
        record_(record.measured),
        drive_(record.drive),
        motion_(std::move(motion)),
        stop_(stop),
        R_(model.outputs()),
        gate_(model.outputs()),
        student_(model.outputs()) {
    Eigen::Index first = 0;
    for (const FilterSensor& sensor : model.sensors) {
      const Eigen::Index count = sensor.C.rows();
      R_.segment(first, count) = covariance(sensor.R, theta).diagonal();
      gate_.segment(first, count).setConstant(sensor.gate);
      student_.segment(first, count).setConstant(sensor.student);
      first += count;
    }
    for (const ScaledCovariance& term : model.Q.scaled)
      variances_.push_back(std::exp(theta(term.parameter)));
  }

  /// @param until  time at which to stop [s]
  /// @param into   receives the linear model; may be null
  /// @return       false if a number exceeded the range of a double
  bool run(double until, FilterRecord* into) {
    if (into != nullptr) {
      *into = record_;
      into->start = FilterStart{x, P};
      into->linearized.clear();
    }
    Eigen::Index step = 0;
    for (Eigen::Index k = 0; k < record_.samples(); ++k) {
      const double now = record_.time[static_cast<std::size_t>(k)];
      if (now > until) break;
      if (k % kAskedEvery == 0 && stop_ && stop_()) throw Interrupted();
      LinearizedInstant at;
      correct(k, at.C, into);
      const ExtendedVector corrected = x;
      if (into != nullptr && into->truth.size() > 0) motion_.relate(record_, k, x, *into);
      motion_.absorb(x);
      const Eigen::Index end =
          k + 1 < record_.samples() ? drive_.arrival[static_cast<std::size_t>(k) + 1] : step;
      predict(step, end, at);
      step = end;
      if (!x.allFinite() || !P.allFinite()) {
        failed_at = now;
        return false;
      }
      if (into == nullptr) continue;
      at.offset = x - at.F * corrected;
      into->linearized.push_back(std::move(at));
    }
    return true;
  }

 private:
  static constexpr Eigen::Index kAskedEvery = 1024;

  /// Corrects by all measurements of an instant, linearized once for all of them.
  void correct(Eigen::Index k, Eigen::MatrixXd& C, FilterRecord* into) {
    const ExtendedVector predicted = x;
    C.setZero(R_.size(), kExtendedStates);
    expected_.setZero(R_.size());
    motion_.observe(predicted, C, expected_);
    for (Eigen::Index i = 0; i < R_.size(); ++i) {
      if (std::isnan(record_.y(i, k))) continue;
      const double y =
          motion_.difference(i, record_.y(i, k), expected_(i)) + C.row(i).dot(predicted);
      if (into != nullptr) into->y(i, k) = y;
      const ExtendedVector PC = P * C.row(i).transpose();
      double R = R_(i), S = C.row(i) * PC + R;
      const double e = y - C.row(i).dot(x), square = e * e / S;
      if (square > gate_(i)) {
        if (into != nullptr) into->y(i, k) = std::nan("");
        continue;
      }
      if (student_(i) > 0) {
        const double freedom = student_(i), before = R;
        log_likelihood -= 0.5 * (std::log(S) + (freedom + 1) * std::log1p(square / freedom));
        R *= (freedom + square) / (freedom + 1);
        S += R - before;
      } else {
        log_likelihood -= 0.5 * (std::log(S) + square);
      }
      const ExtendedVector K = PC / S;
      x += K * e;
      P -= K * PC.transpose();
      const ExtendedVector rest = K * R - P * C.row(i).transpose();
      P += rest * K.transpose();
    }
  }

  void predict(Eigen::Index begin, Eigen::Index end, LinearizedInstant& at) {
    ExtendedMatrix F = ExtendedMatrix::Identity();
    noises_.assign(variances_.size(), ExtendedMatrix::Zero());
    for (Eigen::Index step = begin; step < end; ++step) {
      motion_.move(drive_.dt[static_cast<std::size_t>(step)], drive_.u.col(step), x);
      motion_.advance(F);
      for (std::size_t t = 0; t < noises_.size(); ++t) {
        if (step > begin) {  // the first measurement has no step before it
          motion_.advance(noises_[t]);
          noises_[t].transposeInPlace();
          motion_.advance(noises_[t]);
        }
        motion_.add_noise(model_.Q.scaled[t].shape, noises_[t]);
      }
    }
    P = (F * P * F.transpose()).eval();
    for (std::size_t t = 0; t < noises_.size(); ++t) P += variances_[t] * noises_[t];
    P = (0.5 * (P + P.transpose())).eval();
    at.F = F;
    at.noise.assign(noises_.begin(), noises_.end());
  }

  const FilterModel& model_;
  const FilterRecord& record_;
  const Drive& drive_;
  Motion motion_;
  const std::function<bool()>& stop_;
  /// Per term, accumulated over the steps to the next measurement
  std::vector<ExtendedMatrix> noises_;
  Eigen::VectorXd R_, gate_, student_, expected_;
  std::vector<double> variances_;
};

}  // namespace quadtune::internal
