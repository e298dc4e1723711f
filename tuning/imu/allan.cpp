// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/allan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Index = Eigen::Index;
using Phase = Eigen::Ref<const Eigen::VectorXd>;

/// Number of phases that the first term of a kind uses, minus one, for means over m.
std::size_t reach(AllanKind kind, std::size_t m) {
  switch (kind) {
    case AllanKind::modified:
    case AllanKind::time:
      return 3 * m - 1;
    case AllanKind::hadamard:
    case AllanKind::overlapping_hadamard:
      return 3 * m;
    case AllanKind::total:
      return std::max<std::size_t>(m, 2);  // a reflection needs as many phases as it adds
    default:
      return 2 * m;
  }
}

/// A mean of squares. Sums of positive terms in long double lose no significant accuracy.
class MeanSquare {
 public:
  void add(double value) {
    sum_ += static_cast<long double>(value) * static_cast<long double>(value);
    ++terms_;
  }
  [[nodiscard]] AllanPoint point(std::size_t m, double dt, double divisor) const {
    const double tau = static_cast<double>(m) * dt;
    const auto mean = static_cast<double>(sum_ / static_cast<long double>(terms_));
    return {m, tau, std::sqrt(mean / divisor) / tau, terms_};
  }

 private:
  long double sum_ = 0;
  std::size_t terms_ = 0;
};

// σ² = Σ (x[i+2m] - 2 x[i+m] + x[i])² / (2 τ² terms)
AllanPoint allan(const Phase& x, std::size_t factor, double dt, bool overlapping) {
  const auto m = static_cast<Index>(factor);
  MeanSquare mean;
  for (Index i = 0; i + 2 * m < x.size(); i += overlapping ? 1 : m)
    mean.add((x(i + 2 * m) - x(i + m)) - (x(i + m) - x(i)));
  return mean.point(factor, dt, 2);
}

// σ² = Σ (x[i+3m] - 3 x[i+2m] + 3 x[i+m] - x[i])² / (6 τ² terms)
AllanPoint hadamard(const Phase& x, std::size_t factor, double dt, bool overlapping) {
  const auto m = static_cast<Index>(factor);
  MeanSquare mean;
  for (Index i = 0; i + 3 * m < x.size(); i += overlapping ? 1 : m)
    mean.add((x(i + 3 * m) - x(i)) - 3 * (x(i + 2 * m) - x(i + m)));
  return mean.point(factor, dt, 6);
}

// As allan(), but each term is a mean over m adjacent second differences, updated by one difference
// at a time.
AllanPoint modified(const Phase& x, std::size_t factor, double dt) {
  const auto m = static_cast<Index>(factor);
  const auto difference = [&](Index i) { return (x(i + 2 * m) - x(i + m)) - (x(i + m) - x(i)); };
  long double sum = 0;
  for (Index i = 0; i < m; ++i) sum += difference(i);
  MeanSquare mean;
  for (Index i = 0;; ++i) {
    mean.add(static_cast<double>(sum) / static_cast<double>(m));
    if (i + 3 * m >= x.size()) break;
    sum += difference(i + m) - difference(i);
  }
  return mean.point(factor, dt, 2);
}

// As allan() around every inner phase, on the phase extended by reflection about its ends.
AllanPoint total(const Phase& x, std::size_t factor, double dt) {
  const auto m = static_cast<Index>(factor);
  const Index n = x.size();
  const auto at = [&](Index i) {
    if (i < 0) return 2 * x(0) - x(-i);
    if (i >= n) return 2 * x(n - 1) - x(2 * (n - 1) - i);
    return x(i);
  };
  MeanSquare mean;
  for (Index i = 1; i + 1 < n; ++i) mean.add((at(i + m) - x(i)) - (x(i) - at(i - m)));
  return mean.point(factor, dt, 2);
}

AllanPoint point_of(const Phase& x, std::size_t m, double dt, AllanKind kind) {
  switch (kind) {
    case AllanKind::plain:
      return allan(x, m, dt, false);
    case AllanKind::overlapping:
      return allan(x, m, dt, true);
    case AllanKind::modified:
      return modified(x, m, dt);
    case AllanKind::time: {
      AllanPoint point = modified(x, m, dt);
      point.deviation *= point.tau / std::numbers::sqrt3;
      return point;
    }
    case AllanKind::total:
      return total(x, m, dt);
    case AllanKind::hadamard:
      return hadamard(x, m, dt, false);
    case AllanKind::overlapping_hadamard:
      break;
  }
  return hadamard(x, m, dt, true);
}

void check(const Phase& values, const char* what, double dt) {
  if (!(dt > 0) || !std::isfinite(dt))
    throw InvalidInput(
        "allan", fmt::format("the sample period is {} s, expected a positive finite one", dt));
  for (Index i = 0; i < values.size(); ++i)
    if (!std::isfinite(values(i)))
      throw InvalidInput(
          "allan", fmt::format("sample {} of the {} is {}, expected a finite number, because means "
                               "over a gap would be of another length",
                               i + 1, what, values(i)));
}

std::vector<AllanPoint> points_of(const Phase& phase, double dt,
                                  const std::vector<std::size_t>& factors, AllanKind kind) {
  const auto last = static_cast<std::size_t>(std::max<Index>(phase.size(), 1)) - 1;
  std::vector<AllanPoint> points;
  points.reserve(factors.size());
  for (const std::size_t m : factors) {
    if (m < 1 || m > last || reach(kind, m) > last)
      throw InvalidInput(
          "allan", fmt::format("means over {} samples were requested of {} samples; expected at "
                               "least 1 and few enough to leave one difference",
                               m, last));
    points.push_back(point_of(phase, m, dt, kind));
  }
  return points;
}

}  // namespace

std::vector<std::size_t> allan_factors(std::size_t samples, AllanTaus taus, AllanKind kind) {
  std::vector<std::size_t> factors;
  const auto fits = [&](std::size_t m) { return m <= samples && reach(kind, m) <= samples; };
  if (taus == AllanTaus::decades) {
    for (std::size_t decade = 1; fits(decade); decade *= 10)
      for (const std::size_t step : {1, 2, 4})
        if (fits(step * decade)) factors.push_back(step * decade);
    return factors;
  }
  for (std::size_t m = 1; fits(m); m = taus == AllanTaus::octaves ? 2 * m : m + 1)
    factors.push_back(m);
  return factors;
}

Eigen::VectorXd rate_of_phase(const Eigen::Ref<const Eigen::VectorXd>& phase, double dt) {
  if (phase.size() < 2) return {};
  return (phase.tail(phase.size() - 1) - phase.head(phase.size() - 1)) / dt;
}

std::vector<AllanPoint> allan_deviation_of_phase(const Phase& phase, double dt,
                                                 const std::vector<std::size_t>& factors,
                                                 AllanKind kind) {
  check(phase, "phase", dt);
  return points_of(phase, dt, factors, kind);
}

std::vector<AllanPoint> allan_deviation(const Eigen::Ref<const Eigen::VectorXd>& rate, double dt,
                                        const std::vector<std::size_t>& factors, AllanKind kind) {
  check(rate, "rate", dt);
  // A constant rate is a straight line in the phase, which does not affect any kind of deviation.
  // Without it the phase starts and ends at zero and stays as small as the noise allows, so that
  // its rounding error as a double, 1e-16 of the largest phase, is far below its differences. The
  // sums are in extended precision, where 1e9 terms lose less than that.
  long double sum = 0;
  for (const double value : rate) sum += value;
  const auto mean =
      static_cast<double>(sum / static_cast<long double>(std::max<Index>(rate.size(), 1)));
  Eigen::VectorXd phase(rate.size() + 1);
  phase(0) = 0;
  long double x = 0;
  for (Index i = 0; i < rate.size(); ++i) {
    x += rate(i) - mean;
    phase(i + 1) = static_cast<double>(x * dt);
  }
  return points_of(phase, dt, factors, kind);
}

}  // namespace quadtune
