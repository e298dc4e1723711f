// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/state_errors.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>

#include "quadtune/estimation/inertial_filter.hpp"
#include "quadtune/internal/tails.hpp"
#include "quadtune/model/rigid_body.hpp"
#include "quadtune/model/rotation.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Above this lag correlations are evaluated in steps of a tenth of the lag, so that the time grows
/// with n log n, not n².
constexpr std::size_t kEveryLag = 32;

/// Effective number of independent terms of a sum of correlated ones: n / (1 + 2 Σ f(ρ)), ρ the
/// autocorrelation about `center` up to the lag at which it is below its noise.
double independent_terms(const Samples& terms, double center,
                         const std::function<double(double)>& weight) {
  const auto n = static_cast<double>(terms.size());
  const auto covariance = [&](std::size_t lag) {
    double sum = 0;
    for (std::size_t k = lag; k < terms.size(); ++k)
      sum += (terms[k] - center) * (terms[k - lag] - center);
    return sum;
  };
  const double variance = covariance(0);
  // 1 + 2 Σ f, by trapezoids between the evaluated lags.
  double sum = 0, last_weight = 1;
  std::size_t last = 0;
  for (std::size_t lag = 1; lag < terms.size() / 2; lag += 1 + (lag < kEveryLag ? 0 : lag / 10)) {
    const double r = covariance(lag) / variance;
    if (!(r > 2 / std::sqrt(n))) break;
    const double here = weight(r);
    sum += static_cast<double>(lag - last) * (last_weight + here);
    last = lag;
    last_weight = here;
  }
  return n / (sum + last_weight);
}

double mean_of_terms(const Samples& terms) {
  double sum = 0;
  for (const double value : terms) sum += value;
  return sum / static_cast<double>(terms.size());
}

/// The error of one record at one instant; NaN if the true value is not known.
using ErrorAt = std::function<double(const FilterRecord&, const FilterRun&, Index)>;

StateAccuracy compare(const std::string& state, const std::string& unit, const ErrorAt& error,
                      const TrueRuns& before, const TrueRuns& after) {
  StateAccuracy result{state, unit};
  double first = 0, second = 0, change = 0, variance = 0, independent = 0;
  for (std::size_t r = 0; r < after.runs.size(); ++r) {
    if (after.records[r].truth.size() == 0 || before.records[r].truth.size() == 0) continue;
    Samples changes;
    for (Index k = 0; k < after.runs[r].x.cols(); ++k) {
      const double e0 = error(before.records[r], before.runs[r], k);
      const double e1 = error(after.records[r], after.runs[r], k);
      if (!std::isfinite(e0) || !std::isfinite(e1)) continue;
      first += e0 * e0;
      second += e1 * e1;
      changes.push_back(e1 * e1 - e0 * e0);
    }
    result.samples += static_cast<Index>(changes.size());
    for (const double value : changes) {
      change += value;
      variance += value * value;
    }
    if (changes.size() > 2)
      independent +=
          independent_terms(changes, mean_of_terms(changes), [](double rho) { return rho; });
  }
  if (result.samples == 0) return result;
  const auto n = static_cast<double>(result.samples);
  result.before = std::sqrt(first / n);
  result.after = std::sqrt(second / n);
  change /= n;
  variance = std::max(variance / n - change * change, 0.0);
  if (independent > 2 && variance > 0)
    result.p = 2 * internal::student_above(std::abs(change) / std::sqrt(variance / independent),
                                           independent - 1);
  return result;
}

/// Angle of the rotation from the estimated attitude to the true one.
ErrorAt rotation_error(const FilterModel& model) {
  const bool small_turns = model.gravity.has_value();
  const Index first = small_turns ? kInertialAttitude : Index{kAttitude};
  return [=](const FilterRecord& record, const FilterRun& run, Index k) {
    const Vector3d x = run.x.col(k).segment<3>(first);
    const Vector3d truth = record.truth.col(k).segment<3>(first);
    if (!x.allFinite() || !truth.allFinite()) return std::nan("");
    const auto rotation = [&](const Vector3d& of) -> Eigen::Matrix3d {
      if (!small_turns) return rotation_of_euler(of(0), of(1), of(2));
      const double angle = of.norm();
      return angle > 0 ? Eigen::AngleAxisd(angle, of / angle).toRotationMatrix()
                       : Eigen::Matrix3d::Identity().eval();
    };
    return Eigen::AngleAxisd(rotation(x).transpose() * rotation(truth)).angle();
  };
}

}  // namespace

std::vector<ConsistencyCheck> check_errors(const FilterModel& model,
                                           const std::vector<FilterRecord>& records,
                                           const std::vector<FilterRun>& runs,
                                           const ConsistencyOptions& options) {
  validate(options);
  std::vector<ConsistencyCheck> checks;
  for (Index i = 0; i < model.A.rows(); ++i) {
    double squares = 0, count = 0, independent = 0;
    for (std::size_t r = 0; r < runs.size(); ++r) {
      if (records[r].truth.size() == 0) continue;
      Samples z;
      for (Index k = 0; k < runs[r].x.cols(); ++k) {
        const double value =
            (runs[r].x(i, k) - records[r].truth(i, k)) / std::sqrt(runs[r].x_variance(i, k));
        if (std::isfinite(value)) z.push_back(value);
      }
      for (const double value : z) squares += value * value;
      count += static_cast<double>(z.size());
      // The correlations of the squares of normal errors are the squares of their correlations. The
      // errors of a right filter have mean zero. If a filter is wrong by a constant for the whole
      // record, the deviations from its mean would look like many independent errors.
      if (z.size() > 2)
        independent += independent_terms(z, 0, [](double rho) { return rho * rho; });
    }
    if (count == 0) continue;
    ConsistencyCheck c{"error", model.states[static_cast<std::size_t>(i)].name, squares / count};
    const double freedom = std::max(independent, 1.0), half = 0.5 * options.significance;
    c.low = internal::chi_squared_exceeded(1 - half, freedom) / freedom;
    c.high = internal::chi_squared_exceeded(half, freedom) / freedom;
    c.p = internal::chi_squared_two_sided(c.value * freedom, freedom);
    if (!(c.value >= c.low && c.value <= c.high) &&
        !(c.value >= options.min_size && c.value <= options.max_size)) {
      c.verdict = CheckVerdict::fail;
      c.reason = fmt::format(
          "{}: the mean squared error is {:.3g} times its variance, expected {:.3g} to {:.3g} "
          "times",
          c.output, c.value, c.low, c.high);
      if (constexpr double kOtherAxis = 100; c.value > kOtherAxis)
        c.reason += "; the sign, the unit or the origin of the true value may be wrong";
    }
    checks.push_back(c);
  }
  return checks;
}

std::vector<StateAccuracy> compare_errors(const FilterModel& model, const TrueRuns& before,
                                          const TrueRuns& after) {
  std::vector<StateAccuracy> result;
  const auto add = [&](const std::string& state, const std::string& unit, const ErrorAt& error) {
    StateAccuracy one = compare(state, unit, error, before, after);
    if (one.samples > 0) result.push_back(std::move(one));
  };
  if (!model.linear()) add("attitude", "rad", rotation_error(model));
  for (Index i = 0; i < model.A.rows(); ++i) {
    const Signal& state = model.states[static_cast<std::size_t>(i)];
    add(state.name, state.unit, [i](const FilterRecord& record, const FilterRun& run, Index k) {
      return run.x(i, k) - record.truth(i, k);
    });
  }
  return result;
}

}  // namespace quadtune
