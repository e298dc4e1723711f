// SPDX-License-Identifier: Apache-2.0
#include "simulation/flight_recorder.hpp"

#include <fmt/format.h>

#include "quadtune/simulation/air.hpp"
#include "simulation/loop/closed_loop_parts.hpp"

namespace quadtune::internal {
namespace {

std::string name_of(const Controller& controller) {
  if (const auto* own = std::get_if<OwnController>(&controller)) return own->name;
  return std::holds_alternative<CascadeController>(controller) ? "cascaded-pid" : "state-feedback";
}

}  // namespace

FlightRecorder::FlightRecorder(const FlightSetup& setup, const Sensors& sensors, int rotors,
                               std::size_t rows)
    : has_{sensors.accelerometer.has_value(),
           sensors.gyroscope.has_value(),
           sensors.magnetometer.has_value(),
           sensors.barometer.has_value(),
           sensors.sonar.has_value(),
           sensors.flow.has_value(),
           sensors.gps.has_value(),
           sensors.vision.has_value(),
           flown_vehicle(setup).battery.has_value(),
           WindModel<1>({setup.environment.wind}, 1, 0).windy()},
      rows_(rows) {
  table_.about = {{"vehicle", flown_vehicle(setup).name},
                  {"mission", setup.mission.name},
                  {"controller", name_of(setup.controller)},
                  {"estimator", setup.estimator == EstimatorKind::own ? setup.own_estimator.name
                                                                      : to_string(setup.estimator)},
                  {"sensors", setup.real_sensors ? "real" : "ideal"},
                  {"flow", to_string(setup.flow)},
                  {"solver", to_string(setup.integrator)},
                  {"step_s", fmt::format("{}", setup.step)},
                  {"control_period_s", fmt::format("{}", control_period(setup))},
                  {"seed", fmt::format("{}", setup.seed)},
                  {"flight", fmt::format("{}", setup.flight)}};
  const auto numbered = [&](const std::string& group, const std::string& letter) {
    for (int i = 1; i <= rotors; ++i) column(fmt::format("{}.{}{}", group, letter, i), "rad/s");
  };
  column("t", "s");
  columns("x", {{"px", "m"},
                {"py", "m"},
                {"pz", "m"},
                {"qw", "1"},
                {"qx", "1"},
                {"qy", "1"},
                {"qz", "1"},
                {"u", "m/s"},
                {"v", "m/s"},
                {"w", "m/s"},
                {"p", "rad/s"},
                {"q", "rad/s"},
                {"r", "rad/s"},
                {"roll", "rad"},
                {"pitch", "rad"},
                {"yaw", "rad"}});
  numbered("x", "w");
  columns("estimate", {{"px", "m"},
                       {"py", "m"},
                       {"pz", "m"},
                       {"roll", "rad"},
                       {"pitch", "rad"},
                       {"yaw", "rad"},
                       {"u", "m/s"},
                       {"v", "m/s"},
                       {"w", "m/s"},
                       {"p", "rad/s"},
                       {"q", "rad/s"},
                       {"r", "rad/s"}});
  columns("reference", {{"px", "m"},
                        {"py", "m"},
                        {"pz", "m"},
                        {"vx", "m/s"},
                        {"vy", "m/s"},
                        {"vz", "m/s"},
                        {"roll", "rad"},
                        {"pitch", "rad"},
                        {"yaw", "rad"},
                        {"track_position", "1"},
                        {"phase", "1"}});
  columns("command", {{"T", "N"}, {"tau_x", "N m"}, {"tau_y", "N m"}, {"tau_z", "N m"}});
  columns("made", {{"T", "N"}, {"tau_x", "N m"}, {"tau_y", "N m"}, {"tau_z", "N m"}});
  numbered("command", "w");
  if (has_.accelerometer)
    columns("accelerometer", {{"x", "m/s^2"}, {"y", "m/s^2"}, {"z", "m/s^2"}});
  if (has_.gyroscope) columns("gyroscope", {{"x", "rad/s"}, {"y", "rad/s"}, {"z", "rad/s"}});
  if (has_.magnetometer) columns("magnetometer", {{"x", "uT"}, {"y", "uT"}, {"z", "uT"}});
  if (has_.barometer) column("barometer", "Pa");
  if (has_.sonar) column("sonar", "m");
  if (has_.flow) columns("flow", {{"x", "rad/s"}, {"y", "rad/s"}});
  if (has_.gps)
    columns("gps",
            {{"px", "m"}, {"py", "m"}, {"pz", "m"}, {"vx", "m/s"}, {"vy", "m/s"}, {"vz", "m/s"}});
  if (has_.vision) columns("vision", {{"px", "m"}, {"py", "m"}, {"pz", "m"}});
  if (has_.battery) columns("battery", {{"voltage", "V"}, {"current", "A"}, {"charge", "A s"}});
  if (has_.wind) columns("wind", {{"north", "m/s"}, {"east", "m/s"}, {"down", "m/s"}});
}

void FlightRecorder::column(const std::string& name, const std::string& unit) {
  table_.columns.push_back({name, unit, {}});
  table_.columns.back().values.reserve(rows_);
}

void FlightRecorder::columns(const std::string& group,
                             const std::vector<std::pair<std::string, std::string>>& names) {
  for (const auto& [name, unit] : names) column(fmt::format("{}.{}", group, name), unit);
}

LogTable FlightRecorder::table(const std::vector<LogEvent>& events) {
  table_.events = events;
  return table_;
}

}  // namespace quadtune::internal
