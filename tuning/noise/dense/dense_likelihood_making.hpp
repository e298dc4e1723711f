// SPDX-License-Identifier: Apache-2.0
/// Fills the dense filter's matrices at a θ, and turns its derivatives into those by θ. Included
/// where these are instantiated, one size a source file.
#pragma once

#include <ceres/jet.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include "noise/dense/dense_filter.hpp"
#include "noise/dense/dense_likelihood.hpp"
#include "noise/likelihood/prepared_noise.hpp"

namespace quadtune::internal {

template <int N>
class DenseEvaluator final : public DenseLikelihood {
 public:
  explicit DenseEvaluator(const PreparedModel& prepared) : prepared_(prepared) {
    const FilterModel& model = prepared.model;
    const auto nx = static_cast<int>(model.A.rows());
    for (const PreparedTransition& from : prepared.transitions) {
      DenseTransition<N>& step = model_.transitions.emplace_back();
      for (int j = 0; j < nx; ++j)
        for (int i = 0; i < nx; ++i) step.F(i, j) = step.F_transposed(j, i) = from.F(i, j);
      step.B.setZero(N, from.B.cols());
      step.B.topRows(nx) = from.B;
    }
    for (Eigen::Index i = 0; i < prepared.C.rows(); ++i) model_.C.add(prepared.C.row(i));
    find_noise_entries();
    auto instants = std::make_shared<std::vector<DenseInstants<N>>>();
    for (const FilterRecord& record : prepared.records) {
      instants->push_back(instants_of(record));
      linearized_ = linearized_ && !record.linearized.empty();
    }
    instants_ = std::move(instants);
    model_.D = prepared.D;
    model_.x0 = model.x0;
    model_.P0 = model.P0;
    model_.diffuse = model.diffuse;
  }

  /// Without the workspace, which may be large and is filled anew by each evaluation.
  DenseEvaluator(const DenseEvaluator& other)
      : DenseLikelihood(other),
        prepared_(other.prepared_),
        instants_(other.instants_),
        linearized_(other.linearized_),
        model_(other.model_) {}
  DenseEvaluator& operator=(const DenseEvaluator&) = delete;

  void evaluate(const Eigen::Ref<const Eigen::VectorXd>& theta, LikelihoodOrder order,
                const RunOptions& how, Likelihood& result) override {
    fill(theta);
    DenseSums<N> sums;
    const bool slopes = order == LikelihoodOrder::gradient;
    std::optional<DenseTangents<N>> tangents;
    if (order == LikelihoodOrder::information) tangents = tangents_at(theta);
    if (slopes) {
      sums.by_R.assign(model_.R.size(), 0);
      sums.by_variances.assign(model_.variances.size(), 0);
      sums.by_Q.assign(model_.transitions.size(), {});
    }
    for (std::size_t r = 0; r < prepared_.prepared.size(); ++r) {
      const bool linearized = !prepared_.records[r].linearized.empty();
      DenseFilter<N> filter(model_, prepared_.prepared[r].view,
                            linearized ? &(*instants_)[r] : nullptr, how, workspace_);
      if (filter.run(sums, slopes, tangents ? &*tangents : nullptr)) continue;
      result.status = LikelihoodStatus::not_positive;
      result.culprit = not_positive(prepared_, r, sums.bad_sample, sums.bad_output);
      return;
    }
    result.innovations = sums.used;
    result.diffuse = sums.diffuse;
    result.value = -0.5 * (sums.logs.value() + sums.squares +
                           static_cast<double>(sums.used) * std::log(2 * std::numbers::pi));
    if (slopes) result.gradient = gradient(theta, sums);
    if (tangents) {
      result.gradient = tangents->gradient();
      result.information = tangents->information();
    }
    result.status = std::isfinite(result.value) && result.gradient.allFinite()
                        ? LikelihoodStatus::computed
                        : LikelihoodStatus::overflowed;
  }

  [[nodiscard]] bool has_information() const override { return linearized_; }
  [[nodiscard]] std::unique_ptr<DenseLikelihood> copy() const override {
    return std::make_unique<DenseEvaluator>(*this);
  }

 private:
  using Slope = ceres::Jet<double, 1>;

  /// Nothing where the record is linear.
  static DenseInstants<N> instants_of(const FilterRecord& record) {
    DenseInstants<N> result;
    if (record.linearized.empty()) return result;
    result.F.resize(record.linearized.size());
    result.offset.resize(record.linearized.size());
    result.terms = record.linearized.front().noise.size();
    for (std::size_t k = 0; k < record.linearized.size(); ++k) {
      const LinearizedInstant& at = record.linearized[k];
      const auto nx = static_cast<int>(at.F.rows());
      for (int j = 0; j < nx; ++j) {
        for (int i = 0; i < nx; ++i) result.F[k](i, j) = at.F(i, j);
        result.offset[k].at[j] = at.offset(j);
      }
      for (Eigen::Index i = 0; i < at.C.rows(); ++i) result.C.add(at.C.row(i));
      for (const Eigen::MatrixXd& noise : at.noise) {
        for (int j = 0; j < nx; ++j)
          for (int i = j; i < nx; ++i)
            if (noise(i, j) != 0) result.noise.push_back({i, j, noise(i, j)});
        result.noise_end.push_back(result.noise.size());
      }
    }
    return result;
  }

  DenseTangents<N> tangents_at(const Eigen::Ref<const Eigen::VectorXd>& theta) const {
    Eigen::MatrixXd by_R(theta.size(), prepared_.C.rows());
    std::vector<Slope> parameters;
    for (const double entry : theta) parameters.emplace_back(entry);
    for (Eigen::Index a = 0; a < theta.size(); ++a) {
      Slope& parameter = parameters[static_cast<std::size_t>(a)];
      parameter.v(0) = 1;
      each_output(parameters, [&](Eigen::Index i, const Slope& R) { by_R(a, i) = R.v(0); });
      parameter.v(0) = 0;
    }
    std::vector<int> of_term;
    for (const ScaledCovariance& term : prepared_.model.Q.scaled) of_term.push_back(term.parameter);
    return {std::move(by_R), std::move(of_term)};
  }

  void find_noise_entries() {
    Eigen::MatrixXd depends = Eigen::MatrixXd::Zero(N, N);
    const auto add = [&](const Eigen::MatrixXd& shape) {
      depends.topLeftCorner(shape.rows(), shape.cols()) += shape.cwiseAbs();
    };
    for (const PreparedTransition& step : prepared_.transitions) {
      for (const Eigen::MatrixXd& shape : step.scaled) add(shape);
      for (const auto& block : step.full)
        for (const Eigen::MatrixXd& shape : block) add(shape);
    }
    for (int j = 0; j < N; ++j)
      for (int i = 0; i < N; i += 4)
        if (!depends.col(j).segment(i, 4).isZero(0)) model_.noise_entries.push_back({i, j});
  }

  void fill(const Eigen::Ref<const Eigen::VectorXd>& theta) {
    const CovarianceModel& Q = prepared_.model.Q;
    model_.variances.clear();
    for (const ScaledCovariance& term : Q.scaled)
      model_.variances.push_back(std::exp(theta(term.parameter)));
    for (std::size_t i = 0; i < model_.transitions.size(); ++i)
      fill_noise(Q, prepared_.transitions[i], theta.data(), model_.transitions[i].Q);
    model_.R.clear();
    for (const FilterSensor& sensor : prepared_.model.sensors) {
      Eigen::MatrixXd R(sensor.C.rows(), sensor.C.rows());
      fill_covariance(sensor.R, theta.data(), R);
      for (Eigen::Index i = 0; i < R.rows(); ++i) model_.R.push_back(R(i, i));
    }
  }

  /// Sum of entries' products with those of each step.
  template <class ShapeOf>
  double inner(const DenseSums<N>& sums, const ShapeOf& shape_of) const {
    double sum = 0;
    for (std::size_t i = 0; i < sums.by_Q.size(); ++i) {
      const Eigen::MatrixXd& shape = shape_of(prepared_.transitions[i]);
      for (int b = 0; b < static_cast<int>(shape.cols()); ++b)
        for (int a = 0; a < static_cast<int>(shape.rows()); ++a)
          sum += shape(a, b) * sums.by_Q[i](a, b);
    }
    return sum;
  }

  Eigen::VectorXd gradient(const Eigen::Ref<const Eigen::VectorXd>& theta,
                           const DenseSums<N>& sums) const {
    const CovarianceModel& Q = prepared_.model.Q;
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(theta.size());
    for (std::size_t t = 0; t < Q.scaled.size(); ++t)
      slope(Q.scaled[t].parameter) +=
          model_.variances[t] *
          (sums.by_variances[t] +
           inner(sums, [t](const PreparedTransition& step) -> const Eigen::MatrixXd& {
             return step.scaled[t];
           }));
    std::vector<Slope> parameters;
    for (const double entry : theta) parameters.emplace_back(entry);
    for (std::size_t t = 0; t < Q.full.size(); ++t) add_block(t, sums, parameters, slope);
    for (Eigen::Index a = 0; a < theta.size(); ++a) {
      parameters[static_cast<std::size_t>(a)].v(0) = 1;
      slope(a) += by_measurements(sums, parameters);
      parameters[static_cast<std::size_t>(a)].v(0) = 0;
    }
    return slope;
  }

  void add_block(std::size_t t, const DenseSums<N>& sums, std::vector<Slope>& parameters,
                 Eigen::VectorXd& slope) const {
    const FullCovariance& block = prepared_.model.Q.full[t];
    const auto n = static_cast<int>(block.entries.size());
    std::vector<double> weights;
    for (std::size_t entry = 0; entry < block.entries.size() * (block.entries.size() + 1) / 2;
         ++entry)
      weights.push_back(inner(sums, [&](const PreparedTransition& step) -> const Eigen::MatrixXd& {
        return step.full[t][entry];
      }));
    for (int a = block.first_parameter; a < block.first_parameter + n * (n + 1) / 2; ++a) {
      parameters[static_cast<std::size_t>(a)].v(0) = 1;
      std::size_t entry = 0;
      for (int i = 0; i < n; ++i)
        for (int j = 0; j <= i; ++j)
          slope(a) +=
              weights[entry++] * full_entry(parameters.data() + block.first_parameter, i, j).v(0);
      parameters[static_cast<std::size_t>(a)].v(0) = 0;
    }
  }

  /// Of the one parameter whose derivative is 1.
  double by_measurements(const DenseSums<N>& sums, const std::vector<Slope>& parameters) const {
    double slope = 0;
    each_output(parameters, [&](Eigen::Index i, const Slope& R) {
      slope += sums.by_R[static_cast<std::size_t>(i)] * R.v(0);
    });
    return slope;
  }

  /// f(output, its variance) of all outputs.
  template <class Function>
  void each_output(const std::vector<Slope>& parameters, Function&& f) const {
    Eigen::Index output = 0;
    for (const FilterSensor& sensor : prepared_.model.sensors) {
      Eigen::Matrix<Slope, Eigen::Dynamic, Eigen::Dynamic> R(sensor.C.rows(), sensor.C.rows());
      fill_covariance(sensor.R, parameters.data(), R);
      for (Eigen::Index i = 0; i < R.rows(); ++i) f(output++, R(i, i));
    }
  }

  const PreparedModel& prepared_;
  std::shared_ptr<const std::vector<DenseInstants<N>>> instants_;  ///< one a record
  bool linearized_ = true;                                         ///< all records are
  DenseModel<N> model_;
  DenseWorkspace<N> workspace_;
};

template <int N>
std::unique_ptr<DenseLikelihood> make_dense_likelihood_of(const PreparedModel& prepared) {
  return std::make_unique<DenseEvaluator<N>>(prepared);
}

}  // namespace quadtune::internal
