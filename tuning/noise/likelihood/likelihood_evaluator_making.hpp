// SPDX-License-Identifier: Apache-2.0
/// Fills the kernel's matrices at a θ. Included where evaluators are instantiated, one number of
/// states a source file.
#pragma once

#include <algorithm>
#include <numbers>

#include "noise/likelihood/likelihood_evaluator.hpp"
#include "noise/likelihood/likelihood_kernel.hpp"
#include "noise/likelihood/prepared_noise.hpp"

namespace quadtune::internal {

template <class T, bool correlated, int nx>
class Evaluator final : public LikelihoodEvaluator {
 public:
  using Row = std::conditional_t<correlated, T, double>;
  using Kernel = LikelihoodKernel<T, correlated, nx>;

  explicit Evaluator(const PreparedModel& prepared) : prepared_(prepared) {
    const FilterModel& model = prepared.model;
    const Eigen::Index ny = prepared.C.rows(), nx_now = model.A.rows();
    kernel_model_.transitions.resize(prepared.transitions.size());
    for (std::size_t i = 0; i < prepared.transitions.size(); ++i) {
      kernel_model_.transitions[i].F = prepared.transitions[i].F;
      kernel_model_.transitions[i].B = prepared.transitions[i].B;
      kernel_model_.transitions[i].Q.resize(nx_now, nx_now);
    }
    kernel_model_.C.resize(static_cast<std::size_t>(ny));
    kernel_model_.R.assign(static_cast<std::size_t>(ny), T(0));
    kernel_model_.D = prepared.D;
    kernel_model_.x0 = model.x0;
    kernel_model_.P0 = model.P0;
    kernel_model_.P0_diffuse = Eigen::MatrixXd::Zero(nx_now, nx_now);
    for (Eigen::Index i = 0; i < nx_now; ++i)
      if (model.diffuse[static_cast<std::size_t>(i)]) {
        kernel_model_.P0_diffuse(i, i) = 1;
        ++kernel_model_.diffuse_rank;
      }
    kernel_model_.variances.assign(model.Q.scaled.size(), T(0));
    for (const FilterSensor& sensor : model.sensors)
      for (Eigen::Index i = 0; i < sensor.C.rows(); ++i) {
        kernel_model_.gate.push_back(sensor.gate);
        kernel_model_.student.push_back(sensor.student);
      }
    if (std::all_of(kernel_model_.student.begin(), kernel_model_.student.end(),
                    [](double freedom) { return freedom == 0; }))
      kernel_model_.student.clear();
    R_.resize(ny, ny);
    if constexpr (correlated) kernel_model_.L.resize(ny, ny);
    parameters_.resize(model.parameters.size());
    for (Eigen::Index i = 0; i < ny; ++i) {
      MeasurementRow<Row, nx>& row = kernel_model_.C[static_cast<std::size_t>(i)];
      if constexpr (nx != -1) row.all = prepared.C.row(i).transpose().template cast<Row>();
      for (Eigen::Index j = 0; j < nx_now; ++j)
        if (correlated || prepared.C(i, j) != 0) {
          row.column.push_back(static_cast<int>(j));
          row.value.push_back(Row(prepared.C(i, j)));
        }
    }
  }

  void evaluate(const Eigen::Ref<const Eigen::VectorXd>& theta, Eigen::Index first,
                bool information, const RunOptions& how, Likelihood& result) override {
    fill(theta, first);
    KernelSums<T> sums;
    if constexpr (is_jet<T>) {
      if (information) {
        information_.setZero(T::DIMENSION, T::DIMENSION);
        sums.information = &information_;
      }
    }
    for (std::size_t r = 0; r < prepared_.prepared.size(); ++r) {
      Kernel kernel(kernel_model_, prepared_.prepared[r].view, how);
      if (kernel.run(sums, nullptr)) continue;
      result.status = LikelihoodStatus::not_positive;
      result.culprit = not_positive(prepared_, r, sums.bad_sample, sums.bad_output);
      return;
    }
    result.innovations = sums.used;
    result.diffuse = sums.diffuse;
    const T twice = sums.logs.value() + sums.squares;
    result.value = -0.5 * (plain(twice) + sums.constants +
                           static_cast<double>(sums.used) * std::log(2 * std::numbers::pi));
    result.status =
        std::isfinite(result.value) ? LikelihoodStatus::computed : LikelihoodStatus::overflowed;
    if constexpr (is_jet<T>) {
      const Eigen::Index count = std::min<Eigen::Index>(T::DIMENSION, theta.size() - first);
      result.gradient.segment(first, count) = -0.5 * twice.v.head(count);
      if (!result.gradient.segment(first, count).allFinite())
        result.status = LikelihoodStatus::overflowed;
      if (information)
        result.information.block(first, first, count, count) =
            information_.topLeftCorner(count, count);
    }
  }

  void trace(const Eigen::Ref<const Eigen::VectorXd>& theta, std::size_t record,
             const RunOptions& how, FilterRun& run) override {
    fill(theta, 0);
    const KernelRecord& view = prepared_.prepared[record].view;
    const double none = std::numeric_limits<double>::quiet_NaN();
    run.innovation.setConstant(view.ny, view.samples, none);
    run.variance.setConstant(view.ny, view.samples, none);
    run.x.setConstant(prepared_.model.A.rows(), view.samples, none);
    run.x_variance.setConstant(prepared_.model.A.rows(), view.samples, none);
    run.refused.resize(view.ny, view.samples);
    const KernelTrace into{&run.innovation, &run.variance, &run.x, &run.x_variance, &run.refused};
    KernelSums<T> sums;
    RunOptions every_step = how;
    every_step.hold_steady_gains = false;
    Kernel kernel(kernel_model_, view, every_step);
    run.status =
        kernel.run(sums, &into) ? LikelihoodStatus::computed : LikelihoodStatus::not_positive;
    if (run.status == LikelihoodStatus::not_positive)
      run.culprit = not_positive(prepared_, record, sums.bad_sample, sums.bad_output);
    else if (!std::isfinite(plain(sums.squares)))
      run.status = LikelihoodStatus::overflowed;
  }

 private:
  void fill(const Eigen::Ref<const Eigen::VectorXd>& theta, Eigen::Index first) {
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      parameters_[i] = T(theta(static_cast<Eigen::Index>(i)));
      if constexpr (is_jet<T>) {
        const Eigen::Index lane = static_cast<Eigen::Index>(i) - first;
        if (lane >= 0 && lane < T::DIMENSION) parameters_[i].v(lane) = 1;
      }
    }
    fill_measurements();
    using std::exp;
    const CovarianceModel& Q = prepared_.model.Q;
    for (std::size_t t = 0; t < Q.scaled.size(); ++t)
      kernel_model_.variances[t] =
          T(exp(parameters_[static_cast<std::size_t>(Q.scaled[t].parameter)]));
    for (std::size_t i = 0; i < prepared_.transitions.size(); ++i)
      fill_noise(prepared_.model.Q, prepared_.transitions[i], parameters_.data(),
                 kernel_model_.transitions[i].Q);
  }

  void fill_measurements() {
    for (std::size_t s = 0; s < prepared_.model.sensors.size(); ++s) {
      const FilterSensor& sensor = prepared_.model.sensors[s];
      const Eigen::Index first = prepared_.first_output[s], count = sensor.C.rows();
      auto R = R_.block(first, first, count, count);
      fill_covariance(sensor.R, parameters_.data(), R);
      if constexpr (correlated)
        decorrelate(first, count);
      else
        for (Eigen::Index i = 0; i < count; ++i)
          kernel_model_.R[static_cast<std::size_t>(first + i)] = R(i, i);
    }
  }

  /// R = L diag Lᵀ of one sensor, and L⁻¹ C.
  void decorrelate(Eigen::Index first, Eigen::Index count) {
    auto& L = kernel_model_.L;
    L.block(first, 0, count, L.cols()).setConstant(Row(0));
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) {
        Row sum = R_(first + i, first + j);
        for (Eigen::Index q = 0; q < j; ++q)
          sum -= L(first + i, first + q) * L(first + j, first + q) *
                 kernel_model_.R[static_cast<std::size_t>(first + q)];
        if (j < i)
          L(first + i, first + j) = sum / kernel_model_.R[static_cast<std::size_t>(first + j)];
        else
          kernel_model_.R[static_cast<std::size_t>(first + i)] = sum;
      }
      L(first + i, first + i) = Row(1);
      auto& row = kernel_model_.C[static_cast<std::size_t>(first + i)];
      for (std::size_t c = 0; c < row.value.size(); ++c) {
        Row sum = Row(prepared_.C(first + i, static_cast<Eigen::Index>(c)));
        for (Eigen::Index q = 0; q < i; ++q)
          sum -= L(first + i, first + q) *
                 kernel_model_.C[static_cast<std::size_t>(first + q)].value[c];
        row.value[c] = sum;
      }
    }
  }

  const PreparedModel& prepared_;
  KernelModel<T, Row, nx> kernel_model_;
  std::vector<T> parameters_;
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> R_;
  Eigen::MatrixXd information_;
};

template <int nx>
std::unique_ptr<LikelihoodEvaluator> make_evaluator(const PreparedModel& prepared, int jets) {
  if (prepared.correlated) {
    if constexpr (nx == -1) {
      if (jets == 0) return std::make_unique<Evaluator<double, true, nx>>(prepared);
      return std::make_unique<Evaluator<ceres::Jet<double, 16>, true, nx>>(prepared);
    }
  }
  switch (jets) {
    case 0:
      return std::make_unique<Evaluator<double, false, nx>>(prepared);
    case 2:
      return std::make_unique<Evaluator<ceres::Jet<double, 2>, false, nx>>(prepared);
    case 4:
      return std::make_unique<Evaluator<ceres::Jet<double, 4>, false, nx>>(prepared);
    default:
      return std::make_unique<Evaluator<ceres::Jet<double, 16>, false, nx>>(prepared);
  }
}

}  // namespace quadtune::internal
