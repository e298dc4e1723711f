// SPDX-License-Identifier: Apache-2.0
#include "design/cascade_table.hpp"

#include <fmt/format.h>

#include <numbers>

#include "control/cascade_reader.hpp"
#include "quadtune/errors.hpp"

namespace quadtune::internal {

CascadeDesign read_cascade(const TomlTable& table) {
  std::vector<TomlKey> keys = cascade_gain_keys();
  keys.insert(keys.end(), {{"design"},
                           {"integrator"},
                           {"attitude_limit", "rad"},
                           {"integrator_limit"},
                           {"back_calculation", "per_s"},
                           {"takeoff_time", "s"},
                           {"velocity_feed_forward"},
                           {"conditional_integration"}});
  table.allow(keys);
  CascadeDesign cascade;
  const auto wanted = table.maybe_table("design");
  if (wanted) {
    for (const std::string& name : cascade_axis_names())
      if (table.has(name))
        throw InvalidInput(table.where(name),
                           fmt::format("[cascade] has gains of {} in addition to [cascade.design], "
                                       "expected only one of them",
                                       name));
    cascade.gains.dt = table.number("dt_s", kControlPeriods);
    const CascadeSpecification asked = read_cascade_specification(*wanted, cascade.gains.dt);
    if (wanted->has("rate_lead_s")) {
      if (wanted->keys().size() > 1)
        throw InvalidInput(
            wanted->where("rate_lead_s"),
            "rate_lead_s requires a design on the flown plant, expected no other key in "
            "[cascade.design], because the others are for a design loop by loop");
      cascade.rate_lead =
          wanted->number("rate_lead_s", {0, Range::Bound::closed, kMaxLag, Range::Bound::closed});
    } else if (!wanted->keys().empty()) {
      cascade.specification = asked;
      cascade.method = asked.method;
    }
    if (table.has("integrator"))
      throw InvalidInput(
          table.where("integrator"),
          "[cascade] has an integrator in addition to [cascade.design]; move it there");
  } else {
    cascade.gains = read_cascade_gains(table);
    if (table.has("integrator"))
      cascade.method = pid_method(table.text("integrator"), table.where("integrator"));
  }
  cascade.attitude_limit =
      table.number_or("attitude_limit_rad", cascade.attitude_limit,
                      {0, Range::Bound::open, std::numbers::pi, Range::Bound::closed});
  cascade.integrator_limit =
      table.number_or("integrator_limit", cascade.integrator_limit, Range::positive());
  cascade.back_calculation = table.number_or("back_calculation_per_s", 0, Range::not_negative());
  cascade.takeoff_time = table.number_or("takeoff_time_s", 0, Range::not_negative());
  // Gains that are designed here are flown by the same law that the design assumes.
  const auto truth = [&](const char* key) {
    return table.has(key) ? table.truth(key) : wanted.has_value();
  };
  cascade.velocity_feed_forward = truth("velocity_feed_forward");
  cascade.conditional_integration = truth("conditional_integration");
  return cascade;
}

}  // namespace quadtune::internal
