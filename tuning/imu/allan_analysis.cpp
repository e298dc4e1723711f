// SPDX-License-Identifier: Apache-2.0
// Estimates the noise coefficients of a rate by a generalized least-squares fit of Q², N², B², K²
// to Allan variances.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "imu/allan_covariance.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/tails.hpp"
#include "quadtune/tuning/allan.hpp"

namespace quadtune {
namespace {

using Index = Eigen::Index;
using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr double kFloorOfBias = 0.664;  // √(2 ln 2/π), IEEE 952, C.1.3
constexpr std::size_t kMinMeans = 5;    // minimum number of independent means of a point of the fit
// Allowed relative errors of a variance, because real noises deviate from power laws. The smallest
// sufficient one is used.
constexpr std::array<double, 3> kModelErrors = {0.01, 0.03, 0.1};
constexpr double kWorthATerm = 6.635;   // minimum reduction of chi-squared by a noise: 99 %
constexpr double kMisfit = 0.999;       // quantile of chi-squared above which a fit is rejected
constexpr double kMisfitOfSome = 0.95;  // likewise for all later attempts
constexpr double kLowQuantile = 0.025, kHighQuantile = 0.975;
constexpr double kOneSided = 1.6449;  // standard deviations of a 95 % bound

double chi_squared_quantile(double degrees, double probability) {
  return internal::chi_squared_quantile(probability, degrees);
}

/// 95 % interval of √variance for an estimate with `edf` degrees of freedom.
std::array<double, 2> interval(double variance, double edf) {
  return {std::sqrt(variance * edf / chi_squared_quantile(edf, kHighQuantile)),
          std::sqrt(variance * edf / chi_squared_quantile(edf, kLowQuantile))};
}

/// Allan variances at the octaves with the terms of their covariances.
struct Octaves {
  std::vector<AllanPoint> points;
  std::vector<AllanCovariance> covariances;  ///< row by row

  [[nodiscard]] Index size() const { return std::ssize(points); }
  [[nodiscard]] Matrix covariance(const NoiseVariances& noises) const {
    Matrix C(size(), size());
    for (Index i = 0; i < size(); ++i)
      for (Index j = 0; j < size(); ++j)
        C(i, j) =
            covariances[static_cast<std::size_t>(std::min(i, j) * size() + std::max(i, j))].at(
                noises);
    return C;
  }
};

Octaves octaves_of(const Eigen::Ref<const Vector>& rate, double dt) {
  const auto samples = static_cast<std::size_t>(rate.size());
  std::vector<std::size_t> factors = allan_factors(samples, AllanTaus::octaves);
  std::erase_if(factors, [&](std::size_t m) { return m * kMinMeans > samples; });
  Octaves octaves{allan_deviation(rate, dt, factors), {}};
  octaves.covariances.reserve(factors.size() * factors.size());
  for (const std::size_t m1 : factors)
    for (const std::size_t m2 : factors)
      octaves.covariances.emplace_back(samples, std::min(m1, m2), std::max(m1, m2), dt);
  return octaves;
}

/// A fit of some of the noises to the octaves from a given one on.
struct Fit {
  NoiseVariances noises{};
  NoiseVariances errors{};  ///< standard errors
  std::array<bool, kAllanNoises> in{};
  double chi_squared = std::numeric_limits<double>::infinity();
  int degrees = 0;
};

/// Generalized least squares of the noises `in`, for a covariance given by its factor. The noise
/// variances may be negative.
Fit least_squares(const Octaves& octaves, Index from, const Eigen::LLT<Matrix>& C,
                  const std::array<bool, kAllanNoises>& in) {
  std::vector<std::size_t> terms;
  for (std::size_t k = 0; k < kAllanNoises; ++k)
    if (in[k]) terms.push_back(k);
  const Index rows = octaves.size() - from, cols = std::ssize(terms);
  Matrix X(rows, cols);
  Vector y(rows);
  for (Index i = 0; i < rows; ++i) {
    const AllanPoint& point = octaves.points[static_cast<std::size_t>(from + i)];
    y(i) = point.deviation * point.deviation;
    const NoiseVariances unit = allan_variance_of_noises(point.tau);
    for (Index k = 0; k < cols; ++k) X(i, k) = unit[terms[static_cast<std::size_t>(k)]];
  }
  const Eigen::RowVectorXd scale = X.colwise().maxCoeff();
  X.array().rowwise() /= scale.array();
  C.matrixL().solveInPlace(X);
  C.matrixL().solveInPlace(y);
  const Eigen::LLT<Matrix> normal(X.transpose() * X);
  const Vector solution = normal.solve(X.transpose() * y);
  const Matrix inverse = normal.solve(Matrix::Identity(cols, cols));
  Fit fit;
  fit.in = in;
  for (Index k = 0; k < cols; ++k) {
    const std::size_t term = terms[static_cast<std::size_t>(k)];
    fit.noises[term] = solution(k) / scale(k);
    fit.errors[term] = std::sqrt(inverse(k, k)) / scale(k);
  }
  fit.chi_squared = (y - X * solution).squaredNorm();
  fit.degrees = static_cast<int>(rows - cols);
  return fit;
}

/// Selects the set of noises, none negative, with the best fit: each noise must reduce chi-squared
/// by kWorthATerm.
Fit best_choice(const Octaves& octaves, Index from, const Matrix& covariance) {
  const Eigen::LLT<Matrix> C(covariance);
  Fit best;
  double min = std::numeric_limits<double>::infinity();
  for (unsigned choice = 1; choice < (1U << kAllanNoises); ++choice) {
    std::array<bool, kAllanNoises> in{};
    int count = 0;
    for (std::size_t k = 0; k < kAllanNoises; ++k) count += (in[k] = (choice >> k) & 1U) ? 1 : 0;
    if (count >= octaves.size() - from) continue;
    const Fit fit = least_squares(octaves, from, C, in);
    bool allowed = std::isfinite(fit.chi_squared);
    for (std::size_t k = 0; k < kAllanNoises; ++k)
      allowed = allowed && (!in[k] || fit.noises[k] > 0);
    if (allowed && fit.chi_squared + kWorthATerm * count < min) {
      min = fit.chi_squared + kWorthATerm * count;
      best = fit;
    }
  }
  return best;
}

Matrix with_model_error(Matrix C, const Octaves& octaves, Index from, double error) {
  for (Index i = 0; i < C.rows(); ++i) {
    const double sigma = octaves.points[static_cast<std::size_t>(from + i)].deviation;
    C(i, i) += std::pow(error * sigma * sigma, 2);
  }
  return C;
}

/// Covariance of white noise with the size of each point: the initial weights.
Matrix first_covariance(const Octaves& octaves, Index from, std::size_t samples, double error) {
  const Index rows = octaves.size() - from;
  Matrix C = Matrix::Zero(rows, rows);
  for (Index i = 0; i < rows; ++i) {
    const AllanPoint& point = octaves.points[static_cast<std::size_t>(from + i)];
    C(i, i) = std::pow(point.deviation, 4) * 2 * static_cast<double>(point.m) /
              static_cast<double>(samples);
  }
  return with_model_error(C, octaves, from, error);
}

Matrix covariance_from(const Octaves& octaves, Index from, const NoiseVariances& noises) {
  const Index rows = octaves.size() - from;
  return octaves.covariance(noises).bottomRightCorner(rows, rows);
}

/// Selects the noises; the weights are recomputed from the fit until the selection no longer
/// changes.
Fit choose_noises(const Octaves& octaves, Index from, std::size_t samples, double error) {
  Fit fit = best_choice(octaves, from, first_covariance(octaves, from, samples, error));
  constexpr int kMaxRounds = 8;
  for (int round = 0; round < kMaxRounds && std::isfinite(fit.chi_squared); ++round) {
    const Fit next = best_choice(
        octaves, from,
        with_model_error(covariance_from(octaves, from, fit.noises), octaves, from, error));
    if (!std::isfinite(next.chi_squared)) break;
    const bool same = next.in == fit.in;
    fit = next;
    if (same && round > 1) break;
  }
  return fit;
}

bool acceptable(const Fit& fit, double probability = kMisfit) {
  return std::isfinite(fit.chi_squared) &&
         fit.chi_squared <= chi_squared_quantile(std::max(fit.degrees, 1), probability);
}

double model_variance(const NoiseVariances& noises, double tau) {
  const NoiseVariances unit = allan_variance_of_noises(tau);
  double sum = 0;
  for (std::size_t k = 0; k < kAllanNoises; ++k) sum += noises[k] * unit[k];
  return sum;
}

/// Whether white noise dominates the first octaves of a fit. Only then may the fit omit earlier
/// octaves, which a low-pass filter shaped.
bool begins_white(const Octaves& octaves, Index from, const Fit& fit) {
  constexpr Index kMin = 3;
  const auto white = static_cast<std::size_t>(AllanNoise::white);
  for (Index i = from; i < from + kMin; ++i) {
    const double tau = octaves.points[static_cast<std::size_t>(i)].tau;
    if (fit.noises[white] / tau < 0.5 * model_variance(fit.noises, tau)) return false;
  }
  return true;
}

/// The fit to the largest number of octaves that the noises describe, since filters shape the first
/// few octaves of many sensors. If there is none, the fit to all octaves.
struct Described {
  Fit fit;
  Index from = 0;
  bool explained = false;
  double model_error = 0;
};

Described describe(const Octaves& octaves, std::size_t samples) {
  constexpr Index kMinPoints = 4;
  Fit all;
  for (const double error : kModelErrors) {
    all = choose_noises(octaves, 0, samples, error);
    if (acceptable(all, error == kModelErrors.front() ? kMisfit : kMisfitOfSome))
      return {all, 0, true, error};
    const Index last = std::min(octaves.size() - kMinPoints, octaves.size() / 2);
    for (Index from = 1; from <= last; ++from) {
      const Fit fit = choose_noises(octaves, from, samples, error);
      if (acceptable(fit, kMisfitOfSome) && begins_white(octaves, from, fit))
        return {fit, from, true, error};
    }
  }
  return {all, 0, false, kModelErrors.back()};
}

/// Recomputes values and errors without the allowance for model errors, which is not an error of
/// the record.
void sharpen(const Octaves& octaves, Described& described) {
  Fit& fit = described.fit;
  for (int round = 0; round < 3; ++round) {
    const Eigen::LLT<Matrix> C(covariance_from(octaves, described.from, fit.noises));
    if (C.info() != Eigen::Success) return;
    const Fit next = least_squares(octaves, described.from, C, fit.in);
    for (std::size_t k = 0; k < kAllanNoises; ++k)
      if (!std::isfinite(next.chi_squared) || (fit.in[k] && !(next.noises[k] > 0))) return;
    fit = next;
  }
  if (acceptable(fit) || fit.degrees < 1) return;
  // The noises are not exact power laws, so the misfit widens the intervals [Birge 1932].
  const double ratio = std::sqrt(fit.chi_squared / fit.degrees);
  for (double& error : fit.errors) error *= ratio;
}

/// The smallest coefficient that this record would reveal with 95 % probability.
double bound(const Octaves& octaves, const Described& described, std::size_t term) {
  std::array<bool, kAllanNoises> in = described.fit.in;
  in[term] = true;
  const Eigen::LLT<Matrix> C(covariance_from(octaves, described.from, described.fit.noises));
  if (C.info() != Eigen::Success) return 0;
  const Fit fit = least_squares(octaves, described.from, C, in);
  const double max = std::max(fit.noises[term], 0.0) + kOneSided * fit.errors[term];
  return std::isfinite(max) ? std::sqrt(max) : 0;
}

/// @param absence  why the curve does not show this noise, with the ends of tau in braces
AllanReading read(const Octaves& octaves, const Described& described, AllanNoise noise,
                  const std::string& absence) {
  const auto term = static_cast<std::size_t>(noise);
  const Fit& fit = described.fit;
  AllanReading reading;
  for (Index i = described.from; fit.in[term] && i < octaves.size(); ++i) {
    const double tau = octaves.points[static_cast<std::size_t>(i)].tau;
    const double part = fit.noises[term] * allan_variance_of_noises(tau)[term];
    if (part < 0.5 * model_variance(fit.noises, tau)) continue;
    if (!reading.seen) reading.tau_from = tau;
    reading.tau_to = tau;
    reading.seen = true;
  }
  if (!described.explained) {
    reading = {};
    reading.reason = "the curve is not a sum of noises, so none can be estimated from it";
    return reading;
  }
  if (!reading.seen) {
    reading.reason = absence;
    reading.at_most = bound(octaves, described, term);
    return reading;
  }
  const double variance = fit.noises[term];
  const double edf = 2 * std::pow(variance / fit.errors[term], 2);
  reading.value = std::sqrt(variance);
  const std::array<double, 2> ends = interval(variance, edf);
  reading.low = ends[0];
  reading.high = ends[1];
  return reading;
}

AllanCurvePoint with_interval(const AllanPoint& point, const Fit& fit, std::size_t samples,
                              double dt) {
  AllanCurvePoint result;
  result.point = point;
  const double model = model_variance(fit.noises, point.tau);
  result.model = std::sqrt(model);
  const double spread = AllanCovariance(samples, point.m, point.m, dt).at(fit.noises);
  result.edf = 2 * model * model / spread;
  const std::array<double, 2> ends = interval(point.deviation * point.deviation, result.edf);
  result.low = ends[0];
  result.high = ends[1];
  return result;
}

/// The minimum deviation / 0.664, if the curve has a floor within the record.
AllanReading read_floor(const Octaves& octaves, const Described& described, std::size_t samples,
                        double dt) {
  // The minimum of scattered points is biased low, so points with few means are excluded.
  constexpr std::size_t kMeansOfAFloor = 16;
  const auto end =
      std::find_if(octaves.points.begin() + 1, octaves.points.end(),
                   [&](const AllanPoint& point) { return point.m * kMeansOfAFloor > samples; });
  const auto min = std::min_element(
      octaves.points.begin(), end,
      [](const AllanPoint& a, const AllanPoint& b) { return a.deviation < b.deviation; });
  const AllanCurvePoint at = with_interval(*min, described.fit, samples, dt);
  const NoiseVariances unit = allan_variance_of_noises(min->tau);
  const NoiseVariances& noises = described.fit.noises;
  const auto flicker = static_cast<std::size_t>(AllanNoise::flicker);
  const auto walk = static_cast<std::size_t>(AllanNoise::rate_random_walk);
  const double falling = noises[0] * unit[0] + noises[1] * unit[1];
  AllanReading reading;
  if (min == octaves.points.begin()) {
    reading.reason = "the curve rises from the first tau on, so it has no floor";
    return reading;
  }
  reading.tau_from = reading.tau_to = min->tau;
  if (falling > 0.8 * model_variance(noises, min->tau)) {
    reading.tau_from = reading.tau_to = 0;
    reading.reason =
        fmt::format("too short: the curve still falls at {:.4g} s, the longest usable tau",
                    std::prev(end)->tau);
    reading.at_most = at.high / kFloorOfBias;
    return reading;
  }
  reading.seen = true;
  reading.value = min->deviation / kFloorOfBias;
  reading.low = at.low / kFloorOfBias;
  reading.high = at.high / kFloorOfBias;
  if (noises[flicker] * unit[flicker] < 0.5 * model_variance(noises, min->tau))
    reading.reason = noises[walk] > 0
                         ? "the intersection of noise density and random walk, not flicker"
                         : "an upper bound: the curve is not flat there";
  return reading;
}

}  // namespace

AllanAnalysis analyse_allan(const Eigen::Ref<const Vector>& rate, double dt,
                            std::vector<std::size_t> factors) {
  const auto samples = static_cast<std::size_t>(rate.size());
  if (samples < kMinAllanSamples)
    throw InvalidInput("allan",
                       fmt::format("the log has {}, expected at least {}, because fewer "
                                   "do not determine a slope",
                                   internal::counted(samples, "sample"), kMinAllanSamples));
  if (factors.empty()) factors = allan_factors(samples, AllanTaus::octaves);
  const std::vector<AllanPoint> points = allan_deviation(rate, dt, factors);
  const Octaves octaves = octaves_of(rate, dt);
  for (const AllanPoint& point : octaves.points)
    if (!(point.deviation > 0))
      throw InvalidInput("allan",
                         fmt::format("the deviation at {} s is 0; expected noise, because a rate "
                                     "that never changes contains no information about its sensor",
                                     point.tau));
  Described described = describe(octaves, samples);
  if (!std::isfinite(described.fit.chi_squared))
    throw InvalidInput("allan", "no noise fits the curve; expected finite noise coefficients");
  AllanAnalysis result;
  result.explained = described.explained;
  result.model_error = described.model_error;
  result.chi_squared = described.fit.chi_squared;
  result.degrees = described.fit.degrees;
  sharpen(octaves, described);
  result.variances = described.fit.noises;
  result.fitted_from = octaves.points[static_cast<std::size_t>(described.from)].tau;
  for (const AllanPoint& point : points)
    result.curve.push_back(with_interval(point, described.fit, samples, dt));

  const double first = octaves.points.front().tau, last = octaves.points.back().tau;
  result.quantization =
      read(octaves, described, AllanNoise::quantization,
           fmt::format("no slope of -1 from {:.4g} s, the sample period, on", first));
  result.noise_density =
      read(octaves, described, AllanNoise::white,
           fmt::format("no slope of -1/2 between {:.4g} and {:.4g} s", first, last));
  result.random_walk =
      read(octaves, described, AllanNoise::rate_random_walk,
           fmt::format("too short: no slope of +1/2 up to {:.4g} s, the longest usable tau", last));
  result.bias_instability = read_floor(octaves, described, samples, dt);
  return result;
}

}  // namespace quadtune
