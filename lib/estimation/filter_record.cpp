// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/filter_record.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

using Eigen::Index;

void check_times(const FilterRecord& record, const FilterModel& model, const std::string& where) {
  for (std::size_t k = 0; k < record.time.size(); ++k) {
    const double t = record.time[k];
    if (!std::isfinite(t))
      throw InvalidInput(where,
                         fmt::format("the time of sample {} is {}, expected a number", k + 1, t));
    if (k == 0) continue;
    const double step = t - record.time[k - 1];
    if (!(step > 0))
      throw InvalidInput(where,
                         fmt::format("the time changes from {} s to {} s at sample {}, expected "
                                     "increasing times",
                                     record.time[k - 1], t, k + 1));
    if (model.dt > 0) {
      const double periods = step / model.dt;
      // Allow a clock error of 0.1 % and a jitter of a tenth of a period.
      if (std::abs(periods - std::round(periods)) > 0.1 + 1e-3 * periods || periods < 0.5)
        throw InvalidInput(
            where,
            fmt::format("the time from sample {} to {} is {:.6g} s, expected a multiple of the "
                        "model's period {} s because it is discrete",
                        k, k + 1, step, model.dt));
    }
  }
}

void check_linearized(const FilterRecord& record, const FilterModel& model,
                      const std::string& where) {
  if (record.linearized.empty()) {
    if (!model.linear())
      throw InvalidInput(where, fmt::format("'{}' is not linear, expected a record that a filter "
                                            "linearized",
                                            model.name));
    return;
  }
  const auto nx = static_cast<Index>(model.states.size());
  if (record.linearized.size() != record.time.size())
    throw InvalidInput(where, fmt::format("there are {} linearized instants, expected {}",
                                          record.linearized.size(), record.time.size()));
  if (!model.Q.fixed.isZero(0) || !model.Q.full.empty())
    throw InvalidInput(where,
                       "Q of a linearized model has a fixed or a full part, expected "
                       "variances only");
  for (const FilterSensor& sensor : model.sensors)
    if (!model.linear() && sensor.D.size() > 0)
      throw InvalidInput(where,
                         fmt::format("sensor '{}' has a D, expected none because '{}' is not "
                                     "linear",
                                     sensor.name, model.name));
  for (const FilterSensor& sensor : model.sensors)
    if (!is_diagonal(sensor.R))
      throw InvalidInput(
          where, fmt::format("R of {} is not diagonal, expected a diagonal one because the model "
                             "is linearized",
                             sensor.name));
  for (const LinearizedInstant& at : record.linearized) {
    require_shape(at.C, model.outputs(), nx, where, "C of an instant", "one row per output");
    require_shape(at.F, nx, nx, where, "F of an instant", "one row per state");
    require_shape(at.offset, nx, 1, where, "the offset of an instant", "one entry per state");
    require_finite(at.C, where, "C of an instant");
    require_finite(at.F, where, "F of an instant");
    require_finite(at.offset, where, "the offset of an instant");
    if (at.noise.size() != model.Q.scaled.size())
      throw InvalidInput(where, fmt::format("an instant has {} noises, expected {}",
                                            at.noise.size(), model.Q.scaled.size()));
    for (const Eigen::MatrixXd& noise : at.noise) {
      require_shape(noise, nx, nx, where, "a noise of an instant", "one row per state");
      require_finite(noise, where, "a noise of an instant");
    }
  }
}

void check_start(const FilterRecord& record, const FilterModel& model, const std::string& where) {
  if (!record.start) return;
  const auto nx = static_cast<Index>(model.states.size());
  require_shape(record.start->x, nx, 1, where, "the state at the start", "one entry per state");
  require_finite(record.start->x, where, "the state at the start");
  require_shape(record.start->P, nx, nx, where, "the covariance at the start", "one row per state");
  require_finite(record.start->P, where, "the covariance at the start");
}

}  // namespace

LeftOutRecord left_out(const FilterRecord& record) {
  LeftOutRecord result{record.name, record.time.front(), record.time.back()};
  for (Index k = 0; k < record.samples(); ++k)
    if (!record.y.col(k).array().isNaN().all()) ++result.measurements;
  return result;
}

void validate(const FilterRecord& record, const FilterModel& model, const std::string& where) {
  validate_samples(record, model, where);
  check_linearized(record, model, where);
  check_start(record, model, where);
}

void validate_samples(const FilterRecord& record, const FilterModel& model,
                      const std::string& where) {
  const Index N = record.samples();
  if (N == 0) throw InvalidInput(where, "there are no samples, expected at least one");
  require_shape(record.y, model.outputs(), N, where, "the matrix of measurements",
                "one row per output, one column per sample");
  require_shape(record.u, static_cast<Index>(model.inputs.size()), N, where, "the matrix of inputs",
                "one row per input, one column per sample");
  require_finite(record.u, where, "the inputs");
  check_times(record, model, where);
  if (record.truth.size() > 0)
    require_shape(record.truth, static_cast<Index>(model.states.size()), N, where,
                  "the matrix of true states", "one row per state, one column per sample");
  for (Index k = 0; k < N; ++k) {
    Index first = 0;
    for (const FilterSensor& sensor : model.sensors) {
      Index present = 0;
      for (Index i = 0; i < sensor.C.rows(); ++i) {
        const double y = record.y(first + i, k);
        if (std::isinf(y))
          throw InvalidInput(where,
                             fmt::format("sample {} of {} is {}, expected a number", k + 1,
                                         sensor.outputs[static_cast<std::size_t>(i)].name, y));
        if (!std::isnan(y)) ++present;
      }
      if (!sensor.R.full.empty() && present > 0 && present < sensor.C.rows())
        throw InvalidInput(
            where, fmt::format("sample {} of {} has {} of {} outputs, expected all or none because "
                               "their noise is correlated",
                               k + 1, sensor.name, present, sensor.C.rows()));
      first += sensor.C.rows();
    }
  }
}

}  // namespace quadtune
