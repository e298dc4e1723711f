// SPDX-License-Identifier: Apache-2.0
#include "estimation/own_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "logs/log_titles.hpp"
#include "quadtune/estimation/angles.hpp"
#include "quadtune/estimation/mambo_estimator.hpp"
#include "quadtune/model/rotation.hpp"

namespace quadtune::internal {
namespace {

using Values = std::vector<double>;
using Vector3d = Eigen::Vector3d;

/// [m/s²], the value that the estimators on board use.
constexpr double kGravity = 9.81;
constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

bool has_channel(const std::vector<LogGroup>& groups, const std::string& name) {
  return std::any_of(groups.begin(), groups.end(), [&](const LogGroup& group) {
    return std::any_of(
        group.channels.begin(), group.channels.end(),
        [&](const LogChannel& channel) { return full_name(group, channel) == name; });
  });
}

OwnSignal as_it_is(const std::string& channel, const std::string& unit, double sign = 1) {
  return {(sign < 0 ? "-" : "") + channel, {channel}, unit, [sign](const Values& of) {
            return sign * of[0];
          }};
}

const std::vector<std::string> kForce = {"accelerometer.x", "accelerometer.y", "accelerometer.z"};
const std::vector<std::string> kAngles = {"estimate.roll", "estimate.pitch", "estimate.yaw"};

std::vector<std::string> joined(std::vector<std::string> first,
                                const std::vector<std::string>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

Vector3d three(const Values& of, std::size_t from) {
  return {of[from], of[from + 1], of[from + 2]};
}

Eigen::Matrix3d attitude(const Values& of, std::size_t from) {
  return rotation_of_euler(of[from], of[from + 1], of[from + 2]);
}

/// Acceleration without gravity, in world axes, computed with the attitude estimate on board.
OwnSignal acceleration(int axis) {
  return {fmt::format("accelerometer.* along world {}", kAxes[static_cast<std::size_t>(axis)]),
          joined(kForce, kAngles), "m/s^2", [axis](const Values& of) {
            const double felt = (attitude(of, 3) * three(of, 0))(axis);
            return axis == 2 ? felt + kGravity : felt;
          }};
}

/// Horizontal velocity computed from the optical flow, as on board.
OwnSignal flow_velocity(int axis) {
  return {fmt::format("flow.* as velocity along world {}", kAxes[static_cast<std::size_t>(axis)]),
          joined({"flow.x", "flow.y", "gyroscope.x", "gyroscope.y", "estimate.pz", "estimate.u",
                  "estimate.v", "estimate.w"},
                 kAngles),
          "m/s", [axis](const Values& of) {
            const Eigen::Matrix3d R = attitude(of, 8);
            const Eigen::Vector2d flow(of[0] + of[3], of[1] - of[2]);
            return velocity_of_flow<double>(flow, -of[4], (R * three(of, 5)).z(), R)(axis);
          }};
}

OwnSignal tilt() {
  return {"accelerometer.* as roll", kForce, "rad",
          [](const Values& of) { return tilt_from_force<double>(three(of, 0)).roll; }};
}

/// Axis in the name of a signal, e.g. 0 for "gyro_x" with the prefix "gyro_"; -1 for other names.
int axis_of(const std::string& signal, const std::string& prefix) {
  for (int i = 0; i < 3; ++i)
    if (signal == prefix + kAxes[static_cast<std::size_t>(i)]) return i;
  return -1;
}

}  // namespace

bool is_own_log(const std::vector<LogGroup>& groups) {
  return has_channel(groups, "x.qw") && has_channel(groups, "estimate.px") &&
         has_channel(groups, "reference.track_position") && has_channel(groups, "command.T");
}

bool has_z_up(const FilterModel& model) { return model.gravity && model.gravity->z() < 0; }

namespace {

/// Signals by name only, for any unit.
std::vector<OwnSignal> named(const std::string& signal, bool z_up) {
  const auto sign = [&](int axis) { return z_up && axis > 0 ? -1.0 : 1.0; };
  const auto axes = [&](const std::string& prefix, const std::string& group,
                        const std::string& unit, bool world) -> std::vector<OwnSignal> {
    const int axis = axis_of(signal, prefix);
    if (axis < 0) return {};
    return {as_it_is(group + kAxes[static_cast<std::size_t>(axis)], unit, world ? sign(axis) : 1)};
  };
  std::vector<OwnSignal> found;
  const auto add = [&found](const std::vector<OwnSignal>& more) {
    found.insert(found.end(), more.begin(), more.end());
  };
  add(axes("gyro_", "gyroscope.", "rad/s", false));
  add(axes("force_", "accelerometer.", "m/s^2", false));
  add(axes("f", "accelerometer.", "m/s^2", false));
  add(axes("", "gps.p", "m", true));
  add(axes("v", "gps.v", "m/s", true));
  add(axes("vision_", "vision.p", "m", true));
  if (!found.empty()) return found;
  if (signal.starts_with("speed_"))
    return {as_it_is("command.w" + signal.substr(std::string("speed_").size()), "rad/s")};
  if (signal == "p") return {as_it_is("gyroscope.x", "rad/s")};
  if (signal == "q") return {as_it_is("gyroscope.y", "rad/s")};
  if (signal == "r") return {as_it_is("gyroscope.z", "rad/s")};
  if (signal == "rate") return {as_it_is("gyroscope.x", "rad/s")};
  if (signal == "tilt") return {tilt()};
  if (signal == "height") return {as_it_is("sonar", "m")};
  if (signal == "position")
    return {as_it_is("gps.px", "m"), as_it_is("vision.px", "m"), as_it_is("sonar", "m")};
  if (signal == "ax") return {acceleration(0)};
  if (signal == "ay") return {acceleration(1)};
  if (signal == "az") return {acceleration(2)};
  if (signal == "flow_vx") return {flow_velocity(0)};
  if (signal == "flow_vy") return {flow_velocity(1)};
  return {};
}

}  // namespace

std::vector<OwnSignal> own_signals(const Signal& signal, bool z_up) {
  std::vector<OwnSignal> found = named(signal.name, z_up);
  std::erase_if(found, [&](const OwnSignal& own) {
    return common_unit(own.unit) != common_unit(signal.unit);
  });
  return found;
}

const OwnSignal* first_that_is_there(const std::vector<OwnSignal>& signals,
                                     const std::vector<LogGroup>& groups) {
  for (const OwnSignal& signal : signals)
    if (std::all_of(signal.channels.begin(), signal.channels.end(),
                    [&](const std::string& channel) { return has_channel(groups, channel); }))
      return &signal;
  return nullptr;
}

bool may_be_anything(const Signal& signal, const LogChannel& channel, const LogGroup& group) {
  if (!signal.unit.empty() || signal.name.size() > 1) return false;
  if (!channel.unit.empty() || !group.name.empty()) return true;
  return axis_of(signal.name, "") >= 0 &&
         std::all_of(kAxes.begin(), kAxes.end(), [&](const char* axis) {
           return std::any_of(group.channels.begin(), group.channels.end(),
                              [&](const LogChannel& other) { return other.name == axis; });
         });
}

}  // namespace quadtune::internal
