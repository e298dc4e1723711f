// SPDX-License-Identifier: Apache-2.0
// Documented properties of the parameters of each firmware's loops. Names are those in parameter
// files; sources in docs/bibliography.md, "Firmware".
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "firmware/firmware_parts.hpp"
#include "quadtune/exports/firmware.hpp"

namespace quadtune {
namespace {

constexpr double kOfVehicle = std::numeric_limits<double>::quiet_NaN();
constexpr int kMaxRotors = 12;
using Bound = std::optional<double>;

class Table {
 public:
  void add(std::string name, double usual, Bound min = {}, Bound max = {}, std::string unit = "") {
    ParameterFacts facts;
    facts.name = std::move(name);
    facts.usual = usual;
    facts.min = min;
    facts.max = max;
    facts.unit = std::move(unit);
    all.push_back(std::move(facts));
  }
  void add_integer(std::string name, double usual, Bound min, Bound max, std::string unit = "") {
    add(std::move(name), usual, min, max, std::move(unit));
    all.back().integer = true;
  }
  /// Adds a limit or a filter, which a design does not change.
  void add_limit(const std::string& name, double usual, Bound min, Bound max, std::string unit) {
    add(name, usual, min, max, std::move(unit));
    read_only();
  }
  /// Marks the last parameter as part of the vehicle's setup: read but never written.
  void read_only() { all.back().read_only = true; }

  std::vector<ParameterFacts> all;
};

void add_px4_rate(Table& t, const std::string& axis, double P, double P_min, double P_max, double I,
                  double D, Bound D_max, double K_min) {
  const std::string name = "MC_" + axis + "RATE_";
  t.add(name + "P", P, P_min, P_max);
  t.add(name + "I", I, 0);
  t.add(name + "D", D, 0, D_max);
  t.add(name + "FF", 0, 0);
  t.add(name + "K", 1, K_min, 5);
}

std::vector<ParameterFacts> px4_facts(const Firmware& firmware) {
  const double attitude = exports::is_from(firmware, "1.17") ? 4.0 : 6.5;
  Table t;
  t.add("MC_ROLL_P", attitude, 0, 12);
  add_px4_rate(t, "ROLL", 0.15, 0.01, 0.5, 0.2, 0.003, 0.01, 0.01);
  t.add("MC_PITCH_P", attitude, 0, 12);
  add_px4_rate(t, "PITCH", 0.15, 0.01, 0.6, 0.2, 0.003, {}, 0.01);
  t.add("MC_YAW_P", 2.8, 0, 5);
  add_px4_rate(t, "YAW", 0.2, 0, 0.6, 0.1, 0, {}, 0);
  if (exports::is_from(firmware, "1.16")) t.add("MC_YAW_TQ_CUTOFF", 2, 0, 10, "Hz");
  t.add("MPC_XY_P", 0.95, 0, 2);
  t.add("MPC_XY_VEL_P_ACC", 1.8, 1.2, 5);
  t.add("MPC_XY_VEL_I_ACC", 0.4, 0, 60);
  t.add("MPC_XY_VEL_D_ACC", 0.2, 0.1, 2);
  t.add("MPC_Z_P", 1.0, exports::is_from(firmware, "1.15") ? 0.1 : 0, 1.5);
  t.add("MPC_Z_VEL_P_ACC", 4, 2, 15);
  t.add("MPC_Z_VEL_I_ACC", 2, 0.2, 3);
  t.add("MPC_Z_VEL_D_ACC", 0, 0, 2);
  t.add("MPC_THR_HOVER", 0.5, 0.1, 0.8);
  t.add("THR_MDL_FAC", 0, 0, 1);
  t.add_integer("CA_ROTOR_COUNT", kOfVehicle, 0, kMaxRotors);
  for (int i = 0; i < kMaxRotors; ++i) {
    const std::string name = fmt::format("CA_ROTOR{}_", i);
    t.add(name + "PX", kOfVehicle, -100, 100, "m");
    t.add(name + "PY", kOfVehicle, -100, 100, "m");
    t.add(name + "KM", kOfVehicle, -1, 1);
  }
  t.add("IMU_GYRO_CUTOFF", 40, 0, 1000, "Hz");
  t.read_only();
  const std::pair<const char*, double> rates[] = {
      {"MC_ROLLRATE_MAX", 220}, {"MC_PITCHRATE_MAX", 220}, {"MC_YAWRATE_MAX", 200}};
  for (const auto& [name, usual] : rates) t.add_limit(name, usual, 0, 1800, "deg/s");
  for (const char* name : {"MC_RR_INT_LIM", "MC_PR_INT_LIM", "MC_YR_INT_LIM"})
    t.add_limit(name, 0.3, 0, {}, "");
  t.add_limit("MPC_XY_VEL_MAX", 12, 0, 20, "m/s");
  t.add_limit("MPC_Z_VEL_MAX_UP", 3, 0.5, 8, "m/s");
  t.add_limit("MPC_Z_VEL_MAX_DN", 1.5, 0.5, 4, "m/s");
  t.add_limit("MPC_TILTMAX_AIR", 45, 20, 89, "deg");
  t.add("IMU_DGYRO_CUTOFF", exports::is_from(firmware, "1.17") ? 20 : 30, 0, 1000, "Hz");
  t.read_only();
  t.add_integer("IMU_GYRO_RATEMAX", 800, 100, 2000, "Hz");
  t.read_only();
  t.add("EKF2_GYR_NOISE", 0.015, 0.0001, 0.1, "rad/s");
  t.add("EKF2_ACC_NOISE", 0.35, 0.01, 1, "m/s^2");
  t.add("EKF2_GYR_B_NOISE", 0.001, 0, 0.01, "rad/s^2");
  t.add("EKF2_ACC_B_NOISE", 0.003, 0, 0.01, "m/s^3");
  t.add("EKF2_BARO_NOISE", 3.5, 0.01, 15, "m");
  t.add("EKF2_RNG_NOISE", 0.1, 0.01, {}, "m");
  t.add("EKF2_GPS_P_NOISE", 0.5, 0.01, 10, "m");
  t.add("EKF2_GPS_V_NOISE", 0.3, 0.01, 5, "m/s");
  t.add("EKF2_HEAD_NOISE", 0.3, 0.01, 1, "rad");
  t.add("EKF2_OF_N_MIN", 0.15, 0.05, {}, "rad/s");
  t.add("EKF2_EVP_NOISE", 0.1, 0.01, {}, "m");
  return std::move(t.all);
}

void add_ardupilot_rate(Table& t, const std::string& axis, bool yaw) {
  const std::string name = "ATC_RAT_" + axis + "_";
  t.add(name + "P", yaw ? 0.18 : 0.135, yaw ? 0.1 : 0.01, yaw ? 2.5 : 0.5);
  t.add(name + "I", yaw ? 0.018 : 0.135, 0.01, yaw ? 1 : 2);
  t.add(name + "D", yaw ? 0 : 0.0036, 0, yaw ? 0.02 : 0.05);
  t.add(name + "FF", 0, 0, 0.5);
  t.add(name + "FLTE", yaw ? 2.5 : 0, 0, yaw ? 20 : 100, "Hz");
  t.add(name + "FLTD", 20, 5, 100, "Hz");
  t.read_only();
  t.add(name + "FLTT", 20, 5, 100, "Hz");
  t.read_only();
}

std::vector<ParameterFacts> ardupilot_facts(const Firmware& firmware) {
  const bool renamed = exports::is_from(firmware, "4.7");
  Table t;
  for (const auto& [axis, yaw] : {std::pair("RLL", false), {"PIT", false}, {"YAW", true}}) {
    t.add(fmt::format("ATC_ANG_{}_P", axis), 4.5, 3, 12);
    add_ardupilot_rate(t, axis, yaw);
  }
  if (renamed) {
    t.add("PSC_NE_POS_P", 1, 0.5, 4);
    t.add("PSC_NE_VEL_P", 2, 0.1, 10);
    t.add("PSC_NE_VEL_I", 1, 0.1, 10);
    t.add("PSC_NE_VEL_D", 0.25, 0, 1);
    t.add("PSC_D_POS_P", 1, 0.5, 4);
    t.add("PSC_D_VEL_P", 5, 1, 10);
    t.add("PSC_D_VEL_I", 0, 0, 10);
    t.add("PSC_D_VEL_D", 0, 0, 1);
    t.add("PSC_D_ACC_P", 0.05, 0.01, 0.25);
    t.add("PSC_D_ACC_I", 0.1, 0, 0.5);
  } else {
    t.add("PSC_POSXY_P", 1, 0.5, 2);
    t.add("PSC_VELXY_P", 2, 0.1, 6);
    t.add("PSC_VELXY_I", 1, 0.02, 1);
    t.add("PSC_VELXY_D", 0.5, 0, 1);
    t.add("PSC_POSZ_P", 1, 1, 3);
    t.add("PSC_VELZ_P", 5, 1, 8);
    t.add("PSC_VELZ_I", 0, 0.02, 1);
    t.add("PSC_VELZ_D", 0, 0, 1);
    t.add("PSC_ACCZ_P", 0.5, 0.2, 1.5);
    t.add("PSC_ACCZ_I", 1, 0, 3);
  }
  t.add("MOT_THST_HOVER", 0.35, 0.2, 0.8);
  t.add("MOT_THST_EXPO", 0.65, -1, 1);
  t.add("MOT_SPIN_MIN", 0.15, 0, 0.3);
  t.add("MOT_SPIN_MAX", 0.95, 0.9, 1);
  for (const char* axis : {"RLL", "PIT", "YAW"})
    t.add_limit(fmt::format("ATC_RAT_{}_IMAX", axis), 0.5, 0, 1, "");
  // Up to 4.6, lengths are in cm and angles in hundredths of a degree.
  const double cm = renamed ? 0.01 : 1;
  t.add_limit(renamed ? "PSC_NE_VEL_IMAX" : "PSC_VELXY_IMAX", 1000 * cm, 0, 4500 * cm, "");
  t.add_limit(renamed ? "ATC_ANGLE_MAX" : "ANGLE_MAX", renamed ? 30 : 3000, renamed ? 10 : 1000,
              renamed ? 80 : 8000, "");
  for (const char* name : {"FRAME_CLASS", "FRAME_TYPE"}) {
    t.add_integer(name, kOfVehicle, 0, {});
    t.read_only();
  }
  for (const char* suffix : {"_FLTE", "_FLTD"})
    for (const char* loop :
         renamed ? std::array{"PSC_NE_VEL", "PSC_D_VEL"} : std::array{"PSC_VELXY", "PSC_VELZ"})
      t.add_limit(std::string(loop) + suffix, 5, 0, 100, "Hz");
  t.add_limit(renamed ? "PSC_D_ACC_FLTE" : "PSC_ACCZ_FLTE", 20, 0, 100, "Hz");
  t.add("INS_GYRO_FILTER", 20, 0, 256, "Hz");
  t.read_only();
  t.add_integer("SCHED_LOOP_RATE", 400, 50, 2000, "Hz");
  t.read_only();
  t.add("EK3_GYRO_P_NSE", 0.015, 0.0001, 0.1, "rad/s");
  t.add("EK3_ACC_P_NSE", 0.35, 0.01, 1, "m/s^2");
  t.add("EK3_GBIAS_P_NSE", 0.001, 1e-5, 1e-3, "rad/s^2");
  t.add("EK3_ABIAS_P_NSE", 0.02, 1e-5, 0.02, "m/s^3");
  t.add("EK3_ALT_M_NSE", 2, 0.1, 100, "m");
  t.add("EK3_RNG_M_NSE", 0.5, 0.1, 10, "m");
  t.add("EK3_POSNE_M_NSE", 0.5, 0.1, 10, "m");
  t.add("EK3_VELNE_M_NSE", 0.3, 0.05, 5, "m/s");
  t.add("EK3_VELD_M_NSE", 0.5, 0.05, 5, "m/s");
  t.add("EK3_YAW_M_NSE", 0.5, 0.05, 1, "rad");
  t.add("EK3_FLOW_M_NSE", 0.25, 0.05, 1, "rad/s");
  return std::move(t.all);
}

std::vector<ParameterFacts> betaflight_facts(const Firmware& firmware) {
  const bool renamed = exports::is_from(firmware, "2025.12");
  Table t;
  t.add_integer("angle_p_gain", 50, 0, 200);
  const struct {
    const char* axis;
    int P, I, D, F, D_min, D_max;
  } axes[] = {{"roll", 45, 80, 40, 120, 30, 40},
              {"pitch", 47, 84, 46, 125, 34, 46},
              {"yaw", 45, 80, 0, 120, 0, 0}};
  for (const auto& axis : axes) {
    // From 2025.12 on, d_ is the gain at rest and d_max_ the maximum to which it is raised; before,
    // d_ was the maximum and d_min_ the gain at rest.
    t.add_integer(fmt::format("p_{}", axis.axis), axis.P, 0, 250);
    t.add_integer(fmt::format("i_{}", axis.axis), axis.I, 0, 250);
    t.add_integer(fmt::format("d_{}", axis.axis), renamed ? axis.D_min : axis.D, 0, 250);
    t.add_integer(fmt::format("f_{}", axis.axis), axis.F, 0, 1000);
    t.add_integer(fmt::format("{}_{}", renamed ? "d_max" : "d_min", axis.axis),
                  renamed ? axis.D_max : axis.D_min, 0, 250);
  }
  const std::pair<const char*, int> limits[] = {
      {"pidsum_limit", 500}, {"pidsum_limit_yaw", 400}, {"iterm_limit", 400}};
  for (const auto& [name, usual] : limits) {
    t.add_integer(name, usual, 0, 1000);
    t.read_only();
  }
  t.add_integer("yaw_lowpass_hz", 100, 0, 500, "Hz");
  t.read_only();
  t.add_integer("tpa_rate", 65, 0, 100);
  t.add_integer("anti_gravity_gain", 80, 0, 250);
  for (const auto& [name, usual] : {std::pair("dterm_lpf1_static_hz", 75),
                                    {"dterm_lpf2_static_hz", 150},
                                    {"gyro_lpf1_static_hz", 250},
                                    {"gyro_lpf1_dyn_min_hz", 250},
                                    {"dterm_lpf1_dyn_min_hz", 75},
                                    {"gyro_lpf2_static_hz", 500}}) {
    t.add_integer(name, usual, 0, 1000, "Hz");
    t.read_only();
  }
  return std::move(t.all);
}

std::vector<ParameterFacts> crazyflie_facts(const Firmware& firmware) {
  const bool brushless = firmware.setup == "brushless";
  Table t;
  const auto add = [&](const std::string& prefix, double kp, double ki, double kd,
                       const char* names[4]) {
    t.add(prefix + names[0], kp);
    t.add(prefix + names[1], ki);
    t.add(prefix + names[2], kd);
    t.add(prefix + names[3], 0);
  };
  const char* small[] = {"_kp", "_ki", "_kd", "_kff"};
  const char* velocity[] = {"Kp", "Ki", "Kd", "KFF"};
  const char* position[] = {"Kp", "Ki", "Kd", "Kff"};
  for (const char* axis : {"roll", "pitch"}) {
    add(fmt::format("pid_attitude.{}", axis), 6, 3, 0, small);
    add(fmt::format("pid_rate.{}", axis), brushless ? 200 : 250, brushless ? 400 : 500, 2.5, small);
  }
  add("pid_attitude.yaw", 6, 1, 0.35, small);
  add("pid_rate.yaw", 120, 16.7, 0, small);
  for (const char* axis : {"x", "y"}) {
    add(fmt::format("posCtlPid.{}", axis), 2, 0, 0, position);
    add(fmt::format("velCtlPid.v{}", axis), 25, 1, 0, velocity);
  }
  add("posCtlPid.z", 2, 0.5, 0, position);
  add("velCtlPid.vz", 25, 15, 0, velocity);
  t.add_integer("posCtlPid.thrustBase", brushless ? 30000 : 36000, 0, 65535);
  t.add_integer("posCtlPid.thrustMin", 20000, 0, 65535);
  for (const char* name : {"xVelMax", "yVelMax", "zVelMax"})
    t.add_limit(std::string("posCtlPid.") + name, 1, 0, {}, "m/s");
  for (const char* name : {"rLimit", "pLimit"})
    t.add_limit(std::string("posCtlPid.") + name, 20, 0, {}, "deg");
  t.add("kalman.pNAcc_xy", 0.5, {}, {}, "m/s^2");
  t.add("kalman.pNAcc_z", 1, {}, {}, "m/s^2");
  t.add("kalman.mNGyro_rollpitch", 0.1, {}, {}, "rad/s");
  t.add("kalman.mNGyro_yaw", 0.1, {}, {}, "rad/s");
  t.add("kalman.mNBaro", 2, {}, {}, "m");
  return std::move(t.all);
}

}  // namespace

std::vector<ParameterFacts> parameter_facts(const Firmware& firmware) {
  switch (firmware.kind) {
    case FirmwareKind::px4:
      return px4_facts(firmware);
    case FirmwareKind::ardupilot:
      return ardupilot_facts(firmware);
    case FirmwareKind::betaflight:
      return betaflight_facts(firmware);
    case FirmwareKind::crazyflie:
      return crazyflie_facts(firmware);
  }
  return {};
}

ParameterValues::ParameterValues(const Firmware& firmware, const std::vector<Parameter>& values) {
  for (const ParameterFacts& facts : parameter_facts(firmware)) {
    all_.push_back({facts.name, facts.usual});
    for (const Parameter& given : values)
      if (given.name == facts.name) all_.back().value = given.value;
  }
}

bool ParameterValues::has(std::string_view name) const {
  return std::any_of(all_.begin(), all_.end(),
                     [&](const Parameter& one) { return one.name == name; });
}

double ParameterValues::operator()(std::string_view name) const {
  return std::find_if(all_.begin(), all_.end(),
                      [&](const Parameter& one) { return one.name == name; })
      ->value;
}

}  // namespace quadtune
