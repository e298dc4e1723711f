// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/cascade_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "quadtune/control/cascade_law.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/mixer.hpp"
#include "quadtune/workbench/design/linearize_or_refuse.hpp"

namespace quadtune {
namespace {

void add_margins(CascadeReport& report) {
  const DiscreteLti law = cascade_law(report.cascade.gains, report.specification.method);
  report.open_loop = cut_at_inputs(report.cascade.plant, law);
  report.margins = margins_report(OpenLoop(report.open_loop), names_or_numbers(law.outputs, 4));
}

}  // namespace

CascadeVehicle cascade_vehicle(const Vehicle& vehicle, const std::string& where) {
  LinearizeOptions options;
  options.inputs = InputKind::wrench;
  CascadeVehicle hover;
  const Linearization model = linearize_or_refuse(vehicle, FlightCondition{}, options, where);
  hover.hover = model.plant;
  hover.authority = wrench_authority(vehicle, model.trim.u);
  const char* axes[] = {"thrust", "roll", "pitch", "yaw"};
  for (Eigen::Index i = 0; i < 4; ++i)
    if (!(hover.authority(i) > 0))
      throw NoSolution(
          fmt::format("{}: no authority: at hover the rotors cannot change {}", where, axes[i]),
          where);
  for (const Rotor& rotor : vehicle.rotors) hover.lag = std::max(hover.lag, slower_lag(rotor));
  if (vehicle.published_cascade) hover.published = vehicle.published_cascade->gains;
  return hover;
}

Vehicle without_lag(Vehicle vehicle) {
  for (Rotor& rotor : vehicle.rotors) {
    rotor.lag = 0;
    rotor.lag_down = std::numeric_limits<double>::quiet_NaN();
  }
  vehicle.motor.delay = vehicle.motor.delay_jitter = 0;
  return vehicle;
}

CascadeReport design_cascade(const Vehicle& vehicle, const CascadeSpecification& specification,
                             const std::string& where) {
  CascadeReport report;
  report.vehicle = vehicle.name;
  report.specification = specification;
  const CascadeVehicle hover = cascade_vehicle(vehicle, where);
  if (!report.specification.lag) report.specification.lag = hover.lag;
  if (vehicle.published_cascade) {
    report.published_source = vehicle.published_cascade->source;
    report.published = vehicle.published_cascade->gains;
  }
  report.designed = true;
  report.cascade = pid_cascade(hover, report.specification);
  if (!report.cascade.solved()) {
    const CascadeAxisDesign& failed = report.cascade.failed();
    const bool held = std::isfinite(failed.bounds.rate_noise_max);
    throw NoSolution(fmt::format("{}: pid: {}: {}: {}{}", where, to_string(failed.axis),
                                 to_string(failed.design.status), failed.design.culprit,
                                 held ? "; the published gains of the vehicle set each of these "
                                        "bounds for which no option was given"
                                      : ""),
                     where);
  }
  add_margins(report);
  return report;
}

DiscreteLti cascade_plant(const Vehicle& vehicle, const CascadeDesign& cascade,
                          const std::string& where) {
  CascadeSpecification specification;
  specification.dt = cascade.gains.dt;
  specification.method = cascade.method;
  return sampled_hover(cascade_vehicle(vehicle, where), specification);
}

CascadeReport assess_written_cascade(const Vehicle& vehicle, const CascadeGains& gains,
                                     PidMethod method, const std::string& where) {
  CascadeReport report;
  report.vehicle = vehicle.name;
  report.specification.dt = gains.dt;
  report.specification.method = method;
  const CascadeVehicle hover = cascade_vehicle(vehicle, where);
  report.specification.lag = hover.lag;
  report.cascade = assess_cascade(hover, report.specification, gains);
  add_margins(report);
  return report;
}

std::vector<std::string> cascade_warnings(const CascadeReport& report) {
  MarginsReport loops;
  loops.dt = report.specification.dt;
  for (const CascadeAxisDesign& loop : report.cascade.loops) {
    loops.names.push_back(to_string(loop.axis));
    loops.loops.push_back(loop.design.evidence.margins);
  }
  std::vector<std::string> warnings = margin_warnings(loops);
  for (std::string& warning : margin_warnings(report.margins))
    warnings.push_back(std::move(warning));
  return warnings;
}

bool unstable(const CascadeReport& report) {
  return !(report.cascade.poles.cwiseAbs().maxCoeff() < 1);
}

}  // namespace quadtune
