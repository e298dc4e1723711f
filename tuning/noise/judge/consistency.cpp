// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/consistency.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "noise/judge/small_samples.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/internal/tails.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Number of checks of one output: size, whiteness, mean and normality.
constexpr Index kChecksAnOutput = 4;

/// Standardized innovations of one output, record by record.
using Series = std::vector<Samples>;

/// The normal deviate with the same probability as a deviate of Student's distribution.
double normal_score(double t, double student) {
  const double beyond = internal::student_above(std::abs(t), student);
  if (!(beyond > 1e-300)) return std::isnan(t) ? t : std::copysign(37.0, t);
  return std::copysign(internal::normal_exceeded(std::min(beyond, 0.5)), t);
}

/// @param student  degrees of freedom of the errors; 0: they are normal
Series standardized(const std::vector<FilterRun>& runs, Index output, double student) {
  Series series;
  for (const FilterRun& run : runs) {
    Samples& z = series.emplace_back();
    for (Index k = 0; k < run.innovation.cols(); ++k)
      if (!std::isnan(run.innovation(output, k)))
        z.push_back(run.innovation(output, k) / std::sqrt(run.variance(output, k)));
    if (student > 0)
      for (double& value : z) value = normal_score(value, student);
  }
  return series;
}

template <class Function>
double mean_of(const Series& series, Function&& function) {
  double sum = 0, count = 0;
  for (const Samples& z : series)
    for (const double value : z) {
      sum += function(value);
      count += 1;
    }
  return sum / count;
}

InnovationStatistics statistics_of(const Series& series, const std::string& name, int lags) {
  InnovationStatistics s;
  s.output = name;
  for (const Samples& z : series) s.samples += static_cast<Index>(z.size());
  s.autocorrelation = VectorXd::Constant(lags, std::numeric_limits<double>::quiet_NaN());
  if (s.samples < 1) return s;
  s.mean = mean_of(series, [](double z) { return z; });
  s.size = mean_of(series, [](double z) { return z * z; });
  const double m2 = mean_of(series, [&](double z) { return std::pow(z - s.mean, 2); });
  // The series is constant up to rounding, or exceeds the range of a double.
  if (!(m2 > 1e-20 * s.size) || !std::isfinite(m2)) return s;
  const double m3 = mean_of(series, [&](double z) { return std::pow(z - s.mean, 3); });
  const double m4 = mean_of(series, [&](double z) { return std::pow(z - s.mean, 4); });
  s.skewness = m3 / std::pow(m2, 1.5);
  s.kurtosis = m4 / (m2 * m2) - 3;
  const auto n = static_cast<double>(s.samples);
  s.ljung_box = 0;
  int used = 0;
  for (int lag = 1; lag <= lags && lag < s.samples / 2; ++lag) {
    double sum = 0;
    for (const Samples& z : series)
      for (std::size_t k = static_cast<std::size_t>(lag); k < z.size(); ++k)
        sum += (z[k] - s.mean) * (z[k - static_cast<std::size_t>(lag)] - s.mean);
    s.autocorrelation(lag - 1) = sum / (n * m2);
    s.ljung_box += n * (n + 2) * std::pow(s.autocorrelation(lag - 1), 2) / (n - lag);
    ++used;
  }
  if (used > 0 && std::isfinite(s.ljung_box))
    s.ljung_box_p = internal::chi_squared_above(s.ljung_box, used);
  return s;
}

/// Performs the checks of one output after the other. With fewer samples than
/// ConsistencyOptions::min_samples, a deviation must be significant among all checks, by tests
/// that are valid for few samples; nothing passes.
class Checker {
 public:
  Checker(const ConsistencyOptions& options, Index checks, Consistency& result)
      : options_(options), checks_(static_cast<double>(checks)), result_(result) {}

  void check(const InnovationStatistics& s) {
    check_size(s);
    check_whiteness(s);
    check_mean(s);
    check_normality(s);
    if (is_short(s))
      result_.checks.push_back(
          {"samples", s.output, static_cast<double>(s.samples),
           static_cast<double>(options_.min_samples), kNone, kNone, CheckVerdict::too_short,
           fmt::format("{}: {} innovations, too few for a verdict", s.output, s.samples)});
  }

  void check_size(const InnovationStatistics& s) {
    const auto n = static_cast<double>(s.samples);
    const double half = 0.5 * level(s);
    ConsistencyCheck c{"size", s.output, s.size, internal::chi_squared_exceeded(1 - half, n) / n,
                       internal::chi_squared_exceeded(half, n) / n};
    c.p = internal::chi_squared_two_sided(s.size * n, n);
    const bool within = s.size >= c.low && s.size <= c.high;
    if (!within && !(s.size >= options_.min_size && s.size <= options_.max_size))
      fail(c, fmt::format(
                  "{}: innovations are {:.3g} times as large as their variance implies, {}",
                  s.output, s.size,
                  s.size < 1 ? "the filter is underconfident" : "the filter is overconfident"));
    else if (!is_short(s) && c.low < options_.min_size && c.high > options_.max_size)
      too_short(c,
                fmt::format("{}: {} innovations do not determine whether their variance is right "
                            "within 25 %",
                            s.output, s.samples));
    add(c, s);
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  [[nodiscard]] bool is_short(const InnovationStatistics& s) const {
    return s.samples < options_.min_samples;
  }
  /// Probability of a false alarm allowed for one check.
  [[nodiscard]] double level(const InnovationStatistics& s) const {
    return is_short(s) ? options_.significance / checks_ : options_.significance;
  }

  void check_whiteness(const InnovationStatistics& s) {
    const auto n = static_cast<double>(s.samples);
    ConsistencyCheck c{"whiteness", s.output, 0};
    Index worst = 0, lags = 0;
    for (Index lag = 0; lag < s.autocorrelation.size(); ++lag) {
      if (!std::isnan(s.autocorrelation(lag))) ++lags;
      if (std::abs(s.autocorrelation(lag)) > std::abs(c.value)) {
        c.value = s.autocorrelation(lag);
        worst = lag + 1;
      }
    }
    if (lags == 0) return;
    if (is_short(s)) {
      const internal::LargestCorrelation largest =
          internal::largest_correlation(s.autocorrelation.head(lags), s.samples);
      c.value = largest.value;
      worst = largest.lag;
      c.p = largest.p;
      c.high =
          internal::correlation_exceeded(0.5 * level(s) / static_cast<double>(lags), s.samples);
    } else {
      c.p = s.ljung_box_p;
      // Upper limit of the largest of this many correlations of white noise.
      c.high =
          internal::normal_exceeded(0.5 * options_.significance / options_.lags) / std::sqrt(n);
    }
    c.low = -c.high;
    if (c.p < level(s) && std::abs(c.value) > options_.max_correlation)
      fail(c,
           fmt::format("{}: innovations are not white: correlation {:.2f} at a lag of {}", s.output,
                       c.value, worst == 1 ? "1 sample" : fmt::format("{} samples", worst)));
    else if (!is_short(s) && 1.96 / std::sqrt(n) > options_.max_correlation)
      too_short(c, fmt::format("{}: {} innovations do not distinguish a correlation of {} from 0",
                               s.output, s.samples, options_.max_correlation));
    add(c, s);
  }

  /// Student's test, which does not depend on the variance being right.
  void check_mean(const InnovationStatistics& s) {
    if (s.samples < 2 || !std::isfinite(s.size)) return;
    const auto n = static_cast<double>(s.samples);
    const double error = std::sqrt(std::max(s.size - s.mean * s.mean, 0.0) / (n - 1));
    const double t = internal::student_exceeded(0.5 * level(s), n - 1);
    ConsistencyCheck c{"mean", s.output, s.mean, -t * error, t * error};
    c.p = s.mean == 0 ? 1 : 2 * internal::student_above(std::abs(s.mean) / error, n - 1);
    if (c.p < level(s) && std::abs(s.mean) > options_.max_mean)
      fail(c,
           fmt::format("{}: innovations have a mean of {:.2f} standard deviations: an offset that "
                       "the model does not contain",
                       s.output, s.mean));
    add(c, s);
  }

  void check_normality(const InnovationStatistics& s) {
    if (!std::isfinite(s.kurtosis)) return;
    const auto n = static_cast<double>(s.samples);
    ConsistencyCheck c{"normality", s.output, s.kurtosis, kNone, options_.max_kurtosis};
    c.p = is_short(s) ? internal::kurtosis_p(s.kurtosis, s.samples)
                      : internal::chi_squared_above(
                            n / 6 * (s.skewness * s.skewness + s.kurtosis * s.kurtosis / 4), 2);
    if (c.p < level(s) && s.kurtosis > options_.max_kurtosis)
      fail(c, fmt::format(
                  "{}: innovations are not normal: excess kurtosis {:.3g}, as caused by outliers",
                  s.output, s.kurtosis));
    add(c, s);
  }

  static void fail(ConsistencyCheck& c, const std::string& reason) {
    c.verdict = CheckVerdict::fail;
    c.reason = reason;
  }
  static void too_short(ConsistencyCheck& c, const std::string& reason) {
    c.verdict = CheckVerdict::too_short;
    c.reason = reason;
  }
  /// A check with few samples never passes, even if it shows no deviation.
  void add(ConsistencyCheck c, const InnovationStatistics& s) {
    if (is_short(s) && c.verdict == CheckVerdict::pass) c.verdict = CheckVerdict::too_short;
    result_.checks.push_back(std::move(c));
  }

  const ConsistencyOptions& options_;
  double checks_;
  Consistency& result_;
};

}  // namespace

void validate(const ConsistencyOptions& options) {
  const auto require = [](bool holds, const char* name, double value, const char* expected) {
    if (!holds)
      throw InvalidInput("consistency",
                         fmt::format("{} is {}, expected {}", name, value, expected));
  };
  require(options.significance > 0 && options.significance < 0.5, "significance",
          options.significance, "more than 0 and less than 0.5");
  require(options.lags >= 1, "lags", options.lags, "at least 1");
}

namespace {

/// Combines the checks into the worst verdict, and lists the reasons, failures first.
void judge(Consistency& result) {
  result.verdict = result.checks.empty() ? CheckVerdict::too_short : CheckVerdict::pass;
  for (const CheckVerdict verdict : {CheckVerdict::fail, CheckVerdict::too_short})
    for (const ConsistencyCheck& c : result.checks) {
      if (c.verdict != verdict) continue;
      if (!c.reason.empty()) result.reasons.push_back(c.reason);
      if (result.verdict == CheckVerdict::pass) result.verdict = verdict;
    }
  if (result.checks.empty()) result.reasons.emplace_back("there are no innovations");
}

}  // namespace

Consistency check_consistency(const FilterModel& model, const std::vector<FilterRun>& runs,
                              const ConsistencyOptions& options) {
  validate(options);
  for (const FilterRun& run : runs)
    if (run.status != LikelihoodStatus::computed)
      throw InvalidInput("consistency", "a run was not computed; expected innovations" +
                                            (run.culprit.empty() ? "" : ": " + run.culprit));
  Consistency result;
  Series all(runs.size());
  std::vector<InnovationStatistics>& outputs = result.outputs;
  Index output = 0, measured = 0;
  for (const FilterSensor& sensor : model.sensors)
    for (const Signal& signal : sensor.outputs) {
      const Series series = standardized(runs, output++, sensor.student);
      outputs.push_back(
          statistics_of(series, fmt::format("{}: {}", sensor.name, signal.name), options.lags));
      if (outputs.back().samples > 0) ++measured;
      for (std::size_t r = 0; r < runs.size(); ++r)
        all[r].insert(all[r].end(), series[r].begin(), series[r].end());
    }
  Checker checker(options, kChecksAnOutput * measured + (measured > 1 ? 1 : 0), result);
  for (const InnovationStatistics& s : outputs)
    if (s.samples > 0) checker.check(s);
  if (measured > 1) checker.check_size(statistics_of(all, "all", 1));
  judge(result);
  return result;
}

constexpr internal::EnumName<CheckVerdict> kCheckVerdicts[] = {
    {CheckVerdict::pass, "pass"},
    {CheckVerdict::fail, "fail"},
    {CheckVerdict::too_short, "too short to tell"}};

std::string to_string(CheckVerdict verdict) { return internal::name_in(kCheckVerdicts, verdict); }

}  // namespace quadtune
