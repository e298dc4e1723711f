// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flight/error_quantiles.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "quadtune/errors.hpp"
#include "quadtune/internal/border.hpp"
#include "quadtune/internal/tails.hpp"

namespace quadtune {
namespace {

/// ‖e‖² at one instant as scale · χ², with the degrees of freedom that match its mean and variance
/// (Satterthwaite); exact for axes with equal variance.
struct SquaredNorm {
  double scale = 0;    ///< [unit²]
  double freedom = 1;  ///< 1 … axes

  SquaredNorm() = default;
  SquaredNorm(double sum, double sum_of_squares) {
    if (!(sum > 0) || !(sum_of_squares > 0)) return;
    freedom = sum * sum / sum_of_squares;
    scale = sum / freedom;
  }
  /// P(‖e‖ > size)
  [[nodiscard]] double exceeds(double size) const {
    if (!(scale > 0)) return 0;
    const double x = size * size / scale;
    return x > 1400 ? 0 : internal::chi_squared_above(x, freedom);
  }
};

/// The smallest size at which a decreasing probability is at most `share`.
template <class Probability>
double size_of(const Probability& probability, double first, double share) {
  double high = first;
  for (int i = 0; i < 60 && probability(high) > share; ++i) high *= 1.5;
  return internal::border([&](double size) { return !(probability(size) > share); }, high, 0.0,
                          1e-4)
      .holds;
}

/// Sums over the axes.
struct Joint {
  Eigen::VectorXd sum;      ///< E‖e‖² at each output
  Eigen::VectorXd squares;  ///< Σ σ⁴
  Eigen::MatrixXd common;   ///< Σ C(s, t)² (starts × outputs)
};

Joint joint_of(const std::vector<ErrorCovariance>& axes) {
  Joint joint;
  for (const ErrorCovariance& axis : axes) {
    if (axis.starts != axes[0].starts || axis.variance.size() != axes[0].variance.size())
      throw InvalidInput("error size", "the axes have different outputs or starts");
    if (joint.sum.size() == 0) {
      joint.sum.setZero(axis.variance.size());
      joint.squares = joint.sum;
      joint.common.setZero(axis.covariance.rows(), axis.covariance.cols());
    }
    joint.sum += axis.variance;
    joint.squares += axis.variance.cwiseAbs2();
    joint.common += axis.covariance.cwiseAbs2();
  }
  return joint;
}

/// 1/τ about a start: -ln ρ / δ, with δ the first lag with a correlation ρ below e^(-1/2).
double decorrelation_rate(const Joint& joint, const std::vector<double>& times, std::size_t row,
                          std::size_t start) {
  const auto at = [](std::size_t i) { return static_cast<Eigen::Index>(i); };
  double rate = 0;
  const double here = joint.common(at(row), at(start));
  for (std::size_t k = start + 1; k < times.size(); ++k) {
    const double size = std::sqrt(here * joint.squares(at(k)));
    if (!(size > 0)) break;
    // If errors have the correlation ρ, their squares have the correlation ρ².
    const double square = std::min(joint.common(at(row), at(k)) / size, 1.0);
    rate = -std::log(std::max(square, 1e-12)) / 2 / (times[k] - times[start]);
    if (square < std::exp(-1.0)) break;
  }
  return rate;
}

}  // namespace

double rarely_exceeded(const std::vector<double>& variances, double share) {
  double sum = 0, squares = 0;
  for (const double variance : variances) {
    sum += variance;
    squares += variance * variance;
  }
  const SquaredNorm norm(sum, squares);
  if (!(norm.scale > 0)) return 0;
  return std::sqrt(norm.scale * internal::chi_squared_exceeded(share, norm.freedom));
}

ErrorSize error_size(const std::vector<ErrorCovariance>& axes, const std::vector<double>& times,
                     const std::vector<bool>& counted, double share) {
  ErrorSize size;
  if (axes.empty() || times.size() != counted.size() ||
      axes[0].variance.size() != std::ssize(times))
    throw InvalidInput("error size", "the numbers of outputs in axes, times and counted disagree");
  if (!(share > 0 && share < 1))
    throw InvalidInput("error size", "the share is not between 0 and 1");
  const Joint joint = joint_of(axes);
  std::vector<std::size_t> judged;
  for (std::size_t k = 0; k < times.size(); ++k)
    if (counted[k]) judged.push_back(k);
  const auto at = [](std::size_t i) { return static_cast<Eigen::Index>(i); };
  double mean = 0;
  for (const std::size_t k : judged) mean += joint.sum(at(k)) / static_cast<double>(judged.size());
  if (!(mean > 0) || !std::isfinite(mean)) return size;
  size.rms = std::sqrt(mean);

  // Each counted output belongs to the last start before it.
  const std::vector<std::size_t>& starts = axes[0].starts;
  std::vector<std::size_t> row_of(times.size(), 0);
  std::vector<double> share_of(starts.size(), 0);
  for (const std::size_t k : judged) {
    const auto after = std::upper_bound(starts.begin(), starts.end(), k);
    row_of[k] = after == starts.begin() ? 0 : static_cast<std::size_t>(after - starts.begin()) - 1;
    if (!starts.empty()) share_of[row_of[k]] += 1 / static_cast<double>(judged.size());
  }

  // Var(1/n Σ ‖e‖²) = 2/n² Σ Σ C(s, t)²
  double variance = 0;
  for (std::size_t j = 0; j < starts.size(); ++j) {
    double row = 0;
    for (const std::size_t k : judged)
      if (k >= starts[j]) row += joint.common(at(j), at(k)) * (k == starts[j] ? 1 : 2);
    variance += 2 * share_of[j] * row / static_cast<double>(judged.size());
  }
  size.samples = variance > 0 ? 2 * mean * mean / variance : 1;
  size.samples = std::max(size.samples, 1.0);
  size.rms_rarely =
      size.rms * std::sqrt(internal::chi_squared_exceeded(share, size.samples) / size.samples);

  // P(max > L) = max_t P(‖e(t)‖ > L) + ∫ (L/σ)² P(‖e(t)‖ > L) dt/τ
  std::vector<double> rates;
  for (std::size_t j = 0; j < starts.size(); ++j)
    rates.push_back(decorrelation_rate(joint, times, j, starts[j]));
  const double spacing = times.size() > 1 ? times[1] - times[0] : 0;
  // A hundred outputs suffice to resolve changes of the variance.
  const std::size_t stride = 1 + judged.size() / 100;
  struct Crossing {
    SquaredNorm norm;
    double time_over_tau;
  };
  std::vector<Crossing> crossings;
  for (std::size_t i = 0; i < judged.size() && !rates.empty(); i += stride) {
    const std::size_t k = judged[i];
    const auto outputs = static_cast<double>(std::min(stride, judged.size() - i));
    crossings.push_back({SquaredNorm(joint.sum(at(k)), joint.squares(at(k))),
                         outputs * spacing * rates[row_of[k]]});
  }
  const std::size_t worst = *std::max_element(
      judged.begin(), judged.end(),
      [&](std::size_t a, std::size_t b) { return joint.sum(at(a)) < joint.sum(at(b)); });
  const SquaredNorm largest(joint.sum(at(worst)), joint.squares(at(worst)));
  const auto exceeds = [&](double max) {
    double sum = largest.exceeds(max);
    for (const Crossing& crossing : crossings)
      if (crossing.norm.scale > 0)
        sum +=
            crossing.time_over_tau * max * max / crossing.norm.scale * crossing.norm.exceeds(max);
    return sum;
  };
  size.most_rarely = size_of(exceeds, 3 * size.rms, share);
  return size;
}

}  // namespace quadtune
