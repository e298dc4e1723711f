// SPDX-License-Identifier: Apache-2.0
#include "estimation/extended_run.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"

namespace quadtune::internal {

using Eigen::Index;

namespace {

constexpr int kMaxPieces = 1000;  // maximum number of pieces of a step

}  // namespace

std::optional<DrivenRecord> driven_record(const FilterModel& model, const FilterRecord& record,
                                          bool mean, double longest) {
  validate_samples(record, model, record.name);
  std::vector<Index> instants;
  for (Index k = 0; k < record.samples(); ++k)
    if (!record.y.col(k).array().isNaN().all()) instants.push_back(k);
  if (instants.size() < 2) return {};
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
    if (dt > kMaxPieces * longest)
      throw InvalidInput(
          record.name,
          fmt::format("the inputs at {:.9g} s are followed by the next after {:.4g} s, expected at "
                      "most {:.4g} s because the motion between them is integrated in steps of "
                      "{:.4g} s",
                      now, dt, kMaxPieces * longest, longest));
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

ExtendedFilter::ExtendedFilter(FilterModel model, const std::vector<FilterRecord>& records,
                               bool mean, double longest)
    : model_(std::move(model)) {
  for (const FilterRecord& record : records) {
    std::optional<DrivenRecord> driven = driven_record(model_, record, mean, longest);
    if (!driven) {
      left_out_.push_back(quadtune::left_out(record));
      continue;
    }
    driven->of = static_cast<std::size_t>(&record - records.data());
    measurements_.push_back(driven->measured);
    driven_.push_back(std::move(*driven));
  }
  if (!driven_.empty()) return;
  if (records.empty()) throw InvalidInput("logs", "there are no records, expected at least one");
  Index max = 0;
  for (const LeftOutRecord& record : left_out_) max = std::max(max, record.measurements);
  throw InvalidInput(
      records.front().name,
      fmt::format("{}{} with measurements, expected at least 2",
                  records.size() > 1 ? "every section between two gaps has at most " : "",
                  internal::counted(max, "instant")));
}

LinearizedLogs ExtendedFilter::linearize(const Eigen::Ref<const Eigen::VectorXd>& theta,
                                         const std::function<bool()>& stop) const {
  LinearizedLogs result;
  for (std::size_t r = 0; r < driven_.size(); ++r) {
    double failed_at = 0;
    if (run(r, theta, stop, result.records.emplace_back(), failed_at)) continue;
    result.culprit = fmt::format("{}: the extended filter leaves the range of a double at {:.6g} s",
                                 measurements_[r].name, failed_at);
    break;
  }
  return result;
}

}  // namespace quadtune::internal

namespace quadtune {

std::unique_ptr<NonlinearFilter> nonlinear_filter(FilterModel model,
                                                  const std::vector<FilterRecord>& records,
                                                  const std::function<bool()>& stop) {
  validate(model, "filter model");
  if (model.gravity) return internal::inertial_filter(std::move(model), records, stop);
  if (!model.vehicle.empty()) return internal::rigid_body_filter(std::move(model), records);
  throw InvalidInput("filter model",
                     fmt::format("'{}' is linear, expected dynamics = \"inertial\" or "
                                 "\"rigid-body\"",
                                 model.name));
}

}  // namespace quadtune
