// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/stationary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"

namespace quadtune {
namespace {

using Index = Eigen::Index;

constexpr Index kMinWindow = 5;     // minimum, in samples
constexpr Index kMinWindows = 10;   // minimum of a log
constexpr double kQuietPart = 0.1;  // share of the windows that are assumed to be stationary
// threshold of rotation in standard deviations of the means of the gyroscope
constexpr double kMaxOfMean = 6;
constexpr double kDeviationPerMad = 1.4826;

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Means and variances of one sensor in each window.
struct Windows {
  Eigen::Matrix3Xd mean;
  Eigen::VectorXd variance;  ///< summed over the axes

  Windows(const Eigen::Matrix3Xd& values, Index length, Index count)
      : mean(3, values.cols() > 0 ? count : 0), variance(mean.cols()) {
    for (Index i = 0; i < mean.cols(); ++i) {
      const auto window = values.middleCols(i * length, length);
      mean.col(i) = window.rowwise().mean();
      variance(i) = (window.colwise() - mean.col(i)).squaredNorm() / double(length - 1);
    }
  }

  /// Variance of the quietest windows, not below that of rounding to counts.
  [[nodiscard]] double quiet(const Eigen::Matrix3Xd& values) const {
    std::vector<double> sorted(variance.begin(), variance.end());
    std::sort(sorted.begin(), sorted.end());
    const auto at = static_cast<std::size_t>(kQuietPart * double(sorted.size()));
    double step = 0;  // the smallest difference of unequal neighbours
    for (Index axis = 0; axis < 3; ++axis)
      for (Index i = 1; i < values.cols(); ++i) {
        const double difference = std::abs(values(axis, i) - values(axis, i - 1));
        if (difference > 0 && (step == 0 || difference < step)) step = difference;
      }
    return std::max(sorted[at], 3 * step * step / 12);
  }
};

/// Excludes windows in which the mean of the gyroscope differs from that of most stationary ones.
void leave_out_turns(const Windows& gyroscope, std::vector<char>& still) {
  for (Index axis = 0; axis < 3; ++axis) {
    std::vector<double> means, distances;
    for (Index i = 0; i < gyroscope.mean.cols(); ++i)
      if (still[static_cast<std::size_t>(i)]) means.push_back(gyroscope.mean(axis, i));
    if (means.empty()) return;
    const double middle = median(means);
    for (const double mean : means) distances.push_back(std::abs(mean - middle));
    const double max = kMaxOfMean * kDeviationPerMad * median(distances);
    for (Index i = 0; i < gyroscope.mean.cols(); ++i)
      if (max > 0 && std::abs(gyroscope.mean(axis, i) - middle) > max)
        still[static_cast<std::size_t>(i)] = 0;
  }
}

StationaryPose pose_of(const ImuLog& log, Index begin, Index end) {
  StationaryPose pose;
  pose.begin = static_cast<std::size_t>(begin);
  pose.end = static_cast<std::size_t>(end);
  const auto mean = [&](const Eigen::Matrix3Xd& values) -> Eigen::Vector3d {
    if (values.cols() == 0) return Eigen::Vector3d::Zero();
    return values.middleCols(begin, end - begin).rowwise().mean();
  };
  pose.accelerometer = mean(log.accelerometer);
  pose.gyroscope = mean(log.gyroscope);
  pose.magnetometer = mean(log.magnetometer);
  if (log.temperature.size() > 0)
    pose.temperature = log.temperature.segment(begin, end - begin).mean();
  return pose;
}

void require_column(const ImuLog& log, const Eigen::Ref<const Eigen::MatrixXd>& values,
                    const char* name) {
  if (values.cols() == 0) return;
  if (values.cols() != log.t.size())
    throw InvalidInput(log.name,
                       fmt::format("the {} has {}; expected {}, as many as there are times", name,
                                   internal::counted(values.cols(), "sample"), log.t.size()));
  for (Index i = 0; i < values.cols(); ++i)
    if (!values.col(i).allFinite())
      throw InvalidInput(log.name, fmt::format("sample {} of the {} is not finite", i + 1, name));
}

}  // namespace

void validate(const ImuLog& log) {
  if (log.accelerometer.cols() == 0)
    throw InvalidInput(log.name,
                       "has no accelerometer; it is required because gravity is the scale");
  for (Index i = 0; i < log.t.size(); ++i)
    if (!std::isfinite(log.t(i)) || (i > 0 && !(log.t(i) > log.t(i - 1))))
      throw InvalidInput(
          log.name, fmt::format("the time of sample {} is {} s{}; expected increasing times", i + 1,
                                log.t(i), i > 0 ? fmt::format(" after {} s", log.t(i - 1)) : ""));
  require_column(log, log.accelerometer, "accelerometer");
  require_column(log, log.gyroscope, "gyroscope");
  require_column(log, log.magnetometer, "magnetometer");
  require_column(log, log.temperature.transpose(), "temperature");
}

StationaryDetection find_stationary(const ImuLog& log, const StationaryOptions& options) {
  validate(log);
  if (!(options.window > 0) || !(options.factor > 1) || !(options.shortest > 0))
    throw InvalidInput(
        "find_still",
        fmt::format("window {} s, factor {}, shortest {} s; expected a window "
                    "and a shortest duration greater than 0 and a factor greater than 1",
                    options.window, options.factor, options.shortest));
  const Index samples = log.t.size();
  const double period = samples > 1 ? (log.t(samples - 1) - log.t(0)) / double(samples - 1) : 1;
  // Not converted to an integer yet, because a window may contain more samples than an integer can
  // represent.
  const double wanted = std::max(double(kMinWindow), std::round(options.window / period));
  if (!(wanted * kMinWindows <= double(samples)))
    throw InvalidInput(log.name, fmt::format("has {}; expected at least {:.15g}, ten "
                                             "windows of {:.3g} s at {:.4g} s per sample",
                                             internal::counted(samples, "sample"),
                                             kMinWindows * wanted, options.window, period));
  const auto length = static_cast<Index>(wanted);
  const Index count = samples / length;
  const Windows accelerometer(log.accelerometer, length, count);
  const Windows gyroscope(log.gyroscope, length, count);
  StationaryDetection result;
  const double quiet_a = accelerometer.quiet(log.accelerometer);
  const double quiet_g = log.gyroscope.cols() > 0 ? gyroscope.quiet(log.gyroscope) : 0;
  result.accelerometer_noise = std::sqrt(quiet_a / 3);
  result.gyroscope_noise = std::sqrt(quiet_g / 3);
  result.accelerometer_threshold = std::sqrt(options.factor * quiet_a);
  result.gyroscope_threshold = std::sqrt(options.factor * quiet_g);

  std::vector<char> still(static_cast<std::size_t>(count));
  for (Index i = 0; i < count; ++i)
    still[static_cast<std::size_t>(i)] = static_cast<char>(
        accelerometer.variance(i) <= options.factor * quiet_a &&
        (log.gyroscope.cols() == 0 || gyroscope.variance(i) <= options.factor * quiet_g));
  leave_out_turns(gyroscope, still);

  for (Index i = 0; i < count;) {
    if (!still[static_cast<std::size_t>(i)]) {
      ++i;
      continue;
    }
    Index end = i;
    while (end < count && still[static_cast<std::size_t>(end)]) ++end;
    const Index first = i == 0 ? 0 : i + 1, last = end == count ? end : end - 1;
    if (double((last - first) * length) * period >= options.shortest * (1 - 1e-9))
      result.poses.push_back(pose_of(log, first * length, last * length));
    i = end;
  }
  return result;
}

StartUpOffset start_up_offset(const ImuLog& log, const StationaryDetection& still) {
  constexpr Index kSamples = StartUpOffset::kSamples, kParts = 16;
  if (log.gyroscope.cols() < kSamples)
    throw InvalidInput(log.name,
                       fmt::format("has {} of the gyroscope; expected at least {}, which the "
                                   "flight program averages before it starts",
                                   internal::counted(log.gyroscope.cols(), "sample"), kSamples));
  Eigen::Matrix<double, 3, kParts> parts;
  for (Index i = 0; i < kParts; ++i)
    parts.col(i) =
        log.gyroscope.middleCols(i * kSamples / kParts, kSamples / kParts).rowwise().mean();
  StartUpOffset result;
  result.offset = parts.rowwise().mean();
  result.error =
      ((parts.colwise() - result.offset).rowwise().squaredNorm() / double(kParts * (kParts - 1)))
          .cwiseSqrt();
  result.still = !still.poses.empty() && still.poses.front().begin == 0 &&
                 still.poses.front().end >= static_cast<std::size_t>(kSamples);
  return result;
}

}  // namespace quadtune
