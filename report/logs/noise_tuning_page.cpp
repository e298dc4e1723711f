// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <vector>

#include "quadtune/version.hpp"
#include "quadtune/workbench/logs/noise_evidence.hpp"
#include "report/logs/logs.hpp"
#include "report/page/tuning_page.hpp"

namespace quadtune::report {
namespace {

using Eigen::Index;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kWide = 2;        ///< half width of a band [standard deviations]
constexpr double kLevel = 1.9207;  ///< decrease of the log-likelihood at the ends of a 95 %
                                   ///< interval
/// A gap is visible if it has at least one of this number of rows.
constexpr std::size_t kRowsAGap = 1000;

/// All records, one after another, as columns over a common time.
class Timeline {
 public:
  /// Begins a record: the following values belong to its instants. Rows without values before it
  /// interrupt the lines; there are enough of them that the page does not drop the gap.
  void begin(const Samples& times, double offset) {
    std::vector<double>& time = column("t", "s");
    if (!time.empty()) {
      const double from = time.back(), step = times.front() + offset - from;
      const std::size_t rows = 1 + (time.size() + times.size()) / kRowsAGap;
      for (std::size_t i = 1; i <= rows; ++i)
        time.push_back(from + step * static_cast<double>(i) / static_cast<double>(rows + 1));
    }
    start_ = time.size();
    for (const double t : times) time.push_back(t + offset);
  }

  double& at(const std::string& name, const std::string& unit, Index k) {
    std::vector<double>& values = column(name, unit);
    values.resize(table_.columns.front().values.size(), kNaN);
    return values[start_ + static_cast<std::size_t>(k)];
  }

  [[nodiscard]] bool has(const std::string& name) const { return places_.contains(name); }

  /// The median of the values that are not NaN.
  [[nodiscard]] double median(const std::string& name) const {
    std::vector<double> values = table_.columns[places_.at(name)].values;
    std::erase_if(values, [](double value) { return std::isnan(value); });
    const auto middle = values.begin() + std::ssize(values) / 2;
    std::nth_element(values.begin(), middle, values.end());
    return values.empty() ? kNaN : *middle;
  }

  void event(double time, const std::string& name, const std::string& detail) {
    table_.events.push_back({time, name, detail});
  }

  [[nodiscard]] LogTable table() {
    for (LogColumn& one : table_.columns)
      one.values.resize(table_.columns.front().values.size(), kNaN);
    return std::move(table_);
  }

 private:
  std::vector<double>& column(const std::string& name, const std::string& unit) {
    const auto [found, fresh] = places_.try_emplace(name, table_.columns.size());
    if (fresh) table_.columns.push_back({name, unit, {}});
    return table_.columns[found->second].values;
  }

  LogTable table_;
  std::map<std::string, std::size_t> places_;
  std::size_t start_ = 0;
};

/// An output, with its name in the checks and its unit.
struct Output {
  std::string name, unit;
};

std::vector<Output> outputs_of(const FilterModel& model) {
  std::vector<Output> outputs;
  for (const FilterSensor& sensor : model.sensors)
    for (const Signal& output : sensor.outputs)
      outputs.push_back({fmt::format("{}: {}", sensor.name, output.name), output.unit});
  return outputs;
}

/// Fills the columns over time of the page, and their plots.
class TimePlots {
 public:
  TimePlots(const TunedNoise& tuned, const NoiseEvidence& evidence, TuningPage& page)
      : tuning_(tuned.tuning), model_(tuned.model), evidence_(evidence), page_(page) {}

  void fill() {
    std::size_t logs = 0;
    double end = 0, offset = 0;
    for (std::size_t r = 0; r < tuning_.records_after.size(); ++r) {
      const FilterRecord& record = tuning_.records_after[r];
      const NoiseRuns& runs = evidence_.records[r];
      const double begin = record.time.front();
      const bool fresh =
          r == 0 || record.name != tuning_.records_after[r - 1].name || begin + offset <= end;
      if (fresh) {
        offset = r == 0 ? 0 : end + 1 - begin;
        timeline_.event(begin + offset, "log", record.name);
        ++logs;
      }
      timeline_.begin(record.time, offset);
      if (runs.fitted < record.time.size())
        timeline_.event(record.time[runs.fitted] + offset, "held out", record.name);
      if (runs.before) add_run(*runs.before, "before");
      if (runs.after) add_run(*runs.after, "after");
      end = record.time.back() + offset;
    }
    plot_innovations();
    plot_sizes();
    plot_states();
    page_.log = timeline_.table();
    if (logs > 1) page_.remarks.emplace_back("The logs follow one another.");
    if (evidence_.holdout > 0)
      page_.remarks.emplace_back(
          "Dashed lines: the start of a log, and the start of the part that was held out.");
  }

 private:
  void add_run(const NoiseRun& run, const std::string& which) {
    const std::vector<Output> outputs = outputs_of(model_);
    for (std::size_t j = 0; j < outputs.size(); ++j) {
      add_innovations(run, static_cast<Index>(j), outputs[j].unit, which);
      add_sizes(run.size[j], j, which);
    }
    add_states(run, which);
  }

  void add_states(const NoiseRun& run, const std::string& which) {
    smoothed_ = smoothed_ && run.smoothed;
    for (Index i = 0; i < run.x.rows(); ++i) {
      const std::string& unit = model_.states[static_cast<std::size_t>(i)].unit;
      const std::string name = fmt::format("state.{}.{}", i, which);
      for (Index k = 0; k < run.x.cols(); ++k) {
        const double width = kWide * std::sqrt(run.x_variance(i, k));
        timeline_.at(name, unit, k) = run.x(i, k);
        timeline_.at(name + ".low", unit, k) = run.x(i, k) - width;
        timeline_.at(name + ".high", unit, k) = run.x(i, k) + width;
      }
    }
  }

  /// The band is held until the next sample, so that it forms an area.
  void add_innovations(const NoiseRun& run, Index row, const std::string& unit,
                       const std::string& which) {
    const std::string name = fmt::format("innovation.{}.{}", row, which);
    double width = kNaN;
    for (Index k = 0; k < run.innovation.cols(); ++k) {
      if (!std::isnan(run.innovation(row, k))) {
        width = kWide * std::sqrt(run.variance(row, k));
        timeline_.at(name, unit, k) = run.innovation(row, k);
      }
      if (std::isnan(width)) continue;
      timeline_.at(name + ".low", unit, k) = -width;
      timeline_.at(name + ".high", unit, k) = width;
    }
  }

  /// A mean is held until the next one, so that it forms a line.
  void add_sizes(const RunningSize& size, std::size_t output, const std::string& which) {
    const std::string name = fmt::format("size.{}", output), mean_name = name + "." + which,
                      low = name + ".low", high = name + ".high";
    Index last = size.value.size() - 1;
    while (last >= 0 && std::isnan(size.value(last))) --last;
    double mean = kNaN;
    for (Index k = 0; k <= last; ++k) {
      if (!std::isnan(size.value(k))) mean = size.value(k);
      if (std::isnan(mean)) continue;
      timeline_.at(mean_name, "1", k) = mean;
      timeline_.at(low, "1", k) = size.low;
      timeline_.at(high, "1", k) = size.high;
    }
  }

  void plot_innovations() {
    const std::vector<Output> outputs = outputs_of(model_);
    for (std::size_t j = 0; j < outputs.size(); ++j) {
      const std::string after = fmt::format("innovation.{}.after", j);
      const std::string before = fmt::format("innovation.{}.before", j);
      if (!timeline_.has(after)) continue;
      ReportPlot plot{"Innovation of " + outputs[j].name, outputs[j].unit, {}};
      plot.series = {{"innovation", after, SeriesStyle::measurement},
                     {"±2√S", after + ".low", SeriesStyle::band, after + ".high"}};
      if (timeline_.has(before)) {
        plot.series.push_back({"before", before, SeriesStyle::measurement, "", false});
        plot.series.push_back({"±2√S before", before + ".low", SeriesStyle::band, before + ".high",
                               comparable(after + ".high", before + ".high")});
      }
      page_.plots.push_back(std::move(plot));
    }
  }

  /// Whether both can share an axis: the ratio of their medians is between 1/4 and 4.
  [[nodiscard]] bool comparable(const std::string& a, const std::string& b) const {
    const double ratio = timeline_.median(a) / timeline_.median(b);
    return ratio > 0.25 && ratio < 4;
  }

  void plot_sizes() {
    const std::vector<Output> outputs = outputs_of(model_);
    for (std::size_t j = 0; j < outputs.size(); ++j) {
      const std::string name = fmt::format("size.{}", j);
      if (!timeline_.has(name + ".after")) continue;
      ReportPlot plot{"Normalized innovation squared of " + outputs[j].name, "", {}};
      plot.logarithmic = true;
      plot.series = {
          {"running mean", name + ".after", SeriesStyle::value},
          {"95 % of a consistent filter", name + ".low", SeriesStyle::band, name + ".high"}};
      if (timeline_.has(name + ".before"))
        plot.series.push_back({"before", name + ".before", SeriesStyle::reference});
      page_.plots.push_back(std::move(plot));
    }
  }

  void plot_states() {
    for (std::size_t i = 0; i < model_.states.size(); ++i) {
      const std::string after = fmt::format("state.{}.after", i);
      const std::string before = fmt::format("state.{}.before", i);
      if (!timeline_.has(after)) continue;
      const Signal& state = model_.states[i];
      ReportPlot plot{
          fmt::format("{}, {}", state.name, smoothed_ ? "smoothed" : "filtered"), state.unit, {}};
      plot.series = {{state.name, after, SeriesStyle::value},
                     {"±2σ", after + ".low", SeriesStyle::band, after + ".high"}};
      if (timeline_.has(before)) {
        plot.series.push_back({"before", before, SeriesStyle::reference});
        plot.series.push_back(
            {"±2σ before", before + ".low", SeriesStyle::band, before + ".high", false});
      }
      page_.plots.push_back(std::move(plot));
    }
  }

  const NoiseTuning& tuning_;
  const FilterModel& model_;
  const NoiseEvidence& evidence_;
  TuningPage& page_;
  Timeline timeline_;
  bool smoothed_ = true;
};

void add_parameters(const TunedNoise& tuned, TuningPage& page) {
  const NoiseFit& fit = tuned.tuning.fit;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const FittedParameter& p = fit.parameters[i];
    const bool doubtful =
        p.verdict == ParameterVerdict::not_seen || p.verdict == ParameterVerdict::combination;
    page.parameters.push_back(
        {p.name, p.unit, tuned.model.parameters[i].start, p.value, p.low, p.high,
         p.verdict == ParameterVerdict::seen ? "" : to_string(p.verdict), doubtful});
  }
  page.unseen = fit.unseen;
}

void add_checks(const NoiseTuning& tuning, TuningPage& page) {
  const auto list = [](const Eigen::VectorXd& values) {
    return std::vector<double>(values.data(), values.data() + values.size());
  };
  for (std::size_t i = 0; i < tuning.after.outputs.size(); ++i) {
    const InnovationStatistics& s = tuning.after.outputs[i];
    const InnovationStatistics before =
        i < tuning.before.outputs.size() ? tuning.before.outputs[i] : InnovationStatistics{};
    PageCheck row{s.output, s.samples, before.size, s.size, s.mean};
    row.kurtosis = s.kurtosis;
    if (s.autocorrelation.size() > 0) {
      Index worst = 0;
      s.autocorrelation.cwiseAbs().maxCoeff(&worst);
      row.correlation = s.autocorrelation(worst);
      row.lag = static_cast<int>(worst) + 1;
    }
    for (const ConsistencyCheck& c : tuning.after.checks)
      if (c.output == s.output && c.verdict == CheckVerdict::fail) row.failed.push_back(c.name);
    page.checks.push_back(std::move(row));
    if (s.samples > 0)
      page.correlations.push_back({s.output, 1.96 / std::sqrt(static_cast<double>(s.samples)),
                                   list(before.autocorrelation), list(s.autocorrelation)});
  }
}

void add_profiles(const TunedNoise& tuned, const NoiseEvidence& evidence, TuningPage& page) {
  for (const auto& [i, profile] : evidence.profiles) {
    const FittedParameter& p = tuned.tuning.fit.parameters[i];
    const NoiseParameter& known = tuned.model.parameters[i];
    PageProfile curve{p.name, p.unit, known.logarithmic};
    for (Index k = 0; k < profile.theta.size(); ++k) {
      curve.x.push_back(known.logarithmic ? std::exp(profile.theta(k)) : profile.theta(k));
      curve.y.push_back(profile.value(k));
    }
    curve.value = p.value;
    curve.low = p.low;
    curve.high = p.high;
    curve.before = known.start;
    curve.level = kLevel;
    page.profiles.push_back(std::move(curve));
  }
}

ReportVerdict verdict_of(CheckVerdict verdict) {
  if (verdict == CheckVerdict::pass) return ReportVerdict::pass;
  return verdict == CheckVerdict::fail ? ReportVerdict::fail : ReportVerdict::none;
}

}  // namespace

TuningPage page_of(const TunedNoise& tuned, const NoiseEvidence& evidence, std::uint64_t seed,
                   const std::string& command) {
  TuningPage page;
  page.title = tuned.model.name + ": " + tuned.model.description;
  if (tuned.model.description.empty()) page.title = tuned.model.name;
  page.verdict = verdict_of(tuned.tuning.verdict);
  page.reasons = tuned.tuning.reasons;
  for (const std::string& warning : tuned.tuning.warnings)
    page.reasons.push_back("warning: " + warning);
  page.about = facts_of(tuned);
  add_parameters(tuned, page);
  add_checks(tuned.tuning, page);
  add_profiles(tuned, evidence, page);
  TimePlots(tuned, evidence, page).fill();
  page.command = command;
  page.version = std::string(kVersion);
  page.seed = fmt::format("{}", seed);
  return page;
}

}  // namespace quadtune::report
