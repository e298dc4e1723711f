// SPDX-License-Identifier: Apache-2.0
// Converts parameters to loops in SI units. docs/theory.md, "Cascades of autopilots".
#include <fmt/format.h>

#include "firmware/firmware_parts.hpp"
#include "quadtune/exports/firmware.hpp"
#include "quadtune/exports/firmware_filters.hpp"

namespace quadtune {
namespace {

using exports::kDegrees;
using exports::kStandardGravity;
using exports::kTurns;

class Loops {
 public:
  FirmwareLoop& of(CascadeAxis axis, double scale) {
    FirmwareLoop& loop = all[index_of(axis)];
    loop.scale = scale;
    return loop;
  }
  std::vector<FirmwareLoop> all = [] {
    std::vector<FirmwareLoop> loops(kCascadeAxes);
    for (const CascadeAxis axis : kAllCascadeAxes) loops[index_of(axis)].axis = axis;
    return loops;
  }();
};

void add_px4_loops(const FirmwareScale& scale, const ParameterValues& value, Loops& loops) {
  for (const exports::TurnWords& turn : kTurns) {
    FirmwareLoop& loop = loops.of(turn.axis, scale.torque[turn.index]);
    const std::string rate = fmt::format("MC_{}RATE_", turn.px4);
    const double K = value(rate + "K");
    loop.outer = value(fmt::format("MC_{}_P", turn.px4));
    loop.P = K * value(rate + "P");
    loop.I = K * value(rate + "I");
    loop.D = K * value(rate + "D");
    loop.forward = value(rate + "FF");
  }
  const auto velocity = [&](CascadeAxis axis, double of_output, const std::string& name) {
    FirmwareLoop& loop = loops.of(axis, of_output);
    loop.outer = value(name + "P");
    loop.P = value(name + "VEL_P_ACC");
    loop.I = value(name + "VEL_I_ACC");
    loop.D = value(name + "VEL_D_ACC");
  };
  // Acceleration is converted to tilt by the standard gravity, and to thrust by the hover thrust.
  velocity(CascadeAxis::x, 1 / kStandardGravity, "MPC_XY_");
  velocity(CascadeAxis::y, 1 / kStandardGravity, "MPC_XY_");
  velocity(CascadeAxis::altitude, scale.thrust * scale.hover / kStandardGravity, "MPC_Z_");
}

void add_ardupilot_loops(const Firmware& firmware, const FirmwareScale& scale,
                         const ParameterValues& value, Loops& loops) {
  for (const exports::TurnWords& turn : kTurns) {
    FirmwareLoop& loop = loops.of(turn.axis, scale.torque[turn.index]);
    const std::string rate = fmt::format("ATC_RAT_{}_", turn.ardupilot);
    loop.outer = value(fmt::format("ATC_ANG_{}_P", turn.ardupilot));
    loop.P = value(rate + "P");
    loop.I = value(rate + "I");
    loop.D = value(rate + "D");
    loop.of_error = true;
    loop.forward = value(rate + "FF");
  }
  const exports::ArdupilotNames names = exports::ardupilot_names(firmware);
  const auto velocity = [&](CascadeAxis axis, double of_output, const std::string& position,
                            const std::string& name) {
    FirmwareLoop& loop = loops.of(axis, of_output);
    loop.outer = value(position + "P");
    loop.P = value(name + "P");
    loop.I = value(name + "I");
    loop.D = value(name + "D");
    loop.of_error = true;
  };
  velocity(CascadeAxis::x, 1 / kStandardGravity, names.horizontal_position,
           names.horizontal_velocity);
  velocity(CascadeAxis::y, 1 / kStandardGravity, names.horizontal_position,
           names.horizontal_velocity);
  // The acceleration loop is assumed to be ideal.
  velocity(CascadeAxis::altitude, scale.mass, names.vertical_position, names.vertical_velocity);
}

void add_betaflight_loops(const Firmware& firmware, const FirmwareScale& scale,
                          const ParameterValues& value, Loops& loops) {
  const bool renamed = exports::is_from(firmware, "2025.12");
  for (const exports::TurnWords& turn : kTurns) {
    const std::string axis = turn.small;
    FirmwareLoop& loop = loops.of(turn.axis, scale.torque[turn.index]);
    const bool yaw = turn.axis == CascadeAxis::yaw;
    if (!yaw) loop.outer = value("angle_p_gain") / 10;
    loop.P = exports::kBetaflightP * value("p_" + axis);
    loop.I = exports::kBetaflightI * (yaw ? exports::kBetaflightYaw : 1) * value("i_" + axis);
    double D = value("d_" + axis);
    if (!renamed && value("d_min_" + axis) > 0) D = value("d_min_" + axis);
    loop.D = exports::kBetaflightD * D;
  }
  for (const CascadeAxis axis : {CascadeAxis::x, CascadeAxis::y, CascadeAxis::altitude})
    loops.of(axis, 0).flies = false;
}

void add_crazyflie_loops(const FirmwareScale& scale, const ParameterValues& value, Loops& loops) {
  const auto cascade = [&](CascadeAxis axis, double of_output, const std::string& outer,
                           const std::string& inner, const char* mark) {
    FirmwareLoop& loop = loops.of(axis, of_output);
    const std::string kp = fmt::format("{}p", mark), ki = fmt::format("{}i", mark),
                      kd = fmt::format("{}d", mark);
    loop.outer = value(outer + kp);
    loop.outer_integral = value(outer + ki);
    loop.outer_derivative = value(outer + kd);
    loop.P = value(inner + kp);
    loop.I = value(inner + ki);
    loop.D = value(inner + kd);
    loop.forward = value(inner + (*mark == 'K' ? "KFF" : "kff"));
  };
  for (const exports::TurnWords& turn : kTurns)
    cascade(turn.axis, scale.torque[turn.index] * kDegrees,
            fmt::format("pid_attitude.{}_", turn.small), fmt::format("pid_rate.{}_", turn.small),
            "k");
  cascade(CascadeAxis::x, 1 / kDegrees, "posCtlPid.x", "velCtlPid.vx", "K");
  cascade(CascadeAxis::y, 1 / kDegrees, "posCtlPid.y", "velCtlPid.vy", "K");
  cascade(CascadeAxis::altitude, scale.thrust * exports::kCrazyflieThrust, "posCtlPid.z",
          "velCtlPid.vz", "K");
}

}  // namespace

std::vector<FirmwareLoop> firmware_loops(const Firmware& firmware, const Vehicle& vehicle,
                                         const std::vector<Parameter>& values) {
  const FirmwareScale scale = firmware_scale(firmware, vehicle, values);
  const ParameterValues value(firmware, values);
  Loops loops;
  switch (firmware.kind) {
    case FirmwareKind::px4:
      add_px4_loops(scale, value, loops);
      break;
    case FirmwareKind::ardupilot:
      add_ardupilot_loops(firmware, scale, value, loops);
      break;
    case FirmwareKind::betaflight:
      add_betaflight_loops(firmware, scale, value, loops);
      break;
    case FirmwareKind::crazyflie:
      add_crazyflie_loops(scale, value, loops);
      break;
  }
  for (FirmwareLoop& loop : loops.all)
    loop.derivative_filter = internal::derivative_time(firmware, loop.axis, value);
  return std::move(loops.all);
}

double cascade_sign(CascadeAxis axis) { return axis == CascadeAxis::x ? -1 : 1; }

CascadeGains cascade_of(const std::vector<FirmwareLoop>& loops, const CascadeGains& pilot,
                        double dt) {
  CascadeGains gains;
  gains.dt = dt;
  for (const FirmwareLoop& one : loops) {
    PidLoop loop = cascade_loop(one.axis);
    if (one.flies) {
      const double sign = cascade_sign(one.axis);
      loop.Kp = sign * one.Kp();
      loop.Ki = sign * one.Ki();
      loop.Kd = -sign * one.Kd();
      if (one.derivative() > 0 && one.Kd() > 0) {
        loop.rate_lead = one.derivative() / one.Kd();
        loop.rate_filter = one.derivative_filter;
      }
    } else {
      for (const PidLoop& own : pilot.loops)
        if (own.name == loop.name) loop = own;
    }
    gains.loops.push_back(loop);
  }
  return gains;
}

}  // namespace quadtune
