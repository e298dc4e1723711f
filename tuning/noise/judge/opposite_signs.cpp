// SPDX-License-Identifier: Apache-2.0
#include "noise/judge/opposite_signs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/internal/joined.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;

constexpr Index kMaxSamples = 20000;
/// Increase of the log-likelihood that is no chance: a factor of e^20 in the likelihood.
constexpr double kDoubtful = 20;

std::vector<FilterRecord> beginnings(const std::vector<FilterRecord>& records) {
  std::vector<FilterRecord> result;
  for (const FilterRecord& record : records) {
    const Index count = std::min(record.samples(), kMaxSamples);
    FilterRecord& part = result.emplace_back();
    part.name = record.name;
    part.time.assign(record.time.begin(), record.time.begin() + count);
    part.y = record.y.leftCols(count);
    part.u = record.u.leftCols(count);
    part.start = record.start;
  }
  return result;
}

}  // namespace

std::string opposite_signs(const FilterModel& model, const std::vector<FilterRecord>& records,
                           const Eigen::VectorXd& theta, const std::function<bool()>& interrupted) {
  if (!model.linear()) return "";
  const std::vector<FilterRecord> used = beginnings(records);
  const auto log_likelihood = [&](const FilterModel& of) {
    InnovationLikelihood likelihood(of, used);
    likelihood.stop_when(interrupted);
    const Likelihood value = likelihood.evaluate(theta);
    return value.computed() ? value.value : std::nan("");
  };
  const double given = log_likelihood(model);
  std::vector<std::string> doubtful;
  double most = 0;
  const auto compare = [&](const FilterModel& opposite, const std::string& name) {
    const double more = log_likelihood(opposite) - given;
    if (!(more > kDoubtful)) return;
    doubtful.push_back(name);
    most = std::max(most, more);
  };
  for (std::size_t i = 0; i < model.sensors.size(); ++i) {
    FilterModel opposite = model;
    opposite.sensors[i].C *= -1;
    opposite.sensors[i].D *= -1;
    compare(opposite, model.sensors[i].name);
  }
  for (std::size_t j = 0; j < model.inputs.size(); ++j) {
    FilterModel opposite = model;
    const auto column = static_cast<Index>(j);
    opposite.B.col(column) *= -1;
    for (FilterSensor& sensor : opposite.sensors)
      if (sensor.D.size() > 0) sensor.D.col(column) *= -1;
    compare(opposite, model.inputs[j].name);
  }
  if (doubtful.empty()) return "";
  return fmt::format(
      "with the opposite sign of {} the log-likelihood is larger by {:.3g}; expected channels "
      "along "
      "the axes of the model",
      joined(doubtful, " or of "), most);
}

}  // namespace quadtune::internal
