// SPDX-License-Identifier: Apache-2.0
#include "quadtune/control/cascaded_pid.hpp"

#include <cmath>

#include "quadtune/model/mixer.hpp"

namespace quadtune {

CascadedPidSettings<double> cascaded_pid_settings(const Vehicle& vehicle, const CascadeGains& gains,
                                                  PidMethod method, double attitude_limit,
                                                  double integrator_limit,
                                                  double back_calculation) {
  CascadedPidSettings<double> settings;
  for (PidSettings<double>& loop : settings.loops) loop.dt = gains.dt;
  for (const PidLoop& loop : gains.loops) {
    PidSettings<double>& target =
        settings.loops[index_of(cascade_axis(loop.name, "loop '" + loop.name + "'"))];
    target = pid_settings(loop, gains.dt);
    target.method = method;
    // The design limits the integral of the error; the element limits the integral part of its
    // output.
    const double max = std::abs(loop.Ki) * integrator_limit;
    if (loop.Ki != 0 && std::isfinite(max)) {
      target.integral_min = -max;
      target.integral_max = max;
    }
    // Without Ki, what back-calculation adds would never decay.
    target.back_calculation = loop.Ki != 0 ? back_calculation : 0;
    validate(target, "loop '" + loop.name + "'");
  }
  settings.attitude_limit = attitude_limit;
  settings.weight = vehicle.mass * vehicle.gravity;
  settings.take_off_thrust = (1 + vehicle.takeoff_gain) * settings.weight;
  settings.max_thrust = altitude_thrust_limit(vehicle);
  // Anti-windup must act on the output as limited here.
  PidSettings<double>& altitude = settings.loops[index_of(CascadeAxis::altitude)];
  altitude.output_min = settings.weight - settings.max_thrust;
  altitude.output_max = settings.weight;
  for (const CascadeAxis axis : {CascadeAxis::x, CascadeAxis::y}) {
    settings.loops[index_of(axis)].output_min = -attitude_limit;
    settings.loops[index_of(axis)].output_max = attitude_limit;
  }
  return settings;
}

}  // namespace quadtune
