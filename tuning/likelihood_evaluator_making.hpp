// SPDX-License-Identifier: Apache-2.0
/// Fills the kernel's matrices at a θ. Included where evaluators are instantiated, one number of
/// states a source file.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "likelihood_evaluator.hpp"
#include "likelihood_kernel.hpp"

namespace quadtune::internal {

inline std::string place_of(const PreparedModel& prepared, std::size_t record, Eigen::Index sample,
                            Eigen::Index output) {
  Eigen::Index i = output;
  std::string name;
  for (const FilterSensor& sensor : prepared.model.sensors) {
    if (i < sensor.C.rows()) {
      name = sensor.outputs[static_cast<std::size_t>(i)].name;
      break;
    }
    i -= sensor.C.rows();
  }
  const FilterRecord& of = prepared.records[record];
  return fmt::format("{}: the variance of the innovation of {} at {} s is not positive", of.name,
                     name, of.time[static_cast<std::size_t>(sample)]);
}

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
                bool information, bool hold_steady_gains, Likelihood& result) override {
    fill(theta, first);
    KernelSums<T> sums;
    if constexpr (is_jet<T>) {
      if (information) {
        information_.setZero(T::DIMENSION, T::DIMENSION);
        sums.information = &information_;
      }
    }
    for (std::size_t r = 0; r < prepared_.prepared.size(); ++r) {
      Kernel kernel(kernel_model_, prepared_.prepared[r].view, hold_steady_gains);
      if (kernel.run(sums, nullptr)) continue;
      result.status = LikelihoodStatus::not_positive;
      result.culprit = place_of(prepared_, r, sums.bad_sample, sums.bad_output);
      return;
    }
    result.innovations = sums.used;
    result.diffuse = sums.diffuse;
    const T twice = sums.logs.value() + sums.squares;
    result.value =
        -0.5 * (plain(twice) + static_cast<double>(sums.used) * std::log(2 * std::numbers::pi));
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
             FilterRun& run) override {
    fill(theta, 0);
    const KernelRecord& view = prepared_.prepared[record].view;
    const double none = std::numeric_limits<double>::quiet_NaN();
    run.innovation.setConstant(view.ny, view.samples, none);
    run.variance.setConstant(view.ny, view.samples, none);
    run.x.setConstant(prepared_.model.A.rows(), view.samples, none);
    run.x_variance.setConstant(prepared_.model.A.rows(), view.samples, none);
    const KernelTrace into{&run.innovation, &run.variance, &run.x, &run.x_variance};
    KernelSums<T> sums;
    Kernel kernel(kernel_model_, view, false);
    run.status =
        kernel.run(sums, &into) ? LikelihoodStatus::computed : LikelihoodStatus::not_positive;
    if (run.status == LikelihoodStatus::not_positive)
      run.culprit = place_of(prepared_, record, sums.bad_sample, sums.bad_output);
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
    for (std::size_t i = 0; i < prepared_.transitions.size(); ++i)
      fill_noise(prepared_.transitions[i], kernel_model_.transitions[i].Q);
  }

  void fill_noise(const PreparedTransition& from, typename KernelTransition<T, nx>::MatrixT& Q) {
    using std::exp;
    const CovarianceModel& model = prepared_.model.Q;
    const Eigen::Index n = Q.rows();
    const auto add = [&](const Eigen::MatrixXd& shape, const T& factor) {
      for (Eigen::Index j = 0; j < n; ++j)
        for (Eigen::Index i = 0; i < n; ++i)
          if (shape(i, j) != 0) Q(i, j) += factor * shape(i, j);
    };
    for (Eigen::Index j = 0; j < n; ++j)
      for (Eigen::Index i = 0; i < n; ++i) Q(i, j) = T(from.fixed(i, j));
    for (std::size_t t = 0; t < model.scaled.size(); ++t)
      add(from.scaled[t], T(exp(parameters_[static_cast<std::size_t>(model.scaled[t].parameter)])));
    for (std::size_t t = 0; t < model.full.size(); ++t) {
      const T* parameters = parameters_.data() + model.full[t].first_parameter;
      std::size_t entry = 0;
      for (int i = 0; i < static_cast<int>(model.full[t].entries.size()); ++i)
        for (int j = 0; j <= i; ++j) add(from.full[t][entry++], full_entry(parameters, i, j));
    }
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
