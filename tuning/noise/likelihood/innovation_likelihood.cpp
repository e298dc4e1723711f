// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/innovation_likelihood.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "noise/dense/dense_likelihood.hpp"
#include "noise/likelihood/likelihood_evaluator.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using internal::DenseLikelihood;
using internal::LikelihoodEvaluator;
using internal::PreparedModel;
using internal::RunOptions;

std::unique_ptr<LikelihoodEvaluator> evaluator_of(const PreparedModel& prepared, int jets) {
  const bool linear = std::all_of(prepared.records.begin(), prepared.records.end(),
                                  [](const auto& record) { return record.linearized.empty(); });
  if (!prepared.correlated && linear) switch (prepared.model.A.rows()) {
      case 1:
        return internal::make_evaluator<1>(prepared, jets);
      case 2:
        return internal::make_evaluator<2>(prepared, jets);
      case 3:
        return internal::make_evaluator<3>(prepared, jets);
      case 4:
        return internal::make_evaluator<4>(prepared, jets);
      default:
        break;
    }
  return internal::make_evaluator<-1>(prepared, jets);
}

}  // namespace

struct InnovationLikelihood::Parts {
  std::shared_ptr<const PreparedModel> prepared;
  std::unique_ptr<LikelihoodEvaluator> value, slope;
  std::unique_ptr<DenseLikelihood> dense;  ///< may be null
  int jets = 2;
  RunOptions how;

  explicit Parts(std::shared_ptr<const PreparedModel> of) : prepared(std::move(of)) {
    make_evaluators();
    if (many_states() || prepared->model.parameters.size() > 4)
      dense = internal::make_dense_likelihood(*prepared);
  }
  Parts(const Parts& other) : prepared(other.prepared), how(other.how) {
    make_evaluators();
    if (other.dense) dense = other.dense->copy();
  }
  Parts& operator=(const Parts&) = delete;

  /// Whether the dense filter is faster: of few states it has the gradient by many parameters, of
  /// many states the value too.
  [[nodiscard]] bool dense_has(LikelihoodOrder order) const {
    if (!dense) return false;
    if (order == LikelihoodOrder::information) return dense->has_information();
    return order == LikelihoodOrder::gradient || many_states();
  }

 private:
  [[nodiscard]] bool many_states() const { return prepared->model.A.rows() > 4; }

  void make_evaluators() {
    const std::size_t p = prepared->model.parameters.size();
    jets = prepared->correlated || p > 4 ? 16 : (p > 2 ? 4 : 2);
    value = evaluator_of(*prepared, 0);
    slope = evaluator_of(*prepared, jets);
  }
};

InnovationLikelihood::InnovationLikelihood(FilterModel model, std::vector<FilterRecord> records) {
  validate(model, "filter model");
  if (model.A.rows() > internal::kMostStates)
    throw InvalidInput("filter model", fmt::format("the model has {} states, expected at most {}",
                                                   model.A.rows(), internal::kMostStates));
  if (model.outputs() > internal::kMostOutputs)
    throw InvalidInput("filter model", fmt::format("the model has {} outputs, expected at most {}",
                                                   model.outputs(), internal::kMostOutputs));
  if (records.empty()) throw InvalidInput("logs", "none came, expected at least one");
  for (const FilterRecord& record : records) validate(record, model, record.name);
  parts_ = std::make_unique<Parts>(
      std::make_shared<const PreparedModel>(std::move(model), std::move(records)));
}

InnovationLikelihood::~InnovationLikelihood() = default;
InnovationLikelihood::InnovationLikelihood(InnovationLikelihood&&) noexcept = default;
InnovationLikelihood& InnovationLikelihood::operator=(InnovationLikelihood&&) noexcept = default;
InnovationLikelihood::InnovationLikelihood(const InnovationLikelihood& other)
    : parts_(std::make_unique<Parts>(*other.parts_)) {}
InnovationLikelihood& InnovationLikelihood::operator=(const InnovationLikelihood& other) {
  *this = InnovationLikelihood(other);
  return *this;
}

const FilterModel& InnovationLikelihood::model() const { return parts_->prepared->model; }
const std::vector<FilterRecord>& InnovationLikelihood::records() const {
  return parts_->prepared->records;
}
void InnovationLikelihood::hold_steady_gains(bool hold) { parts_->how.hold_steady_gains = hold; }
void InnovationLikelihood::stop_when(std::function<bool()> stop) {
  parts_->how.stop = std::move(stop);
}

Likelihood InnovationLikelihood::evaluate(const Eigen::Ref<const Eigen::VectorXd>& theta,
                                          LikelihoodOrder order) const {
  const Index p = static_cast<Index>(model().parameters.size());
  require_shape(theta, p, 1, "likelihood", "theta", "one entry a parameter");
  require_finite(theta, "likelihood", "theta");
  Likelihood result;
  if (p == 0) order = LikelihoodOrder::value;
  if (parts_->dense_has(order)) {
    parts_->dense->evaluate(theta, order, parts_->how, result);
    return result;
  }
  if (order == LikelihoodOrder::value) {
    parts_->value->evaluate(theta, 0, false, parts_->how, result);
    return result;
  }
  const bool information = order == LikelihoodOrder::information;
  result.gradient.setZero(p);
  if (information) result.information.setZero(p, p);
  for (Index first = 0; first < p; first += parts_->jets) {
    parts_->slope->evaluate(theta, first, information, parts_->how, result);
    if (!result.computed()) break;
  }
  return result;
}

FilterRun InnovationLikelihood::run(std::size_t record,
                                    const Eigen::Ref<const Eigen::VectorXd>& theta) const {
  require_shape(theta, static_cast<Index>(model().parameters.size()), 1, "likelihood", "theta",
                "one entry a parameter");
  require_finite(theta, "likelihood", "theta");
  if (record >= records().size())
    throw InvalidInput("likelihood", fmt::format("record {} came, expected 0 to {}", record,
                                                 records().size() - 1));
  FilterRun run;
  parts_->value->trace(theta, record, parts_->how, run);
  return run;
}

}  // namespace quadtune
