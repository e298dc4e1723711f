// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/logs/allan_of_log.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/tuning/simulated_imu.hpp"
#include "quadtune/workbench/logs/channel_place.hpp"
#include "quadtune/workbench/logs/sensor_log.hpp"

namespace quadtune {
namespace {

/// The unit of the rate whose integral has the unit `unit`.
std::string unit_of_rate(const std::string& unit) {
  if (unit.empty()) return "";
  if (unit == "s") return "1";
  return unit.ends_with("/s") ? unit + "^2" : unit + "/s";
}

/// A whole turn in the unit of an angle; 0 for other units.
double turn_in(const std::string& unit) {
  if (unit == "rad") return 2 * std::numbers::pi;
  return unit == "deg" ? 360 : 0;
}

/// Unwraps an angle: the angle of a stationary sensor never changes by half a turn between samples.
/// @return  the number of jumps
Eigen::Index unwrap(Eigen::VectorXd& angle, double turn) {
  Eigen::Index jumps = 0;
  double added = 0;
  for (Eigen::Index k = 1; k < angle.size(); ++k) {
    const double change = angle(k) + added - angle(k - 1);
    if (std::abs(change) > turn / 2) {
      added -= turn * std::round(change / turn);
      ++jumps;
    }
    angle(k) += added;
  }
  return jumps;
}

/// "m/s2" and "m/s^2" are the same unit.
std::string without_carets(std::string unit) {
  std::erase(unit, '^');
  return unit;
}

AllanRecord read(const AllanOptions& options) {
  SensorLog log = read_sensors(options.log, {options.column}, {}, options.reading, options.note);
  const LogSeries& series = log.series.front();
  const std::string name = log_name(channel_place(options.column, options.log).file);
  const Eigen::Map<const Eigen::VectorXd> values(series.values.data(), std::ssize(series.values));
  const std::string unit = options.unit.empty() ? series.unit : options.unit;
  const double dt = even_period(series, name);
  AllanRecord record{name, series.name, unit, values, dt, std::move(log.warnings)};
  if (!series.unit.empty() && without_carets(unit) != without_carets(series.unit)) {
    record.warnings.push_back(fmt::format(
        "{}: '{}' is in {} according to the log, but unit is {}; the values are not converted",
        name, internal::printable(series.name), internal::printable(series.unit),
        internal::printable(unit)));
    if (options.note) options.note("warning: " + record.warnings.back());
  }
  if (!options.phase) return record;
  record.phase = true;
  record.unit = unit_of_rate(unit);
  Eigen::VectorXd phase = values;
  if (const double turn = turn_in(unit); turn > 0)
    if (const Eigen::Index jumps = unwrap(phase, turn); jumps > 0) {
      record.warnings.push_back(
          fmt::format("{}: '{}' jumps by more than half a turn {} times: the angle is wrapped, "
                      "and whole turns are added at the jumps",
                      name, internal::printable(series.name), jumps));
      if (options.note) options.note(record.warnings.back());
    }
  record.rate = rate_of_phase(phase, dt);
  return record;
}

SensorAllan analysed(AllanRecord record, AllanTaus taus) {
  const auto samples = static_cast<std::size_t>(record.rate.size());
  AllanAnalysis analysis = analyse_allan(record.rate, record.dt, allan_factors(samples, taus));
  return {std::move(record), std::move(analysis)};
}

}  // namespace

AllanTaus allan_taus(const std::string& word) {
  if (word == "octaves") return AllanTaus::octaves;
  if (word == "decades") return AllanTaus::decades;
  if (word == "all") return AllanTaus::all;
  throw OptionError("taus",
                    fmt::format("taus is '{}', expected octaves, decades or all{}", word,
                                internal::did_you_mean(word, {"octaves", "decades", "all"})));
}

SensorAllan allan_of_log(const AllanOptions& options) {
  return analysed(read(options), options.taus);
}

SensorAllan allan_of_simulated(std::uint64_t seed, const std::string& unit, AllanTaus taus) {
  SimulatedGyroscope made = simulate_gyroscope(seed);
  return analysed({fmt::format("simulated with seed {}", seed), "wz", unit.empty() ? "rad/s" : unit,
                   std::move(made.rate), 1 / made.sample_rate},
                  taus);
}

}  // namespace quadtune
