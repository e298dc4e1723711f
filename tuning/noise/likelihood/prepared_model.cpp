// SPDX-License-Identifier: Apache-2.0
#include "noise/likelihood/prepared_model.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "quadtune/discretize/van_loan.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Steps that differ by less than this are treated as equal [s].
constexpr double kSameStep = 1e-7;

/// x ↦ F x + g, or P ↦ F P Fᵀ + g: several steps of a discrete model combined.
struct Steps {
  MatrixXd F, g;
};

/// Combines n steps of a discrete model, by squaring, because a log may have gaps of very many
/// steps.
/// @param then  propagates the g of the earlier steps by the later ones: F g, or F g Fᵀ
template <class Then>
Steps repeated(const MatrixXd& F, const MatrixXd& g, std::int64_t n, Then&& then) {
  Steps all = {MatrixXd::Identity(F.rows(), F.cols()), MatrixXd::Zero(g.rows(), g.cols())};
  Steps some = {F, g};
  for (; n > 0; n /= 2) {
    if (n % 2 == 1) all = {some.F * all.F, then(some.F, all.g) + some.g};
    if (n > 1) some = {some.F * some.F, then(some.F, some.g) + some.g};
  }
  return all;
}

/// The covariance of n steps of a discrete model from that of one step.
MatrixXd accumulated(const MatrixXd& A, const MatrixXd& step, std::int64_t n) {
  return repeated(
             A, step, n,
             [](const MatrixXd& F, const MatrixXd& P) -> MatrixXd { return F * P * F.transpose(); })
      .g;
}

std::vector<KernelSegment> segments_of(const FilterRecord& record,
                                       const SamplesOf<std::uint32_t>& transition) {
  std::vector<KernelSegment> segments;
  std::uint32_t alike = 0;
  for (Index k = 0; k < record.samples(); ++k) {
    bool complete = true;
    for (Index i = 0; i < record.y.rows(); ++i) complete = complete && !std::isnan(record.y(i, k));
    const std::uint32_t step = transition[static_cast<std::size_t>(k)];
    const bool goes_on =
        !segments.empty() && segments.back().complete == complete && (!complete || step == alike);
    if (goes_on)
      segments.back().end = k + 1;
    else
      segments.push_back({k, k + 1, complete});
    alike = step;
  }
  return segments;
}

}  // namespace

std::string not_positive(const PreparedModel& prepared, std::size_t record, Index sample,
                         Index output) {
  Index i = output;
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

std::int64_t step_key(const FilterModel& model, double dt) {
  return std::llround(dt / (model.dt > 0 ? model.dt : kSameStep));
}

double step_of_key(const FilterModel& model, std::int64_t key) {
  return static_cast<double>(key) * (model.dt > 0 ? model.dt : kSameStep);
}

PreparedTransition prepare_transition(const FilterModel& model, double dt) {
  PreparedTransition result;
  const Index nx = model.A.rows();
  const auto sampled = [&](const MatrixXd& Q) -> MatrixXd {
    const MatrixXd noise = model.G * Q * model.G.transpose();
    if (noise.isZero(0)) return MatrixXd::Zero(nx, nx);
    if (model.dt > 0) return accumulated(model.A, noise, std::llround(dt / model.dt));
    return sampled_noise(model.A, noise, dt).Q;
  };
  if (model.dt > 0) {
    Steps steps = repeated(model.A, model.B, std::llround(dt / model.dt),
                           [](const MatrixXd& F, const MatrixXd& B) -> MatrixXd { return F * B; });
    result.F = std::move(steps.F);
    result.B = std::move(steps.g);
  } else {
    ContinuousLti plant;
    plant.A = model.A;
    plant.B = model.B.cols() > 0 ? model.B : MatrixXd::Zero(nx, 1);
    const DiscreteLti held = discretize_zoh(plant, dt);
    result.F = held.A;
    result.B = held.B.leftCols(model.B.cols());
  }
  result.fixed = sampled(model.Q.fixed);
  for (const ScaledCovariance& term : model.Q.scaled) result.shapes.push_back(sampled(term.shape));
  for (const FullCovariance& term : model.Q.full)
    for (std::size_t i = 0; i < term.entries.size(); ++i)
      for (std::size_t j = 0; j <= i; ++j) {
        MatrixXd unit = MatrixXd::Zero(model.Q.size(), model.Q.size());
        unit(term.entries[i], term.entries[j]) = 1;
        unit(term.entries[j], term.entries[i]) = 1;
        result.shapes.push_back(sampled(unit));
      }
  return result;
}

PreparedModel::PreparedModel(FilterModel of, std::vector<FilterRecord> with)
    : model(std::move(of)), records(std::move(with)) {
  const Index ny = model.outputs();
  C.resize(ny, model.A.rows());
  D = MatrixXd::Zero(ny, model.B.cols());
  Index first = 0;
  for (const FilterSensor& sensor : model.sensors) {
    first_output.push_back(first);
    C.middleRows(first, sensor.C.rows()) = sensor.C;
    if (sensor.D.size() > 0) D.middleRows(first, sensor.C.rows()) = sensor.D;
    correlated = correlated || !is_diagonal(sensor.R);
    first += sensor.C.rows();
  }
  if (D.isZero(0)) D.resize(0, 0);

  std::map<std::int64_t, std::uint32_t> known;
  const auto transition = [&](double dt) {
    const std::int64_t key = step_key(model, dt);
    const auto [found, is_new] = known.try_emplace(key, static_cast<std::uint32_t>(known.size()));
    if (is_new) transitions.push_back(prepare_transition(model, step_of_key(model, key)));
    return found->second;
  };
  prepared.resize(records.size());
  for (std::size_t r = 0; r < records.size(); ++r) {
    const FilterRecord& record = records[r];
    PreparedRecord& p = prepared[r];
    p.transition.reserve(record.time.size());
    if (record.linearized.empty())
      for (std::size_t k = 0; k + 1 < record.time.size(); ++k)
        p.transition.push_back(transition(record.time[k + 1] - record.time[k]));
    else
      p.segments = {{0, record.samples(), false}};
    p.transition.push_back(p.transition.empty() ? 0 : p.transition.back());
    if (p.segments.empty()) p.segments = segments_of(record, p.transition);
    p.view = {record.y.data(),
              record.u.data(),
              record.samples(),
              ny,
              model.B.cols(),
              p.transition.data(),
              p.segments.data(),
              p.segments.size(),
              record.linearized.empty() ? nullptr : record.linearized.data(),
              record.start ? &*record.start : nullptr};
  }
}

}  // namespace quadtune::internal
