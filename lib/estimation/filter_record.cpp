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
                         fmt::format("the time goes from {} s to {} s at sample {}, expected "
                                     "that it increases",
                                     record.time[k - 1], t, k + 1));
    if (model.dt > 0) {
      const double periods = step / model.dt;
      // A clock may be off by a thousandth, and jitter by a tenth of a period.
      if (std::abs(periods - std::round(periods)) > 0.1 + 1e-3 * periods || periods < 0.5)
        throw InvalidInput(
            where, fmt::format("from sample {} to {} it is {:.6g} s, expected a multiple of the "
                               "model's period {} s because it is discrete",
                               k, k + 1, step, model.dt));
    }
  }
}

}  // namespace

void validate(const FilterRecord& record, const FilterModel& model, const std::string& where) {
  const Index N = record.samples();
  if (N == 0) throw InvalidInput(where, "no samples came, expected at least one");
  require_shape(record.y, model.outputs(), N, where, "the measurements",
                "one row an output, one column a sample");
  require_shape(record.u, static_cast<Index>(model.inputs.size()), N, where, "the inputs",
                "one row an input, one column a sample");
  require_finite(record.u, where, "the inputs");
  check_times(record, model, where);
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
