// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/noise_tuning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>

#include "noise/constant_measurements.hpp"
#include "noise/judge/held_out.hpp"
#include "noise/judge/opposite_signs.hpp"
#include "noise/noise_description.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Maximum number of fits, each with a new path or new rejected measurements.
constexpr int kMaxRounds = 20;
/// Change of θ at which the fits end, in standard errors, or in logarithms if not determined.
constexpr double kSettled = 0.01;
/// If the last, precise fit changes by more than this, the fits are repeated, because it found a
/// region that the rough fits before it did not search.
constexpr double kFarOff = 0.1;
/// Ratio of root mean square errors from which an increase is reported.
constexpr double kLessAccurate = 1.01;
/// Degrees of freedom of Student's distribution of a gated sensor in the first fit: with its tails
/// an outlier has little weight.
constexpr double kLongTails = 4;

using Stop = std::function<bool()>;
/// Computes the records at a θ: rejected measurements are NaN, and nonlinear models are linearized.
/// Throws Interrupted if requested.
using Records = std::function<LinearizedLogs(const VectorXd&, const Stop&)>;

bool has_gate(const FilterModel& model) {
  for (const FilterSensor& sensor : model.sensors)
    if (std::isfinite(sensor.gate)) return true;
  return false;
}

Index first_held_out(const FilterRecord& record, double holdout) {
  return static_cast<Index>(std::ceil(static_cast<double>(record.samples()) * (1 - holdout)));
}

/// The part of the record before the held-out part.
FilterRecord beginning(const FilterRecord& record, double holdout) {
  const Index count = first_held_out(record, holdout);
  FilterRecord result;
  result.name = record.name;
  result.time.assign(record.time.begin(), record.time.begin() + count);
  result.y = record.y.leftCols(count);
  result.u = record.u.leftCols(count);
  result.start = record.start;
  if (record.truth.size() > 0) result.truth = record.truth.leftCols(count);
  if (!record.linearized.empty())
    result.linearized.assign(record.linearized.begin(), record.linearized.begin() + count);
  return result;
}

/// Removes the measurements that the gates rejected; for a sensor with correlated noise, the whole
/// sample.
void take_out(const FilterModel& model, const FilterRun& run, FilterRecord& record) {
  for (Index k = 0; k < record.samples(); ++k) {
    Index first = 0;
    for (const FilterSensor& sensor : model.sensors) {
      const auto refused = run.refused.col(k).segment(first, sensor.C.rows());
      auto y = record.y.col(k).segment(first, sensor.C.rows());
      const bool all = !sensor.R.full.empty() && refused.any();
      for (Index i = 0; i < y.size(); ++i)
        if (all || refused(i) != 0) y(i) = std::nan("");
      first += sensor.C.rows();
    }
  }
}

/// Records of a linear model without the measurements that its gates reject.
Records gated(const FilterModel& model, const std::vector<FilterRecord>& records) {
  if (!has_gate(model))
    return [&records](const VectorXd&, const Stop&) { return LinearizedLogs{records, ""}; };
  return [likelihood = InnovationLikelihood(model, records)](const VectorXd& theta,
                                                             const Stop& stop) mutable {
    likelihood.stop_when(stop);
    LinearizedLogs result{likelihood.records(), ""};
    for (std::size_t r = 0; r < result.records.size(); ++r) {
      const FilterRun run = likelihood.run(r, theta);
      if (run.status == LikelihoodStatus::computed)
        take_out(likelihood.model(), run, result.records[r]);
    }
    return result;
  };
}

Index refused_since(const std::vector<FilterRecord>& before,
                    const std::vector<FilterRecord>& after) {
  Index changes = 0;
  for (std::size_t r = 0; r < before.size(); ++r)
    changes += (before[r].y.array().isNaN() != after[r].y.array().isNaN()).count();
  return changes;
}

std::vector<RefusedCount> count_refused(const FilterModel& model,
                                        const std::vector<FilterRecord>& all,
                                        const std::vector<FilterRecord>& believed) {
  std::vector<RefusedCount> result;
  Index i = 0;
  for (const FilterSensor& sensor : model.sensors)
    for (const Signal& signal : sensor.outputs) {
      if (std::isfinite(sensor.gate)) {
        RefusedCount count{fmt::format("{}: {}", sensor.name, signal.name)};
        for (std::size_t r = 0; r < all.size(); ++r) {
          const Index measured = (!all[r].y.row(i).array().isNaN()).count();
          count.measured += measured;
          count.refused += measured - (!believed[r].y.row(i).array().isNaN()).count();
        }
        result.push_back(count);
      }
      ++i;
    }
  return result;
}

/// θ of a fit that is robust to outliers, because the errors of gated sensors have heavy tails in
/// it.
VectorXd first_guess(const FilterModel& model, const std::vector<FilterRecord>& records,
                     const NoiseFitOptions& options, double holdout) {
  FilterModel tailed = model;
  for (FilterSensor& sensor : tailed.sensors)
    if (std::isfinite(sensor.gate) && sensor.student == 0 && is_diagonal(sensor.R))
      sensor.student = kLongTails;
  const InnovationLikelihood likelihood(tailed, fitted_parts(records, holdout));
  const NoiseFit fit = fit_noise(likelihood, options);
  return fit.status == NoiseFitStatus::not_computed || fit.theta.size() == 0 ? start_of(model)
                                                                             : fit.theta;
}

/// All runs, or the first one that failed.
struct Runs {
  std::vector<FilterRun> runs;
  std::string culprit;
};

Runs run_all(const InnovationLikelihood& likelihood, const VectorXd& theta) {
  Runs result;
  for (std::size_t r = 0; r < likelihood.records().size(); ++r) {
    result.runs.push_back(likelihood.run(r, theta));
    FilterRun& run = result.runs.back();
    run.refused.resize(0, 0);
    if (likelihood.records()[r].truth.size() == 0) {  // the states are not used
      run.x.resize(0, 0);
      run.x_variance.resize(0, 0);
    }
    if (run.status == LikelihoodStatus::computed) continue;
    result.culprit = run.culprit.empty() ? "innovations exceed the range of a double" : run.culprit;
    break;
  }
  return result;
}

/// The fitted part of each run, or the held-out part.
std::vector<FilterRun> part_of(const std::vector<FilterRun>& runs,
                               const std::vector<FilterRecord>& records, double holdout,
                               bool held_out) {
  std::vector<FilterRun> result;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const Index cut = first_held_out(records[r], holdout), all = records[r].samples();
    const Index from = held_out ? cut : 0, count = held_out ? all - cut : cut;
    FilterRun& part = result.emplace_back();
    part.status = runs[r].status;
    part.innovation = runs[r].innovation.middleCols(from, count);
    part.variance = runs[r].variance.middleCols(from, count);
    if (runs[r].x.size() == 0) continue;
    part.x = runs[r].x.middleCols(from, count);
    part.x_variance = runs[r].x_variance.middleCols(from, count);
  }
  return result;
}

/// The true states in the part of each record that part_of() selects.
std::vector<FilterRecord> truths_of(const std::vector<FilterRecord>& records, double holdout,
                                    bool held_out) {
  std::vector<FilterRecord> result(records.size());
  for (std::size_t r = 0; r < records.size(); ++r) {
    if (records[r].truth.size() == 0) continue;
    const Index cut = first_held_out(records[r], holdout), all = records[r].samples();
    result[r].truth =
        held_out ? records[r].truth.rightCols(all - cut) : records[r].truth.leftCols(cut);
  }
  return result;
}

/// How records depend on θ.
enum class Kind { constant, gated, linearized };

class Tuner {
 public:
  Tuner(const FilterModel& model, Records records, const NoiseTuningOptions& options)
      : model_(model),
        records_(std::move(records)),
        options_(options),
        begin_(std::chrono::steady_clock::now()) {
    require(options.seconds > 0, "seconds", options.seconds, "a positive number");
    require(options.holdout >= 0 && options.holdout <= 0.9, "holdout", options.holdout, "0 to 0.9");
    require(options.max_rejected >= 0 && options.max_rejected < 1, "max_rejected",
            options.max_rejected, "0 or more and less than 1");
  }

  /// @param all    the measurements before any gate
  /// @param kind   how the records depend on θ
  /// @param first  θ of the first records
  NoiseTuning run(const std::vector<FilterRecord>& all, Kind kind, const VectorXd& first) {
    LinearizedLogs logs;
    best_ = first;
    tuning_.warnings = internal::hanging_measurements(model_, all);
    try {
      if (kind == Kind::linearized)  // otherwise the fit checks the records itself
        logs.culprit = internal::constant_measurement(model_, fitted_parts(all, options_.holdout));
      if (logs.culprit.empty()) logs = records_(first, over());
      if (logs.culprit.empty()) fit(logs, kind != Kind::constant);
      if (!logs.culprit.empty()) {
        tuning_.fit.status = NoiseFitStatus::not_computed;
        tuning_.fit.culprit = logs.culprit;
      }
    } catch (const Interrupted&) {
      tuning_.fit.status = NoiseFitStatus::interrupted;
    }
    tuning_.fit.evaluations = evaluations_;
    if (tuning_.fit.status == NoiseFitStatus::interrupted) end_early();
    if (tuning_.fit.status != NoiseFitStatus::not_computed &&
        tuning_.fit.status != NoiseFitStatus::interrupted) {
      try {
        look_at_innovations(all, kind, logs);
      } catch (const Interrupted&) {
        tuning_.fit.status = NoiseFitStatus::interrupted;
      }
    }
    judge();
    return std::move(tuning_);
  }

  /// The options given, with the time limit added and the progress reported as a part of the whole.
  [[nodiscard]] NoiseFitOptions fit_options() {
    NoiseFitOptions options = options_.fit;
    options.interrupted = over();
    if (options_.progress)
      options.progress = [this](int evaluations, double best) {
        options_.progress(tuning_.rounds, evaluations_ + evaluations, best);
      };
    return options;
  }

 private:
  static void require(bool holds, const char* name, double value, const char* expected) {
    if (!holds)
      throw InvalidInput("tuning", fmt::format("{} is {}, expected {}", name, value, expected));
  }

  /// Whether the search must end: the time is over, or the user interrupts.
  [[nodiscard]] Stop over() const {
    return [this] {
      return wanted() ||
             std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count() >=
                 options_.seconds;
    };
  }
  /// Whether the user interrupts.
  [[nodiscard]] bool wanted() const {
    return options_.fit.interrupted && options_.fit.interrupted();
  }

  /// Result of a search that was ended: the best point so far.
  void end_early() {
    NoiseFit& fit = tuning_.fit;
    if (!wanted()) fit.status = NoiseFitStatus::out_of_time;
    if (fit.theta.size() == 0) fit.theta = best_;
    fit.parameters = internal::parameters_at(model_, fit.theta);
    fit.unseen.clear();
    if (before_.computed()) fit.before = before_;
  }

  /// Evaluates the whole records with the estimated covariances and with those of the model.
  void look_at_innovations(const std::vector<FilterRecord>& all, Kind kind, LinearizedLogs& logs) {
    const Stop stop = options_.fit.interrupted;
    const VectorXd start = start_of(model_);
    if (tuning_.fit.status == NoiseFitStatus::out_of_time && kind != Kind::constant) {
      logs = records_(tuning_.fit.theta, stop);
      if (!logs.culprit.empty()) {
        tuning_.fit.status = NoiseFitStatus::not_computed;
        tuning_.fit.culprit = logs.culprit;
        return;
      }
    }
    tuning_.refused = count_refused(model_, all, logs.records);
    const auto look = [&](const LinearizedLogs& at_start) {
      compare(logs, at_start, start);
      if (!options_.keep_records) return;
      tuning_.records_before = at_start.records;
      tuning_.records_after = logs.records;
    };
    if (kind == Kind::linearized)
      look(records_(start, stop));
    else
      look(logs);
  }

  void fit_once(const InnovationLikelihood& likelihood, const NoiseFitOptions& options) {
    if (options_.method == NoiseMethod::likelihood) {
      tuning_.fit = fit_noise(likelihood, options);
      evaluations_ += tuning_.fit.evaluations;
      // If it ended before it improved the start, there is only the start itself.
      if (tuning_.fit.status == NoiseFitStatus::interrupted &&
          (tuning_.fit.evaluations == 0 || tuning_.fit.theta == start_of(likelihood.model())))
        tuning_.fit.theta = best_;
      best_ = tuning_.fit.theta;
      return;
    }
    tuning_.autocovariances = fit_autocovariances(likelihood.model(), likelihood.records(),
                                                  {.confidence = options.confidence,
                                                   .profile = options.profile,
                                                   .interrupted = options.interrupted});
    best_ = tuning_.autocovariances->theta;
    tuning_.fit = as_noise_fit(*tuning_.autocovariances, likelihood);
    evaluations_ += tuning_.fit.evaluations;
  }

  /// Compares the last fit with that of the other method.
  void compare_with_other(const InnovationLikelihood& likelihood) {
    if (!options_.compare || !tuning_.fit.converged() || over()()) return;
    AgreementOptions options = options_.agreement;
    options.threads = options_.fit.threads;
    options.interrupted = over();
    tuning_.agreement = compare_methods(tuning_.fit, options_.method, likelihood, options);
    for (const std::string& reason : tuning_.agreement->disagreements)
      tuning_.warnings.push_back(reason);
  }

  /// Fits until neither the path nor the rejected measurements change.
  void fit(LinearizedLogs& logs, bool changing) {
    NoiseFitOptions options = fit_options();
    options.bounds = !changing;  // those of the last fit suffice
    options.profile = options_.fit.profile && !changing;
    options.rough = changing;
    FilterModel model = model_;
    for (tuning_.rounds = 1;; ++tuning_.rounds) {
      InnovationLikelihood likelihood(model, fitted_parts(logs.records, options_.holdout));
      likelihood.stop_when(over());
      fit_once(likelihood, options);
      if (tuning_.rounds == 1) before_ = tuning_.fit.before;
      if (!changing || tuning_.fit.status == NoiseFitStatus::not_computed ||
          tuning_.fit.status == NoiseFitStatus::interrupted) {
        compare_with_other(likelihood);
        return;
      }
      LinearizedLogs next = records_(tuning_.fit.theta, over());
      const bool settled = next.culprit.empty() && refused_since(logs.records, next.records) == 0 &&
                           change(start_of(model)) < kSettled;
      logs = std::move(next);
      if (!logs.culprit.empty()) return;
      if (settled && finish(logs, with_noise(model_, tuning_.fit.theta))) return;
      if (tuning_.rounds == kMaxRounds) {
        tuning_.fit.status = NoiseFitStatus::not_converged;
        tuning_.fit.culprit = fmt::format(
            "the path of the filter and the measurements that its gates reject still change after "
            "{} fits",
            kMaxRounds);
        return;
      }
      model = with_noise(model_, tuning_.fit.theta);
      options.starts = 1;
      options.strides = false;  // the last fit takes them
    }
  }

  /// Repeats the converged fit with all requested options.
  /// @return  false if it changed, and the path with it
  bool finish(const LinearizedLogs& logs, const FilterModel& model) {
    InnovationLikelihood likelihood(model, fitted_parts(logs.records, options_.holdout));
    NoiseFitOptions options = fit_options();
    options.starts = 1;
    fit_once(likelihood, options);
    if (tuning_.fit.status == NoiseFitStatus::interrupted) return true;
    likelihood.stop_when(over());
    tuning_.fit.before = likelihood.evaluate(start_of(model_));
    const bool settled = change(start_of(model)) < kFarOff;
    if (settled) compare_with_other(likelihood);
    return settled;
  }

  /// Largest change of a free parameter from `before`, in its standard errors.
  [[nodiscard]] double change(const VectorXd& before) const {
    double max = 0;
    for (Index i = 0; i < before.size(); ++i) {
      const FittedParameter& p = tuning_.fit.parameters[static_cast<std::size_t>(i)];
      if (p.verdict != ParameterVerdict::seen) continue;
      max = std::max(max, std::abs(tuning_.fit.theta(i) - before(i)) / p.standard_error);
    }
    return max;
  }

  void compare(const LinearizedLogs& logs, const LinearizedLogs& at_start, const VectorXd& start) {
    const std::vector<FilterRecord>& records = logs.records;
    // Without gates, since outliers are removed already: all other measurements are used.
    FilterModel open = model_;
    for (FilterSensor& sensor : open.sensors) sensor.gate = std::numeric_limits<double>::infinity();
    const auto all_runs = [&](const std::vector<FilterRecord>& of, const VectorXd& theta) {
      InnovationLikelihood likelihood(open, of);
      likelihood.stop_when(options_.fit.interrupted);
      return run_all(likelihood, theta);
    };
    const Runs new_runs = all_runs(records, tuning_.fit.theta);
    const Runs old_runs =
        at_start.culprit.empty() ? all_runs(at_start.records, start) : Runs{{}, at_start.culprit};
    if (new_runs.culprit.empty()) {
      const std::string exact = internal::exact_measurement(model_, records, new_runs.runs);
      if (!exact.empty()) {
        tuning_.fit.status = NoiseFitStatus::not_computed;
        tuning_.fit.culprit = exact;
        return;
      }
    }
    tuning_.before = consistency_of(old_runs, at_start.records);
    tuning_.after = consistency_of(new_runs, records);
    if (options_.holdout > 0) hold_out(old_runs, new_runs, records);
    if (new_runs.culprit.empty())
      opposite_signs_ =
          internal::opposite_signs(open, records, tuning_.fit.theta, options_.fit.interrupted);
    if (old_runs.culprit.empty() && new_runs.culprit.empty())
      compare_accuracy({at_start.records, old_runs.runs}, {records, new_runs.runs});
  }

  /// Compares the errors of both with the true states, over the held-out part if they are known
  /// there.
  void compare_accuracy(const TrueRuns& before, const TrueRuns& after) {
    const auto over = [&](bool held_out) {
      const double holdout = options_.holdout;
      return compare_errors(model_,
                            {truths_of(before.records, holdout, held_out),
                             part_of(before.runs, before.records, holdout, held_out)},
                            {truths_of(after.records, holdout, held_out),
                             part_of(after.runs, after.records, holdout, held_out)});
    };
    // In the order of the states, each over the held-out part if its true values are known there.
    tuning_.accuracy = over(false);
    if (options_.holdout > 0)
      for (StateAccuracy& unseen : over(true)) {
        unseen.held_out = true;
        const auto same =
            std::find_if(tuning_.accuracy.begin(), tuning_.accuracy.end(),
                         [&](const StateAccuracy& fitted) { return fitted.state == unseen.state; });
        if (same == tuning_.accuracy.end())
          tuning_.accuracy.push_back(std::move(unseen));
        else
          *same = std::move(unseen);
      }
    std::vector<std::string> worse;
    bool held_out = true;
    for (const StateAccuracy& state : tuning_.accuracy) {
      if (!(state.after > kLessAccurate * state.before)) continue;
      held_out = held_out && state.held_out;
      worse.push_back(fmt::format("{}: error {:.3g} {}, {:.0f} % larger than before{}", state.state,
                                  state.after, state.unit, 100 * (state.after / state.before - 1),
                                  state.p < 0.05 ? "" : ", which may be chance"));
    }
    if (worse.empty()) return;
    tuning_.warnings.push_back(
        fmt::format("the tuned filter is {}less accurate{}: {}",
                    distance_from_one(tuning_.after) < distance_from_one(tuning_.before)
                        ? "more consistent but "
                        : "",
                    held_out ? " on the held-out part" : "", internal::joined(worse, "; ")));
  }

  /// Distance of the sizes of innovations and of errors from 1.
  static double distance_from_one(const Consistency& consistency) {
    double sum = 0;
    for (const ConsistencyCheck& c : consistency.checks)
      if (c.name == "size" || c.name == "error") sum += std::abs(std::log(c.value));
    return sum;
  }

  [[nodiscard]] Consistency consistency_of(const Runs& runs,
                                           const std::vector<FilterRecord>& records) const {
    if (runs.culprit.empty()) {
      const std::vector<FilterRun> first = part_of(runs.runs, records, options_.holdout, false);
      Consistency result = check_consistency(model_, first, options_.consistency);
      for (const ConsistencyCheck& c : check_errors(model_, records, first, options_.consistency)) {
        result.checks.push_back(c);
        if (c.verdict != CheckVerdict::fail) continue;
        result.verdict = CheckVerdict::fail;
        result.reasons.push_back(c.reason);
      }
      return result;
    }
    Consistency none;
    none.verdict = CheckVerdict::fail;
    none.reasons = {runs.culprit};
    return none;
  }

  void hold_out(const Runs& old_runs, const Runs& new_runs,
                const std::vector<FilterRecord>& records) {
    if (!new_runs.culprit.empty()) {
      tuning_.holdout.verdict = CheckVerdict::fail;
      tuning_.holdout.reason = new_runs.culprit;
      return;
    }
    std::vector<FilterRun> before;
    if (old_runs.culprit.empty()) before = part_of(old_runs.runs, records, options_.holdout, true);
    tuning_.holdout = internal::judge_held_out(
        model_, before, part_of(new_runs.runs, records, options_.holdout, true),
        options_.consistency.significance);
  }

  void judge() {
    const NoiseFit& fit = tuning_.fit;
    std::vector<std::string> doubts;  // reported after the failures
    const auto worsen = [&](CheckVerdict to, const std::string& reason) {
      (to == CheckVerdict::fail ? tuning_.reasons : doubts).push_back(reason);
      if (tuning_.verdict != CheckVerdict::fail) tuning_.verdict = to;
    };
    tuning_.verdict = CheckVerdict::pass;
    if (!fit.converged())
      worsen(CheckVerdict::fail, fmt::format("the fit is {}{}", to_string(fit.status),
                                             fit.culprit.empty() ? "" : ": " + fit.culprit));
    if (fit.status == NoiseFitStatus::not_computed || fit.status == NoiseFitStatus::interrupted)
      return;
    if (!opposite_signs_.empty()) worsen(CheckVerdict::fail, opposite_signs_);
    for (const std::string& direction : fit.unseen) worsen(CheckVerdict::fail, direction);
    for (const RefusedCount& count : tuning_.refused)
      if (static_cast<double>(count.refused) >
          options_.max_rejected * static_cast<double>(count.measured))
        worsen(CheckVerdict::fail,
               fmt::format("{}: the gate rejects {} of {} measurements, too many to be outliers",
                           count.output, count.refused, count.measured));
    for (const std::string& reason : tuning_.after.reasons) worsen(tuning_.after.verdict, reason);
    if (options_.holdout > 0 && tuning_.holdout.verdict != CheckVerdict::pass)
      worsen(tuning_.holdout.verdict, tuning_.holdout.reason);
    tuning_.reasons.insert(tuning_.reasons.end(), doubts.begin(), doubts.end());
  }

  const FilterModel& model_;
  Records records_;
  const NoiseTuningOptions& options_;
  std::chrono::steady_clock::time_point begin_;
  int evaluations_ = 0;         ///< of the completed fits
  VectorXd best_;               ///< best θ so far
  Likelihood before_;           ///< of the first fit
  std::string opposite_signs_;  ///< channels of doubtful sign
  NoiseTuning tuning_;
};

}  // namespace

std::vector<FilterRecord> fitted_parts(const std::vector<FilterRecord>& records, double holdout) {
  std::vector<FilterRecord> result;
  result.reserve(records.size());
  for (const FilterRecord& record : records) result.push_back(beginning(record, holdout));
  return result;
}

FilterModel with_noise(FilterModel model, const Eigen::Ref<const VectorXd>& theta) {
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    const double value = theta(static_cast<Index>(i));
    // A search may reduce a variance to 0, which is not a valid start: use the smallest that a
    // double allows.
    constexpr double kFarthest = 700;
    model.parameters[i].start = model.parameters[i].logarithmic
                                    ? std::exp(std::clamp(value, -kFarthest, kFarthest))
                                    : value;
  }
  return model;
}

NoiseTuning tune_noise(const FilterModel& model, const std::vector<FilterRecord>& records,
                       const NoiseTuningOptions& options) {
  Tuner tuner(model, gated(model, records), options);
  if (!has_gate(model)) return tuner.run(records, Kind::constant, start_of(model));
  const VectorXd first = first_guess(model, records, tuner.fit_options(), options.holdout);
  return tuner.run(records, Kind::gated, first);
}

NoiseTuning tune_noise(const NonlinearFilter& filter, const NoiseTuningOptions& options) {
  Tuner tuner(
      filter.model(),
      [&](const VectorXd& theta, const Stop& stop) { return filter.linearize(theta, stop); },
      options);
  NoiseTuning tuning = tuner.run(filter.measurements(), Kind::linearized, start_of(filter.model()));
  tuning.left_out = filter.left_out();
  return tuning;
}

}  // namespace quadtune
