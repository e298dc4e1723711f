// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/noise_tuning.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Least number of innovations that a stretch held out must have to say something.
constexpr Index kLeastHeldOut = 30;

/// A record up to the share, and the rest of it.
void split(const FilterRecord& record, double holdout, std::vector<FilterRecord>& first,
           std::vector<FilterRecord>& rest) {
  const Index N = record.samples();
  const auto cut = static_cast<Index>(std::ceil(static_cast<double>(N) * (1 - holdout)));
  const auto part = [&](Index begin, Index count) {
    FilterRecord result;
    result.name = record.name;
    result.time.assign(record.time.begin() + begin, record.time.begin() + begin + count);
    result.y = record.y.middleCols(begin, count);
    result.u = record.u.middleCols(begin, count);
    return result;
  };
  first.push_back(part(0, cut));
  if (N - cut > 1) rest.push_back(part(cut, N - cut));
}

Consistency consistency_of(const InnovationLikelihood& likelihood, const VectorXd& theta,
                           const ConsistencyOptions& options) {
  std::vector<FilterRun> runs;
  for (std::size_t r = 0; r < likelihood.records().size(); ++r) {
    runs.push_back(likelihood.run(r, theta));
    if (runs.back().status != LikelihoodStatus::computed) {
      Consistency none;
      none.verdict = CheckVerdict::fail;
      none.reasons = {runs.back().culprit.empty() ? "innovations leave the range of a double"
                                                  : runs.back().culprit};
      return none;
    }
  }
  return check_consistency(likelihood.model(), runs, options);
}

HoldOut compare_held_out(const FilterModel& model, const std::vector<FilterRecord>& rest,
                         const VectorXd& before, const VectorXd& after) {
  HoldOut result;
  if (rest.empty()) {
    result.reason = "nothing is held out";
    return result;
  }
  const InnovationLikelihood likelihood(model, rest);
  const Likelihood old = likelihood.evaluate(before), fresh = likelihood.evaluate(after);
  result.innovations = fresh.innovations;
  const auto n = static_cast<double>(fresh.innovations);
  result.before = old.value / n;
  result.after = fresh.value / n;
  if (fresh.innovations < kLeastHeldOut) {
    result.reason = fmt::format("{} innovations held out, too few to tell", fresh.innovations);
  } else if (!fresh.computed() || (old.computed() && fresh.value < old.value)) {
    result.verdict = CheckVerdict::fail;
    result.reason = fmt::format(
        "the stretch held out is less likely than before: {:.4g} an innovation instead of {:.4g}",
        result.after, result.before);
  } else {
    result.verdict = CheckVerdict::pass;
  }
  return result;
}

void judge(NoiseTuning& tuning, bool has_holdout) {
  const NoiseFit& fit = tuning.fit;
  const auto worsen = [&](CheckVerdict to, const std::string& reason) {
    tuning.reasons.push_back(reason);
    if (tuning.verdict != CheckVerdict::fail) tuning.verdict = to;
  };
  tuning.verdict = CheckVerdict::pass;
  if (!fit.converged())
    worsen(CheckVerdict::fail, fmt::format("the fit is {}{}", to_string(fit.status),
                                           fit.culprit.empty() ? "" : ": " + fit.culprit));
  for (const std::string& direction : fit.unseen) worsen(CheckVerdict::fail, direction);
  for (const std::string& reason : tuning.after.reasons) worsen(tuning.after.verdict, reason);
  if (has_holdout && tuning.holdout.verdict != CheckVerdict::pass)
    worsen(tuning.holdout.verdict, tuning.holdout.reason);
}

}  // namespace

FilterModel with_noise(FilterModel model, const Eigen::Ref<const VectorXd>& theta) {
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    const double value = theta(static_cast<Index>(i));
    model.parameters[i].start = model.parameters[i].logarithmic ? std::exp(value) : value;
  }
  return model;
}

NoiseTuning tune_noise(const FilterModel& model, const std::vector<FilterRecord>& records,
                       const NoiseTuningOptions& options) {
  if (!(options.holdout >= 0 && options.holdout <= 0.9))
    throw InvalidInput("tuning", fmt::format("holdout is {}, expected 0 to 0.9", options.holdout));
  std::vector<FilterRecord> first, rest;
  for (const FilterRecord& record : records) split(record, options.holdout, first, rest);
  NoiseTuning tuning;
  const InnovationLikelihood likelihood(model, first);
  tuning.fit = fit_noise(likelihood, options.fit);
  if (tuning.fit.status == NoiseFitStatus::not_computed) {
    judge(tuning, false);
    return tuning;
  }
  const VectorXd start = start_of(model);
  tuning.before = consistency_of(likelihood, start, options.consistency);
  tuning.after = consistency_of(likelihood, tuning.fit.theta, options.consistency);
  if (options.holdout > 0) tuning.holdout = compare_held_out(model, rest, start, tuning.fit.theta);
  judge(tuning, options.holdout > 0);
  return tuning;
}

}  // namespace quadtune
