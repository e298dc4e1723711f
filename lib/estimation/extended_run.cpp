// SPDX-License-Identifier: Apache-2.0
#include "extended_run.hpp"

#include <fmt/format.h>

#include "quadtune/errors.hpp"

namespace quadtune::internal {

using Eigen::Index;

DrivenRecord driven_record(const FilterModel& model, const FilterRecord& record, bool mean,
                           double longest) {
  validate_samples(record, model, record.name);
  std::vector<Index> instants;
  for (Index k = 0; k < record.samples(); ++k)
    if (!record.y.col(k).array().isNaN().all()) instants.push_back(k);
  if (instants.size() < 2)
    throw InvalidInput(record.name, fmt::format("{} instants with measurements came, expected at "
                                                "least 2",
                                                instants.size()));
  DrivenRecord result;
  result.first = instants.front();
  FilterRecord& measured = result.measured;
  measured.name = record.name;
  measured.y.resize(record.y.rows(), static_cast<Index>(instants.size()));
  measured.truth.resize(record.truth.rows(), record.truth.size() > 0 ? measured.y.cols() : 0);
  measured.u = Eigen::MatrixXd::Zero(record.u.rows(), measured.y.cols());
  std::vector<Eigen::VectorXd> inputs;
  std::size_t next = 0;
  for (Index k = instants.front(); k <= instants.back(); ++k) {
    const double now = record.time[static_cast<std::size_t>(k)];
    if (k == instants[next]) {
      measured.time.push_back(now);
      if (record.truth.size() > 0)
        measured.truth.col(static_cast<Index>(next)) = record.truth.col(k);
      measured.y.col(static_cast<Index>(next++)) = record.y.col(k);
      result.drive.arrival.push_back(static_cast<Index>(inputs.size()));
    }
    if (k == instants.back()) break;
    const double dt = record.time[static_cast<std::size_t>(k) + 1] - now;
    const Eigen::VectorXd u = mean ? Eigen::VectorXd(0.5 * (record.u.col(k) + record.u.col(k + 1)))
                                   : Eigen::VectorXd(record.u.col(k));
    const int pieces = std::max(1, static_cast<int>(std::ceil(dt / longest - 1e-6)));
    for (int i = 0; i < pieces; ++i) {
      result.drive.dt.push_back(dt / pieces);
      inputs.push_back(u);
    }
  }
  result.drive.u.resize(record.u.rows(), static_cast<Index>(inputs.size()));
  for (std::size_t i = 0; i < inputs.size(); ++i)
    result.drive.u.col(static_cast<Index>(i)) = inputs[i];
  return result;
}

const DrivenRecord& ExtendedFilter::add(const FilterRecord& record, bool mean, double longest) {
  driven_.push_back(driven_record(model_, record, mean, longest));
  measurements_.push_back(driven_.back().measured);
  return driven_.back();
}

LinearizedLogs ExtendedFilter::linearize(const Eigen::Ref<const Eigen::VectorXd>& theta) const {
  LinearizedLogs result;
  for (std::size_t r = 0; r < driven_.size(); ++r) {
    double failed_at = 0;
    if (run(r, theta, result.records.emplace_back(), failed_at)) continue;
    result.culprit = fmt::format("{}: the extended filter leaves the range of a double at {:.6g} s",
                                 measurements_[r].name, failed_at);
    break;
  }
  return result;
}

}  // namespace quadtune::internal

namespace quadtune {

std::unique_ptr<NonlinearFilter> nonlinear_filter(FilterModel model,
                                                  const std::vector<FilterRecord>& records) {
  validate(model, "filter model");
  if (model.gravity) return internal::inertial_filter(std::move(model), records);
  if (!model.vehicle.empty()) return internal::rigid_body_filter(std::move(model), records);
  throw InvalidInput("filter model",
                     fmt::format("'{}' is linear, expected dynamics = \"inertial\" or "
                                 "\"rigid-body\"",
                                 model.name));
}

}  // namespace quadtune
