// SPDX-License-Identifier: Apache-2.0
/// Computes the matrices of the Kalman filter at a θ, and the likelihood from its sums. Included
/// only where it is instantiated.
#pragma once

#include <ceres/jet.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>

#include "noise/likelihood/adjoint_pass.hpp"
#include "noise/likelihood/forward_pass.hpp"
#include "noise/likelihood/likelihood_engine.hpp"
#include "noise/likelihood/prepared_noise.hpp"

namespace quadtune::internal {

template <int N>
class LikelihoodEngineOf final : public LikelihoodEngine {
 public:
  explicit LikelihoodEngineOf(const PreparedModel& prepared) : prepared_(prepared) {
    const FilterModel& model = prepared.model;
    for (const PreparedTransition& from : prepared.transitions) {
      Transition<N>& step = model_.transitions.emplace_back();
      step.F = padded(from.F);
      transpose<N>(step.F, step.F_transposed);
      for (Eigen::Index j = 0; j < from.B.cols(); ++j)
        std::copy_n(from.B.col(j).data(), from.B.rows(), step.B.emplace_back().at);
    }
    find_noise_entries();
    auto instants = std::make_shared<std::vector<LinearizedInstants<N>>>();
    for (const FilterRecord& record : prepared.records) instants->push_back(instants_of(record));
    instants_ = std::move(instants);
    for (const FilterSensor& sensor : model.sensors) {
      tailed_ = tailed_ || sensor.student != 0;
      model_.gate.insert(model_.gate.end(), static_cast<std::size_t>(sensor.C.rows()), sensor.gate);
      model_.student.insert(model_.student.end(), static_cast<std::size_t>(sensor.C.rows()),
                            sensor.student);
    }
    if (!tailed_) model_.student.clear();
    model_.D = prepared.D;
    model_.x0 = model.x0;
    model_.P0 = model.P0;
    model_.diffuse = model.diffuse;
  }

  /// The copy omits the tape, which may be large and is recomputed in each evaluation.
  LikelihoodEngineOf(const LikelihoodEngineOf& other)
      : LikelihoodEngine(other),
        prepared_(other.prepared_),
        instants_(other.instants_),
        tailed_(other.tailed_),
        model_(other.model_) {}
  LikelihoodEngineOf& operator=(const LikelihoodEngineOf&) = delete;

  [[nodiscard]] std::unique_ptr<LikelihoodEngine> copy() const override {
    return std::make_unique<LikelihoodEngineOf>(*this);
  }

  void evaluate(const Eigen::Ref<const Eigen::VectorXd>& theta, LikelihoodOrder order,
                const RunOptions& options, Likelihood& result) override {
    fill(theta);
    const bool adjoint = order == LikelihoodOrder::gradient && !prepared_.correlated && !tailed_;
    LikelihoodSums<N> sums;
    std::optional<Sensitivities<N>> sensitivities;
    typename ForwardPass<N>::Extras extras;
    if (adjoint) {
      sums.by_R.assign(model_.R.size(), 0);
      sums.by_factors.assign(model_.factors.size(), 0);
      sums.by_Q.assign(model_.transitions.size(), {});
      extras.tape = &tape_;
    } else if (order != LikelihoodOrder::value) {
      sensitivities.emplace(slopes_at(theta));
      extras.sensitivities = &*sensitivities;
    }
    for (std::size_t r = 0; r < prepared_.records.size(); ++r) {
      const KernelRecord& record = prepared_.prepared[r].view;
      ForwardPass<N> forward(model_, record, instants(r), options, extras);
      if (!forward.run(sums)) {
        result.status = LikelihoodStatus::not_positive;
        result.culprit = not_positive(prepared_, r, sums.bad_sample, sums.bad_output);
        return;
      }
      if (adjoint) AdjointPass<N>(model_, record, instants(r), options, forward, tape_).run(sums);
    }
    result.innovations = sums.used;
    result.diffuse = sums.diffuse;
    result.value = -0.5 * (sums.logs.value() + sums.squares + sums.constants +
                           static_cast<double>(sums.used) * std::log(2 * std::numbers::pi));
    if (adjoint) result.gradient = gradient(theta, sums);
    if (sensitivities) result.gradient = sensitivities->gradient;
    if (order == LikelihoodOrder::information) result.information = sensitivities->information;
    result.status = std::isfinite(result.value) && result.gradient.allFinite()
                        ? LikelihoodStatus::computed
                        : LikelihoodStatus::overflowed;
  }

  void run(const Eigen::Ref<const Eigen::VectorXd>& theta, std::size_t record,
           const RunOptions& options, FilterRun& result) override {
    fill(theta);
    const KernelRecord& view = prepared_.prepared[record].view;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    result.innovation.setConstant(view.ny, view.samples, nan);
    result.variance.setConstant(view.ny, view.samples, nan);
    result.x.setConstant(prepared_.model.A.rows(), view.samples, nan);
    result.x_variance.setConstant(prepared_.model.A.rows(), view.samples, nan);
    result.refused.resize(view.ny, view.samples);
    const RunTrace trace{&result.innovation, &result.variance, &result.x, &result.x_variance,
                         &result.refused};
    typename ForwardPass<N>::Extras extras;
    extras.trace = &trace;
    LikelihoodSums<N> sums;
    if (!ForwardPass<N>(model_, view, instants(record), options, extras).run(sums)) {
      result.status = LikelihoodStatus::not_positive;
      result.culprit = not_positive(prepared_, record, sums.bad_sample, sums.bad_output);
      return;
    }
    result.status =
        std::isfinite(sums.squares) ? LikelihoodStatus::computed : LikelihoodStatus::overflowed;
  }

 private:
  using Slope = ceres::Jet<double, 1>;

  static Square<N> padded(const Eigen::MatrixXd& A) {
    Square<N> result;
    for (Eigen::Index j = 0; j < A.cols(); ++j)
      std::copy_n(A.col(j).data(), A.rows(), result.column(j));
    return result;
  }

  [[nodiscard]] const LinearizedInstants<N>* instants(std::size_t record) const {
    return prepared_.records[record].linearized.empty() ? nullptr : &(*instants_)[record];
  }

  /// Empty if the record is linear.
  static LinearizedInstants<N> instants_of(const FilterRecord& record) {
    LinearizedInstants<N> result;
    if (record.linearized.empty()) return result;
    result.offset.resize(record.linearized.size());
    result.terms = record.linearized.front().noise.size();
    for (std::size_t k = 0; k < record.linearized.size(); ++k) {
      const LinearizedInstant& at = record.linearized[k];
      result.F.push_back(padded(at.F));
      std::copy_n(at.offset.data(), at.offset.size(), result.offset[k].at);
      for (Eigen::Index i = 0; i < at.C.rows(); ++i) result.C.add(at.C.row(i));
      for (const Eigen::MatrixXd& noise : at.noise) {
        for (int j = 0; j < static_cast<int>(noise.cols()); ++j)
          for (int i = j; i < static_cast<int>(noise.rows()); ++i)
            if (noise(i, j) != 0) result.noise.push_back({i, j, noise(i, j)});
        result.noise_end.push_back(result.noise.size());
      }
    }
    return result;
  }

  void find_noise_entries() {
    Eigen::MatrixXd depends = Eigen::MatrixXd::Zero(N, N);
    for (const PreparedTransition& step : prepared_.transitions)
      for (const Eigen::MatrixXd& shape : step.shapes)
        depends.topLeftCorner(shape.rows(), shape.cols()) += shape.cwiseAbs();
    for (int j = 0; j < N; ++j)
      for (int i = 0; i < N; i += kLanes<N>)
        if (!depends.col(j).segment(i, kLanes<N>).isZero(0)) model_.noise_entries.push_back({i, j});
    model_.diagonal_noise = depends.isDiagonal(0);
  }

  void fill(const Eigen::Ref<const Eigen::VectorXd>& theta) {
    model_.factors = noise_factors(prepared_.model.Q, theta.data());
    for (std::size_t t = 0; t < model_.transitions.size(); ++t) {
      const PreparedTransition& from = prepared_.transitions[t];
      model_.transitions[t].Q = padded(from.fixed);
      add_shapes(from, model_.factors, model_.transitions[t].Q);
    }
    const Measurements<double> measurements = measurements_at(prepared_, theta.data());
    model_.R = measurements.variance;
    model_.C = {};
    for (Eigen::Index i = 0; i < measurements.C.rows(); ++i) model_.C.add(measurements.C.row(i));
    if (prepared_.correlated) model_.L = measurements.L;
  }

  /// Q += Σ factor shape
  template <class Factors>
  static void add_shapes(const PreparedTransition& from, const Factors& factors, Square<N>& Q) {
    for (std::size_t s = 0; s < from.shapes.size(); ++s) {
      const double factor = factors[static_cast<Eigen::Index>(s)];
      if (factor == 0) continue;
      for (Eigen::Index j = 0; j < from.shapes[s].cols(); ++j)
        for (Eigen::Index i = 0; i < from.shapes[s].rows(); ++i)
          Q(i, j) += factor * from.shapes[s](i, j);
    }
  }

  /// Calls f(parameter, θ as jets with the derivative with respect to that parameter).
  template <class Function>
  static void each_direction(const Eigen::Ref<const Eigen::VectorXd>& theta, Function&& f) {
    std::vector<Slope> jets(theta.begin(), theta.end());
    for (Eigen::Index a = 0; a < theta.size(); ++a) {
      jets[static_cast<std::size_t>(a)].v(0) = 1;
      f(a, jets.data());
      jets[static_cast<std::size_t>(a)].v(0) = 0;
    }
  }

  ModelSlopes<N> slopes_at(const Eigen::Ref<const Eigen::VectorXd>& theta) const {
    ModelSlopes<N> slopes;
    const auto ny = static_cast<Eigen::Index>(model_.R.size());
    slopes.R.resize(theta.size(), ny);
    slopes.factors.resize(theta.size(), static_cast<Eigen::Index>(model_.factors.size()));
    each_direction(theta, [&](Eigen::Index a, const Slope* jets) {
      const std::vector<Slope> factors = noise_factors(prepared_.model.Q, jets);
      for (std::size_t s = 0; s < factors.size(); ++s)
        slopes.factors(a, static_cast<Eigen::Index>(s)) = factors[s].v(0);
      const Measurements<Slope> measurements = measurements_at(prepared_, jets);
      for (Eigen::Index i = 0; i < ny; ++i)
        slopes.R(a, i) = measurements.variance[static_cast<std::size_t>(i)].v(0);
      if (!prepared_.correlated) return;
      const auto slope_of = [](const Slope& entry) { return entry.v(0); };
      slopes.L.push_back(measurements.L.unaryExpr(slope_of));
      const Eigen::MatrixXd C = measurements.C.unaryExpr(slope_of).transpose();
      std::vector<Column<N>>& rows = slopes.C.emplace_back(static_cast<std::size_t>(ny));
      for (Eigen::Index i = 0; i < ny; ++i)
        std::copy_n(C.col(i).data(), C.rows(), rows[static_cast<std::size_t>(i)].at);
    });
    for (const PreparedTransition& from : prepared_.transitions)
      for (Eigen::Index a = 0; a < theta.size(); ++a)
        add_shapes(from, slopes.factors.row(a), slopes.Q.emplace_back());
    return slopes;
  }

  /// ∂ log p/∂θ by the chain rule.
  Eigen::VectorXd gradient(const Eigen::Ref<const Eigen::VectorXd>& theta,
                           const LikelihoodSums<N>& sums) const {
    std::vector<double> by_factors = sums.by_factors;
    for (std::size_t t = 0; t < prepared_.transitions.size(); ++t)
      for (std::size_t s = 0; s < by_factors.size(); ++s) {
        const Eigen::MatrixXd& shape = prepared_.transitions[t].shapes[s];
        for (Eigen::Index j = 0; j < shape.cols(); ++j)
          for (Eigen::Index i = 0; i < shape.rows(); ++i)
            by_factors[s] += shape(i, j) * sums.by_Q[t](i, j);
      }
    Eigen::VectorXd result = Eigen::VectorXd::Zero(theta.size());
    each_direction(theta, [&](Eigen::Index a, const Slope* jets) {
      const std::vector<Slope> factors = noise_factors(prepared_.model.Q, jets);
      for (std::size_t s = 0; s < factors.size(); ++s) result(a) += by_factors[s] * factors[s].v(0);
      const std::vector<Slope> R = measurements_at(prepared_, jets).variance;
      for (std::size_t i = 0; i < R.size(); ++i) result(a) += sums.by_R[i] * R[i].v(0);
    });
    return result;
  }

  const PreparedModel& prepared_;
  std::shared_ptr<const std::vector<LinearizedInstants<N>>> instants_;  ///< one per record
  bool tailed_ = false;  ///< whether a sensor has Student's distribution
  EngineModel<N> model_;
  Tape<N> tape_;
};

template <int N>
std::unique_ptr<LikelihoodEngine> make_likelihood_engine_of(const PreparedModel& prepared) {
  return std::make_unique<LikelihoodEngineOf<N>>(prepared);
}

}  // namespace quadtune::internal
