// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/innovation_likelihood.hpp"

#include <fmt/format.h>

#include "noise/likelihood/likelihood_engine.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using internal::LikelihoodEngine;
using internal::PreparedModel;
using internal::RunOptions;

}  // namespace

struct InnovationLikelihood::Parts {
  std::shared_ptr<const PreparedModel> prepared;
  std::unique_ptr<LikelihoodEngine> engine;
  RunOptions options;

  explicit Parts(std::shared_ptr<const PreparedModel> of)
      : prepared(std::move(of)), engine(internal::make_likelihood_engine(*prepared)) {}
  Parts(const Parts& other)
      : prepared(other.prepared), engine(other.engine->copy()), options(other.options) {}
  Parts& operator=(const Parts&) = delete;
};

InnovationLikelihood::InnovationLikelihood(FilterModel model, std::vector<FilterRecord> records) {
  validate(model, "filter model");
  if (model.A.rows() > internal::kMaxStates)
    throw InvalidInput("filter model", fmt::format("the model has {} states, expected at most {}",
                                                   model.A.rows(), internal::kMaxStates));
  if (model.outputs() > internal::kMaxOutputs)
    throw InvalidInput("filter model", fmt::format("the model has {} outputs, expected at most {}",
                                                   model.outputs(), internal::kMaxOutputs));
  if (records.empty()) throw InvalidInput("logs", "there are none; expected at least one");
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
void InnovationLikelihood::hold_steady_gains(bool hold) {
  parts_->options.hold_steady_gains = hold;
}
void InnovationLikelihood::stop_when(std::function<bool()> stop) {
  parts_->options.stop = std::move(stop);
}

Likelihood InnovationLikelihood::evaluate(const Eigen::Ref<const Eigen::VectorXd>& theta,
                                          LikelihoodOrder order) const {
  const Index p = static_cast<Index>(model().parameters.size());
  require_shape(theta, p, 1, "likelihood", "theta", "one entry per parameter");
  require_finite(theta, "likelihood", "theta");
  Likelihood result;
  if (p == 0) order = LikelihoodOrder::value;
  parts_->engine->evaluate(theta, order, parts_->options, result);
  return result;
}

FilterRun InnovationLikelihood::run(std::size_t record,
                                    const Eigen::Ref<const Eigen::VectorXd>& theta) const {
  require_shape(theta, static_cast<Index>(model().parameters.size()), 1, "likelihood", "theta",
                "one entry per parameter");
  require_finite(theta, "likelihood", "theta");
  if (record >= records().size())
    throw InvalidInput("likelihood", fmt::format("record {} is out of range; expected 0 to {}",
                                                 record, records().size() - 1));
  FilterRun run;
  parts_->engine->run(theta, record, parts_->options, run);
  return run;
}

}  // namespace quadtune
