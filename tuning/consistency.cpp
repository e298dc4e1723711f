// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/consistency.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Standardized innovations of one output, record by record.
using Series = std::vector<Samples>;

/// The normal deviate that is as rare as a Student's.
double normal_score(double t, double student) {
  const boost::math::students_t tailed(student);
  const double beyond = boost::math::cdf(boost::math::complement(tailed, std::abs(t)));
  const double z = boost::math::quantile(
      boost::math::complement(boost::math::normal(), std::max(beyond, 1e-300)));
  return std::copysign(z, t);
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
  if (s.samples < 2) return s;
  s.mean = mean_of(series, [](double z) { return z; });
  s.size = mean_of(series, [](double z) { return z * z; });
  const double m2 = mean_of(series, [&](double z) { return std::pow(z - s.mean, 2); });
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
    s.ljung_box_p =
        boost::math::cdf(boost::math::complement(boost::math::chi_squared(used), s.ljung_box));
  return s;
}

double two_sided_p(double z) {
  return 2 * boost::math::cdf(boost::math::complement(boost::math::normal(), std::abs(z)));
}

class Checker {
 public:
  Checker(const ConsistencyOptions& options, Consistency& result)
      : options_(options), result_(result) {}

  void check(const InnovationStatistics& s) {
    if (s.samples < options_.least_samples) {
      add({"samples", s.output, static_cast<double>(s.samples),
           static_cast<double>(options_.least_samples), kNone, kNone, CheckVerdict::too_short,
           fmt::format("{}: {} innovations, too few to tell", s.output, s.samples)});
      return;
    }
    check_size(s);
    check_whiteness(s);
    check_mean(s);
    check_normality(s);
  }

  void check_size(const InnovationStatistics& s) {
    const auto n = static_cast<double>(s.samples);
    const boost::math::chi_squared chi(n);
    const double half = 0.5 * options_.significance;
    ConsistencyCheck c{"size", s.output, s.size, boost::math::quantile(chi, half) / n,
                       boost::math::quantile(boost::math::complement(chi, half)) / n};
    const double below = boost::math::cdf(chi, s.size * n);
    c.p = 2 * std::min(below, 1 - below);
    const bool significant = s.size < c.low || s.size > c.high;
    if (significant && (s.size < options_.least_size || s.size > options_.most_size))
      fail(c, fmt::format("{}: innovations are {:.3g} times as large as their variance says, {}",
                          s.output, s.size,
                          s.size > 1 ? "the filter trusts itself too much"
                                     : "the filter trusts itself too little"));
    else if (c.low < options_.least_size && c.high > options_.most_size)
      too_short(c, fmt::format("{}: {} innovations cannot tell whether their variance is right "
                               "within a quarter",
                               s.output, s.samples));
    add(c);
  }

  void check_whiteness(const InnovationStatistics& s) {
    const auto n = static_cast<double>(s.samples);
    // Of the largest of so many correlations of white noise.
    const double z = boost::math::quantile(boost::math::complement(
        boost::math::normal(), 0.5 * options_.significance / options_.lags));
    ConsistencyCheck c{"whiteness",       s.output,         0,
                       -z / std::sqrt(n), z / std::sqrt(n), s.ljung_box_p};
    Index worst = 0;
    for (Index lag = 0; lag < s.autocorrelation.size(); ++lag)
      if (std::abs(s.autocorrelation(lag)) > std::abs(c.value)) {
        c.value = s.autocorrelation(lag);
        worst = lag + 1;
      }
    if (s.ljung_box_p < options_.significance && std::abs(c.value) > options_.most_correlation)
      fail(c,
           fmt::format("{}: innovations are not white: correlation {:.2f} at a lag of {}", s.output,
                       c.value, worst == 1 ? "1 sample" : fmt::format("{} samples", worst)));
    else if (1.96 / std::sqrt(n) > options_.most_correlation)
      too_short(c, fmt::format("{}: {} innovations cannot tell a correlation of {} from none",
                               s.output, s.samples, options_.most_correlation));
    add(c);
  }

  void check_mean(const InnovationStatistics& s) {
    const double error = std::sqrt(std::max(s.size, 1e-300) / static_cast<double>(s.samples));
    const double z = boost::math::quantile(
        boost::math::complement(boost::math::normal(), 0.5 * options_.significance));
    ConsistencyCheck c{"mean",     s.output,  s.mean,
                       -z * error, z * error, two_sided_p(s.mean / error)};
    if (c.p < options_.significance && std::abs(s.mean) > options_.most_mean)
      fail(c,
           fmt::format("{}: innovations have a mean of {:.2f} standard deviations: an offset that "
                       "the model does not know",
                       s.output, s.mean));
    add(c);
  }

  void check_normality(const InnovationStatistics& s) {
    const auto n = static_cast<double>(s.samples);
    const double jarque_bera = n / 6 * (s.skewness * s.skewness + s.kurtosis * s.kurtosis / 4);
    ConsistencyCheck c{"normality", s.output, s.kurtosis, kNone, options_.most_kurtosis};
    c.p = std::isfinite(jarque_bera)
              ? boost::math::cdf(boost::math::complement(boost::math::chi_squared(2), jarque_bera))
              : 0;
    if (c.p < options_.significance && !(s.kurtosis < options_.most_kurtosis))
      fail(c,
           fmt::format("{}: innovations are not normal: excess kurtosis {:.3g}, as outliers make",
                       s.output, s.kurtosis));
    add(c);
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  static void fail(ConsistencyCheck& c, const std::string& reason) {
    c.verdict = CheckVerdict::fail;
    c.reason = reason;
  }
  static void too_short(ConsistencyCheck& c, const std::string& reason) {
    c.verdict = CheckVerdict::too_short;
    c.reason = reason;
  }
  void add(const ConsistencyCheck& c) { result_.checks.push_back(c); }

  const ConsistencyOptions& options_;
  Consistency& result_;
};

void check_options(const ConsistencyOptions& options) {
  const auto require = [](bool holds, const char* name, double value, const char* expected) {
    if (!holds)
      throw InvalidInput("consistency",
                         fmt::format("{} is {}, expected {}", name, value, expected));
  };
  require(options.significance > 0 && options.significance < 0.5, "significance",
          options.significance, "more than 0 and less than 0.5");
  require(options.lags >= 1, "lags", options.lags, "at least 1");
}

}  // namespace

Consistency check_consistency(const FilterModel& model, const std::vector<FilterRun>& runs,
                              const ConsistencyOptions& options) {
  check_options(options);
  for (const FilterRun& run : runs)
    if (run.status != LikelihoodStatus::computed)
      throw InvalidInput("consistency", "a run came that was not computed, expected innovations" +
                                            (run.culprit.empty() ? "" : ": " + run.culprit));
  Consistency result;
  Checker checker(options, result);
  Series all(runs.size());
  Index output = 0;
  for (const FilterSensor& sensor : model.sensors)
    for (const Signal& signal : sensor.outputs) {
      const Series series = standardized(runs, output++, sensor.student);
      result.outputs.push_back(
          statistics_of(series, fmt::format("{}: {}", sensor.name, signal.name), options.lags));
      if (result.outputs.back().samples > 0) checker.check(result.outputs.back());
      for (std::size_t r = 0; r < runs.size(); ++r)
        all[r].insert(all[r].end(), series[r].begin(), series[r].end());
    }
  if (model.outputs() > 1) {
    InnovationStatistics whole = statistics_of(all, "all", 1);
    if (whole.samples >= options.least_samples) checker.check_size(whole);
  }
  result.verdict = result.checks.empty() ? CheckVerdict::too_short : CheckVerdict::pass;
  for (const ConsistencyCheck& c : result.checks) {
    if (c.verdict == CheckVerdict::pass) continue;
    result.reasons.push_back(c.reason);
    if (c.verdict == CheckVerdict::fail)
      result.verdict = CheckVerdict::fail;
    else if (result.verdict == CheckVerdict::pass)
      result.verdict = CheckVerdict::too_short;
  }
  if (result.checks.empty()) result.reasons.push_back("no innovations to look at");
  return result;
}

namespace {

/// How many independent samples of z² so many correlated ones are worth: the sum of the squared
/// autocorrelations up to where they are lost in noise.
double independent_samples(const Samples& z) {
  const auto n = static_cast<double>(z.size());
  double mean = 0, variance = 0;
  for (const double value : z) mean += value / n;
  for (const double value : z) variance += (value - mean) * (value - mean) / n;
  double sum = 1;
  for (std::size_t lag = 1; lag < z.size() / 2; ++lag) {
    double c = 0;
    for (std::size_t k = lag; k < z.size(); ++k) c += (z[k] - mean) * (z[k - lag] - mean);
    const double r = c / (n * variance);
    if (!(r > 2 / std::sqrt(n))) break;
    sum += 2 * r * r;
  }
  return n / sum;
}

}  // namespace

std::vector<ConsistencyCheck> check_errors(const FilterModel& model,
                                           const std::vector<FilterRecord>& records,
                                           const std::vector<FilterRun>& runs,
                                           const ConsistencyOptions& options) {
  check_options(options);
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
      if (z.size() > 2) independent += independent_samples(z);
    }
    if (count == 0) continue;
    ConsistencyCheck c{"error", model.states[static_cast<std::size_t>(i)].name, squares / count};
    const double freedom = std::max(independent, 1.0), half = 0.5 * options.significance;
    const boost::math::chi_squared chi(freedom);
    c.low = boost::math::quantile(chi, half) / freedom;
    c.high = boost::math::quantile(boost::math::complement(chi, half)) / freedom;
    const double below = boost::math::cdf(chi, c.value * freedom);
    c.p = 2 * std::min(below, 1 - below);
    if ((c.value < c.low || c.value > c.high) &&
        (c.value < options.least_size || c.value > options.most_size)) {
      c.verdict = CheckVerdict::fail;
      c.reason = fmt::format(
          "{}: the squared error is {:.3g} times as large as its variance says, and {:.0f} "
          "independent errors leave no doubt",
          c.output, c.value, freedom);
    }
    checks.push_back(c);
  }
  return checks;
}

std::string to_string(CheckVerdict verdict) {
  switch (verdict) {
    case CheckVerdict::pass:
      return "pass";
    case CheckVerdict::fail:
      return "fail";
    case CheckVerdict::too_short:
      break;
  }
  return "too short to tell";
}

}  // namespace quadtune
