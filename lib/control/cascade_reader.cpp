// SPDX-License-Identifier: Apache-2.0
#include "control/cascade_reader.hpp"

#include <numbers>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune::internal {
namespace {

std::vector<TomlKey> axis_keys() {
  std::vector<TomlKey> keys;
  for (const std::string& name : cascade_axis_names()) keys.push_back({name});
  return keys;
}

/// Calls `use` for each axis with a number in the table under `key`.
template <class Use>
void each_number(const TomlTable& table, const std::string& key, const Range& range,
                 const Use& use) {
  const std::optional<TomlTable> numbers = table.maybe_table(key);
  if (!numbers) return;
  numbers->allow(axis_keys());
  for (const CascadeAxis axis : kAllCascadeAxes)
    if (numbers->has(to_string(axis))) use(axis, numbers->number(to_string(axis), range));
}

}  // namespace

std::vector<TomlKey> cascade_gain_keys() {
  std::vector<TomlKey> keys = axis_keys();
  keys.push_back({"dt", "s"});
  return keys;
}

CascadeGains read_cascade_gains(const TomlTable& table) {
  CascadeGains gains;
  gains.dt = table.number("dt_s", kControlPeriods);
  for (const CascadeAxis axis : kAllCascadeAxes) {
    PidLoop loop = cascade_loop(axis);
    const TomlTable numbers = table.table(loop.name);
    numbers.allow({{"Kp"}, {"Ki"}, {"Kd"}, {"rate_lead", "s"}, {"rate_filter", "s"}});
    loop.Kp = numbers.number("Kp");
    loop.Ki = numbers.number_or("Ki", 0);
    loop.Kd = numbers.number_or("Kd", 0);
    loop.rate_lead = numbers.number_or("rate_lead_s", 0, Range::not_negative());
    loop.rate_filter = numbers.number_or("rate_filter_s", 0, Range::not_negative());
    gains.loops.push_back(std::move(loop));
  }
  return gains;
}

CascadeSpecification read_cascade_specification(const TomlTable& table, double dt) {
  table.allow({{"integrator"},
               {"motor_lag", "s"},
               {"sensor_delay", "s"},
               {"bandwidth", "rad_per_s"},
               {"Ms_max"},
               {"tracking_max"},
               {"integral"},
               {"structure"},
               {"published"},
               {"rate_lead", "s"}});
  constexpr Range kMoreThanOne = {1, Range::Bound::open, 0, Range::Bound::none};
  CascadeSpecification specification;
  specification.dt = dt;
  if (table.has("integrator"))
    specification.method = pid_method(table.text("integrator"), table.where("integrator"));
  if (table.has("motor_lag_s"))
    specification.lag =
        table.number("motor_lag_s", {0, Range::Bound::closed, kMaxLag, Range::Bound::closed});
  const Range delays = {0, Range::Bound::closed, kMaxDelaySamples * dt, Range::Bound::closed};
  each_number(table, "sensor_delay_s", delays,
              [&](CascadeAxis axis, double delay) { specification.delay[index_of(axis)] = delay; });
  const Range below_nyquist = {0, Range::Bound::open, std::numbers::pi / dt, Range::Bound::open};
  each_number(table, "bandwidth_rad_per_s", below_nyquist, [&](CascadeAxis axis, double w) {
    specification.requirements[index_of(axis)].bandwidth = w;
  });
  const CascadeRequirement usual;
  for (CascadeRequirement& requirement : specification.requirements) {
    requirement.Ms_max = table.number_or("Ms_max", usual.Ms_max, kMoreThanOne);
    requirement.tracking_max = table.number_or("tracking_max", usual.tracking_max, kMoreThanOne);
    requirement.integral = !table.has("integral");
  }
  if (table.has("integral"))
    for (const std::string& name : table.texts("integral")) {
      const std::string where = table.where("integral");
      bool& integral = specification.requirements[index_of(cascade_axis(name, where))].integral;
      if (std::exchange(integral, true))
        throw InvalidInput(where, "integral lists loop '" + name + "' twice, expected each once");
    }
  if (table.has("structure"))
    specification.structure = cascade_structure(table.text("structure"), table.where("structure"));
  if (table.has("published")) specification.use_published = table.truth("published");
  return specification;
}

}  // namespace quadtune::internal
