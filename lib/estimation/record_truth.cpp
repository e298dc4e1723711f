// SPDX-License-Identifier: Apache-2.0
#include "estimation/record_truth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "logs/log_titles.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/angles.hpp"
#include "quadtune/estimation/inertial_filter.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/model/rigid_body.hpp"
#include "quadtune/model/rotation.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;

constexpr std::array<const char*, 4> kQuaternion = {"qw", "qx", "qy", "qz"};
constexpr std::array<const char*, 3> kEuler = {"roll", "pitch", "yaw"};
/// Tolerance of a quaternion's length, since a log has a limited number of digits.
constexpr double kLengthError = 0.01;

/// Position of a time in a series: fraction `share` of the way from sample `i` - 1 to `i`.
struct Between {
  std::size_t i = 0;
  double share = 0;
  bool known = false;  ///< false outside the series, in its gaps and far from its samples
};

/// Interpolates linearly between two samples. The result is accurate near them only and may be
/// wrong in the middle if the samples are sparse.
/// @param longest  maximum time between samples for interpolation [s]
/// @param near     maximum distance from a sample [s]
Between place(const LogSeries& series, double longest, double near, double t) {
  const auto after = std::lower_bound(series.time.begin(), series.time.end(), t - kSameInstant);
  if (after == series.time.end()) return {};
  const auto i = static_cast<std::size_t>(after - series.time.begin());
  if (std::abs(series.time[i] - t) <= kSameInstant) return {i, 1, true};
  if (i == 0 || series.time[i] - series.time[i - 1] > longest) return {};
  if (std::min(series.time[i] - t, t - series.time[i - 1]) > near + kSameInstant) return {};
  return {i, (t - series.time[i - 1]) / (series.time[i] - series.time[i - 1]), true};
}

/// A validated truth.
struct Truth {
  const LogSeries* series = nullptr;
  double longest = 0;  ///< maximum time between samples for interpolation [s]
  double scale = 1;    ///< factor to the unit of the state
  bool angle = false;  ///< may jump by a whole turn

  [[nodiscard]] double at(double t, double near) const {
    const Between where = place(*series, longest, near, t);
    if (!where.known) return std::nan("");
    const double here = series->values[where.i];
    if (where.share == 1) return scale * here;
    const double before = series->values[where.i - 1];
    double change = scale * (here - before);
    if (angle) change = wrap_angle(change);
    return scale * before + where.share * change;
  }
};

/// @param unit  of the quantity in the model
Truth truth_of(const ChannelUse& use, const std::string& unit, const std::string& name) {
  Truth truth{&use.series, 0, 1, unit == "rad"};
  const std::string given = common_unit(use.series.unit), wanted = common_unit(unit);
  if ((given == "deg" && wanted == "rad") || (given == "deg/s" && wanted == "rad/s"))
    truth.scale = std::numbers::pi / 180;
  else if (!unit.empty() && !given.empty())
    require_unit(use.series, unit, name);
  require_usable(use.series, name);
  truth.longest = kMaxHold * typical_period(use.series);
  return truth;
}

/// The truths for a group of names, in their order; empty if none of them is given.
template <std::size_t count>
std::vector<const ChannelUse*> together(const std::array<const char*, count>& names,
                                        const std::vector<ChannelUse>& truths,
                                        const std::string& name) {
  std::vector<const ChannelUse*> found(count, nullptr);
  std::size_t some = 0;
  for (std::size_t i = 0; i < count; ++i)
    for (const ChannelUse& use : truths)
      if (use.signal == names[i]) {
        found[i] = &use;
        ++some;
      }
  if (some == 0) return {};
  for (std::size_t i = 0; i < count; ++i)
    if (found[i] == nullptr)
      throw InvalidInput(name, fmt::format("a truth for {} is missing, expected all of {} because "
                                           "an attitude needs all of them",
                                           names[i], internal::joined(names, ", ")));
  return found;
}

class Attitude {
 public:
  Attitude(const FilterModel& model, const std::vector<ChannelUse>& truths,
           const std::string& name) {
    for (const ChannelUse* use : together(kQuaternion, truths, name))
      quaternion_.push_back(truth_of(*use, "", name));
    if (model.gravity)
      for (const ChannelUse* use : together(kEuler, truths, name))
        euler_.push_back(truth_of(*use, "rad", name));
    if (!quaternion_.empty() && !euler_.empty())
      throw InvalidInput(name,
                         "the attitude is given as a quaternion and as roll, pitch, yaw, "
                         "expected one of them");
    if (!quaternion_.empty()) check_quaternion(name);
  }

  [[nodiscard]] bool known() const { return !quaternion_.empty() || !euler_.empty(); }

  /// One of the series that determine the attitude.
  [[nodiscard]] const LogSeries& series() const {
    return *(quaternion_.empty() ? euler_ : quaternion_).front().series;
  }

  /// Attitude from body to world; NaN if it is not known.
  [[nodiscard]] Eigen::Quaterniond at(double t, double near) const {
    if (!euler_.empty())
      return quaternion_of_euler(euler_[0].at(t, near), euler_[1].at(t, near),
                                 euler_[2].at(t, near));
    const Between where = place(*quaternion_[0].series, quaternion_[0].longest, near, t);
    if (!where.known) {
      const double none = std::nan("");
      return {none, none, none, none};
    }
    const Eigen::Quaterniond here = sample(where.i);
    return where.share == 1 ? here : sample(where.i - 1).slerp(where.share, here);
  }

 private:
  void check_quaternion(const std::string& name) const {
    const LogSeries& first = *quaternion_[0].series;
    for (const Truth& other : quaternion_)
      if (other.series->time != first.time)
        throw InvalidInput(name,
                           fmt::format("'{}' and '{}' have different times, expected a quaternion "
                                       "of one table",
                                       printable(first.name), printable(other.series->name)));
    for (std::size_t i = 0; i < first.time.size(); ++i) {
      const double length = raw(i).norm();
      if (std::abs(length - 1) > kLengthError)
        throw InvalidInput(
            name,
            fmt::format("the quaternion of '{}' has the length {:.4g} at {:.6g} s, expected 1",
                        printable(first.name), length, first.time[i]));
    }
  }
  [[nodiscard]] Eigen::Quaterniond raw(std::size_t i) const {
    return {quaternion_[0].series->values[i], quaternion_[1].series->values[i],
            quaternion_[2].series->values[i], quaternion_[3].series->values[i]};
  }
  [[nodiscard]] Eigen::Quaterniond sample(std::size_t i) const { return raw(i).normalized(); }

  std::vector<Truth> quaternion_, euler_;
};

/// Rotation vector: axis times angle [rad], angle 0 … π.
Eigen::Vector3d turn_of(const Eigen::Quaterniond& q) {
  const Eigen::AngleAxisd turn(q);
  return turn.angle() * turn.axis();
}

/// Quantities for which a truth can be given.
std::vector<std::string> known_names(const FilterModel& model) {
  std::vector<std::string> names;
  // The rotation states of inertial navigation are relative to the filter's own attitude, which no
  // log contains.
  for (std::size_t i = model.gravity ? kInertialVelocity : 0; i < model.states.size(); ++i)
    names.push_back(model.states[i].name);
  if (model.gravity) names.insert(names.end(), kEuler.begin(), kEuler.end());
  if (!model.linear()) names.insert(names.end(), kQuaternion.begin(), kQuaternion.end());
  return names;
}

double typical_step(const Samples& time) {
  Samples steps;
  steps.reserve(time.size());
  for (std::size_t i = 1; i < time.size(); ++i) steps.push_back(time[i] - time[i - 1]);
  if (steps.empty()) return std::numeric_limits<double>::infinity();
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

/// Half of the typical step of a record: every sample of a truth is within this distance of an
/// instant.
double nearest(const FilterRecord& record) { return 0.5 * typical_step(record.time); }

/// @param rows  number of rows of the records' truths that the series determines
void require_told(const LogSeries& series, Index row, Index rows, const std::string& signal,
                  const std::string& name, const std::vector<FilterRecord>& records) {
  for (const FilterRecord& record : records)
    if (record.truth.middleRows(row, rows).array().isFinite().any()) return;
  throw InvalidInput(
      name,
      fmt::format("the truth for {} is from {:.6g} s to {:.6g} s and does not cover the "
                  "log's instants, {:.6g} s to {:.6g} s, expected one of the same flight with "
                  "the same clock",
                  signal, series.time.front(), series.time.back(), records.front().time.front(),
                  records.back().time.back()));
}

}  // namespace

double typical_period(const LogSeries& series) { return typical_step(series.time); }

void add_truths(const FilterModel& model, const std::vector<ChannelUse>& truths,
                const std::string& name, std::vector<FilterRecord>& records) {
  if (truths.empty() || records.empty()) return;
  const std::vector<std::string> known = known_names(model);
  for (std::size_t i = 0; i < truths.size(); ++i) {
    const std::string& signal = truths[i].signal;
    if (std::find(known.begin(), known.end(), signal) == known.end())
      throw OptionError("truth",
                        fmt::format("truth: the model '{}' has no state '{}', expected one of {}{}",
                                    model.name, printable(signal), internal::joined(known, ", "),
                                    did_you_mean(signal, known)));
    if (std::any_of(truths.begin(), truths.begin() + static_cast<std::ptrdiff_t>(i),
                    [&](const ChannelUse& other) { return other.signal == signal; }))
      throw InvalidInput(name,
                         fmt::format("the truth for '{}' is given twice, expected once", signal));
  }
  const Attitude attitude(model, truths, name);
  const Index first_angle = model.gravity ? Index{kInertialAttitude} : Index{kAttitude};
  for (FilterRecord& record : records) {
    record.truth = Eigen::MatrixXd::Constant(model.A.rows(), record.samples(), std::nan(""));
    if (!attitude.known()) continue;
    const double near = nearest(record);
    for (Index k = 0; k < record.samples(); ++k) {
      const Eigen::Quaterniond q = attitude.at(record.time[static_cast<std::size_t>(k)], near);
      if (!q.coeffs().allFinite()) continue;
      record.truth.col(k).segment<3>(first_angle) =
          model.gravity ? turn_of(q) : Eigen::Vector3d(euler_of_quaternion(q));
    }
  }
  if (attitude.known())
    require_told(attitude.series(), first_angle, 3, "the attitude", name, records);
  for (const ChannelUse& use : truths) {
    const auto state = std::find_if(model.states.begin(), model.states.end(),
                                    [&](const Signal& of) { return of.name == use.signal; });
    if (state == model.states.end()) continue;
    const Truth truth = truth_of(use, state->unit, name);
    const auto i = static_cast<Index>(state - model.states.begin());
    for (FilterRecord& record : records) {
      const double near = nearest(record);
      for (Index k = 0; k < record.samples(); ++k)
        record.truth(i, k) = truth.at(record.time[static_cast<std::size_t>(k)], near);
    }
    require_told(*truth.series, i, 1, "'" + use.signal + "'", name, records);
  }
}

}  // namespace quadtune::internal
