// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/vehicle/new_vehicle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "quadtune/errors.hpp"
#include "quadtune/model/assumed_values.hpp"
#include "quadtune/model/inertia.hpp"

namespace quadtune {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInch = 0.0254;  // [m]
constexpr double kGravity = 9.81;
constexpr double kDensity = 1.225;
// Typical of propellers of small multirotors: T = C_T rho n^2 D^4, Q = C_P rho n^2 D^5 / (2 pi),
// with n in turns per second (Brandt and Selig 2011).
constexpr double kThrustCoefficient = 0.115;
constexpr double kPowerCoefficient = 0.05;
constexpr double kChordOfRadius = 0.18;
constexpr double kLiftSlope = 5.7;     // of a blade [1/rad]
constexpr double kProfileDrag = 0.02;  // of a blade
constexpr double kBodyOfMass = 0.71;   // share of the mass in the middle
constexpr double kBodyOfArm = 0.28;    // radius of the sphere over the arm
constexpr double kUsualThrustToWeight = 2;
constexpr double kInertiaSpread = 0.3, kMeasuredInertiaSpread = 0.1;
constexpr double kMassSpread = 0.02;
constexpr double kThrustSpread = 0.25, kMeasuredThrustSpread = 0.08;
constexpr double kSmallThrustSpread = 0.5;  // of propellers below 0.1 m, which vary more
constexpr double kLagSpread = 0.4, kMeasuredLagSpread = 0.15;

void require(bool holds, const char* option, const std::string& message) {
  if (!holds) throw OptionError(option, message);
}

void require_positive(double value, const char* option, double max, const char* unit) {
  require(value > 0 && value <= max, option,
          fmt::format("{} is {:.6g} {}, expected more than 0 and at most {} {}", option, value,
                      unit, max, unit));
}

void validate(const MeasuredVehicle& m) {
  require_positive(m.mass, "mass", 200, "kg");
  require_positive(m.arm, "arm", 5, "m");
  require_positive(m.propeller, "propeller", 3, "m");
  require(m.rotors == 4 || m.rotors == 6 || m.rotors == 8, "rotors",
          fmt::format("rotors is {}, expected 4, 6 or 8", m.rotors));
  require(m.blades >= 2 && m.blades <= 8, "blades",
          fmt::format("blades is {}, expected 2 to 8", m.blades));
  const double apart = 2 * m.arm * std::sin(kPi / m.rotors);  // [m], between neighbouring hubs
  require(m.propeller <= apart, "propeller",
          fmt::format(
              "propeller is {:.4g} m in diameter, expected at most {:.4g} m, the distance between "
              "neighbouring rotors with --arm {:.4g} m from the centre to the axis of a rotor",
              m.propeller, apart, m.arm));
  require(!(m.max_thrust && m.thrust_to_weight), "thrust-to-weight",
          "thrust-to-weight and --max-thrust are both given, expected one of them");
  require(!((m.max_thrust || m.thrust_to_weight) && m.max_speed && m.hover_speed), "hover-speed",
          "hover-speed, --max-speed and one of --max-thrust and --thrust-to-weight are all given, "
          "expected two of the three, which determine the thrust curve");
  if (m.hover_speed && m.max_speed)
    require(*m.max_speed > *m.hover_speed, "max-speed",
            fmt::format("max-speed is {:.6g} rad/s, expected more than the {:.6g} rad/s of "
                        "--hover-speed, because it is the speed at full command",
                        *m.max_speed, *m.hover_speed));
  if (m.thrust_to_weight)
    require(*m.thrust_to_weight > 1 && *m.thrust_to_weight <= 50, "thrust-to-weight",
            fmt::format("thrust-to-weight is {:.6g}, expected more than 1 and at most 50",
                        *m.thrust_to_weight));
  if (m.max_thrust)
    require(
        *m.max_thrust * m.rotors > m.mass * kGravity, "max-thrust",
        fmt::format("max-thrust is {:.4g} N for each of {} rotors, expected more than {:.4g} N, "
                    "one rotor's share of the weight of {:.4g} kg",
                    *m.max_thrust, m.rotors, m.mass * kGravity / m.rotors, m.mass));
  if (m.motor_lag)
    require(*m.motor_lag <= kMaxLag, "lag",
            fmt::format("lag is {:.4g} s, expected at most {} s", *m.motor_lag, kMaxLag));
  try {
    if (m.inertia) require_inertia(m.inertia->asDiagonal(), "inertia");
  } catch (const InvalidInput& error) {
    throw OptionError("inertia", error.message());
  }
}

/// Direction of rotor i from the centre, clockwise from ahead [rad].
double direction(const MeasuredVehicle& m, int i) {
  const double step = 2 * kPi / m.rotors;
  return step * i - (m.layout == FrameLayout::x ? step / 2 : 0);
}

/// -0 and what rounding leaves of 0 are 0.
double rounded(double x) { return std::abs(x) < 1e-12 ? 0 : x; }

std::string position(const MeasuredVehicle& m, int i) {
  const double angle = direction(m, i);
  return fmt::format("[{:.6g}, {:.6g}, 0]", rounded(m.arm * std::cos(angle)),
                     rounded(m.arm * std::sin(angle)));
}

/// "front left", as a pilot sees it.
std::string place(const MeasuredVehicle& m, int i) {
  const double x = std::cos(direction(m, i)), y = std::sin(direction(m, i));
  std::string words = x > 0.1 ? "front" : x < -0.1 ? "back" : "";
  if (std::abs(y) > 0.1)
    words += (words.empty() ? "" : " ") + std::string(y > 0 ? "right" : "left");
  return words;
}

/// Curve, speeds and airflow of the rotors, all alike.
struct RotorNumbers {
  double a2 = 0, d2 = 0;                ///< T = a2 w² [N s²/rad²], Q = d2 w² [N m s²/rad²]
  double max_speed = 0, min_speed = 0;  ///< [rad/s]
  double inertia = 0;                   ///< [kg m²]
  double lag_up = 0, lag_down = 0;      ///< [s]
  double drag = 0, inflow = 0;          ///< [N s²/(rad m)]
};

/// Theory: "Rigid body", blade elements in hover.
void add_airflow(const MeasuredVehicle& m, RotorNumbers& rotor) {
  const double r = m.propeller / 2;
  const double disc = kDensity * kPi * r * r;  // ρ A [kg/m]
  const double solidity = m.blades * kChordOfRadius / kPi;
  const double C = rotor.a2 / (disc * r * r);  // T = C ρ A (w r)²
  const double inflow_ratio = std::sqrt(C / 2);
  // C = (σ a/2) (θ/3 - λ/2)
  const double pitch = 3 * (2 * C / (solidity * kLiftSlope) + inflow_ratio / 2);
  rotor.drag = disc * solidity * r / 4 * (kProfileDrag + kLiftSlope * pitch * inflow_ratio);
  rotor.inflow =
      disc * solidity * kLiftSlope * r / 8 / (1 + kLiftSlope * solidity / (16 * inflow_ratio));
}

RotorNumbers rotor_numbers(const MeasuredVehicle& m) {
  const double D = m.propeller;
  const double share = m.mass * kGravity / m.rotors;  // thrust in hover [N]
  const double blades = std::pow(m.blades / 2.0, 0.75);
  RotorNumbers rotor;
  rotor.a2 = kThrustCoefficient * blades * kDensity * std::pow(D, 4) / (4 * kPi * kPi);
  std::optional<double> max_thrust = m.max_thrust;
  if (m.thrust_to_weight) max_thrust = *m.thrust_to_weight * share;
  if (m.hover_speed)
    rotor.a2 = share / (*m.hover_speed * *m.hover_speed);
  else if (m.max_speed && max_thrust)
    rotor.a2 = *max_thrust / (*m.max_speed * *m.max_speed);
  rotor.max_speed =
      m.max_speed.value_or(std::sqrt(max_thrust.value_or(kUsualThrustToWeight * share) / rotor.a2));
  rotor.min_speed = 0.12 * rotor.max_speed;
  // Q/T = (C_P / C_T) D / (2 pi)
  rotor.d2 = rotor.a2 * (kPowerCoefficient / kThrustCoefficient) * D / (2 * kPi);
  // A propeller and the bell of its motor, scaled from 9.4 inch: mass as D², inertia as D⁴.
  rotor.inertia = 6.2e-5 * std::pow(D / 0.2388, 4) * m.blades / 2.0;
  const double usual = m.brushed ? 0.06 : std::max(0.02, 0.004 * D / kInch);
  rotor.lag_up = m.motor_lag.value_or(usual);
  rotor.lag_down = std::min(1.3 * rotor.lag_up, kMaxLag);
  add_airflow(m, rotor);
  return rotor;
}

/// Units are easily mistaken: with a diameter in mm instead of inches, hover would need propellers
/// whose tips are faster than sound.
/// @throws OptionError  for the measured speed, or else for the propeller
void require_slow_tips(const MeasuredVehicle& m, const RotorNumbers& rotor) {
  constexpr double kSpeedOfSound = 340;  // [m/s]
  const double hover = std::sqrt(m.mass * kGravity / m.rotors / rotor.a2);
  const double tip = hover * m.propeller / 2;
  if (tip < kSpeedOfSound) return;
  const std::string tips = fmt::format(
      "tips at {:.4g} m/s, expected less than {} m/s, the speed of sound", tip, kSpeedOfSound);
  if (m.hover_speed)
    throw OptionError("hover-speed",
                      fmt::format("hover-speed is {:.4g} rad/s: propellers of {:.4g} m in diameter "
                                  "would turn with {}; check --hover-speed and --propeller",
                                  *m.hover_speed, m.propeller, tips));
  if (m.max_speed && (m.max_thrust || m.thrust_to_weight))
    throw OptionError(
        "max-speed",
        fmt::format("max-speed is {:.4g} rad/s: with {}, propellers of {:.4g} m in diameter that "
                    "carry {:.4g} kg would turn at {:.4g} rad/s with {}; check these options, "
                    "--propeller and --mass",
                    *m.max_speed, m.max_thrust ? "--max-thrust" : "--thrust-to-weight", m.propeller,
                    m.mass, hover, tips));
  throw OptionError(
      "propeller",
      fmt::format("propeller is {:.4g} m in diameter: to carry {:.4g} kg, {} of them would turn "
                  "at {:.4g} rad/s with {}; check the units of --propeller and --mass",
                  m.propeller, m.mass, m.rotors, hover, tips));
}

/// Whether thrust at a command is known, if only as a share of the largest.
bool thrust_is_measured(const MeasuredVehicle& m) {
  const int given = int{m.max_thrust || m.thrust_to_weight} + int{m.max_speed.has_value()} +
                    int{m.hover_speed.has_value()};
  return given >= 2;
}

Eigen::Vector3d estimated_inertia(const MeasuredVehicle& m) {
  std::vector<Sphere> parts = {{kBodyOfMass * m.mass, kBodyOfArm * m.arm}};
  for (int i = 0; i < m.rotors; ++i) {
    const double angle = direction(m, i);
    parts.push_back({(1 - kBodyOfMass) * m.mass / m.rotors, 0,
                     Eigen::Vector3d(m.arm * std::cos(angle), m.arm * std::sin(angle), 0)});
  }
  return mass_properties(parts).inertia.diagonal();
}

VehicleSpread spread_for(const MeasuredVehicle& m) {
  return {kMassSpread, m.inertia ? kMeasuredInertiaSpread : kInertiaSpread,
          thrust_is_measured(m) ? kMeasuredThrustSpread
          : m.propeller < 0.1   ? kSmallThrustSpread
                                : kThrustSpread,
          m.motor_lag ? kMeasuredLagSpread : kLagSpread};
}

std::vector<EstimatedNumber> estimates_of(const MeasuredVehicle& m, const RotorNumbers& rotor,
                                          const Eigen::Vector3d& inertia,
                                          const VehicleSpread& spread) {
  std::vector<EstimatedNumber> list;
  if (!m.inertia)
    list.push_back({"moment of inertia about body x", inertia.x(), "kg m2", spread.inertia,
                    "a sphere in the middle and point masses at the hubs",
                    "a swing test, then --inertia"});
  if (!m.hover_speed && !(m.max_speed && (m.max_thrust || m.thrust_to_weight)))
    list.push_back({"thrust over squared speed", rotor.a2, "N s2/rad2", spread.thrust,
                    "the coefficient of typical propellers of this diameter",
                    "the speed in hover from the speed controllers, then --hover-speed"});
  if (!m.max_thrust && !m.thrust_to_weight && !(m.max_speed && m.hover_speed))
    list.push_back({"maximum speed of a rotor", rotor.max_speed, "rad/s", 0,
                    m.max_speed ? "given" : "a thrust-to-weight ratio of 2",
                    "the thrust of one rotor on a scale, then --max-thrust"});
  if (!m.motor_lag)
    list.push_back({"motor lag", rotor.lag_up, "s", spread.motor_lag,
                    m.brushed ? "typical brushed motors" : "4 ms per inch of propeller",
                    "a log of the speed after a step of the command, then --lag"});
  return list;
}

/// "ESTIMATE, 30 %: …; measure it by …", or "measured".
std::string mark(bool measured, double spread, const std::string& source) {
  return measured ? "measured" : fmt::format("ESTIMATE within {:.0f} %: {}", 100 * spread, source);
}

std::string body_text(const MeasuredVehicle& m, const Eigen::Vector3d& inertia,
                      const VehicleSpread& spread) {
  const double front = 0.6 * m.arm * m.arm, above = m.arm * m.arm;
  return fmt::format(
      "[body]\nmass_kg = {:.6g}\n# {}\ninertia_kg_m2 = [{:.5g}, {:.5g}, {:.5g}]\n"
      "# ESTIMATE: the area seen along each axis, with a drag coefficient of 1\n"
      "drag_area_m2 = [{:.3g}, {:.3g}, {:.3g}]\n\n",
      m.mass,
      mark(m.inertia.has_value(), spread.inertia,
           "a sphere in the middle and point masses at the hubs"),
      inertia.x(), inertia.y(), inertia.z(), front, front, above);
}

std::string rotor_text(const MeasuredVehicle& m, const RotorNumbers& rotor,
                       const VehicleSpread& spread) {
  const bool curve = m.hover_speed || (m.max_speed && (m.max_thrust || m.thrust_to_weight));
  std::string text = fmt::format(
      "[rotor]\nradius_m = {:.5g}\nchord_m = {:.3g}                 # ESTIMATE\nblades = {}\n"
      "# {}\nthrust_a2_N_s2_per_rad2 = {:.5g}\n"
      "# ESTIMATE: {} of the thrust times the diameter\ntorque_d2_N_m_s2_per_rad2 = {:.5g}\n"
      "inertia_kg_m2 = {:.3g}            # ESTIMATE: propeller and bell of the motor\n"
      "# {}\nlag_up_s = {:.3g}\nlag_down_s = {:.3g}\n"
      "# ESTIMATE: blade elements\ndrag_N_s2_per_rad_m = {:.4g}\ninflow_N_s2_per_rad_m = {:.4g}\n"
      "# The ground effect is off: in the model the centre is at height 0 on the ground. On a "
      "vehicle with\n# landing gear the rotors are higher, so that the effect would be too large.\n"
      "ground_effect = false\n\n",
      m.propeller / 2, kChordOfRadius * m.propeller / 2, m.blades,
      mark(curve, spread.thrust, "the coefficient of typical propellers of this diameter"),
      rotor.a2, fmt::format("{:.3f}", rotor.d2 / (rotor.a2 * m.propeller)), rotor.d2, rotor.inertia,
      mark(m.motor_lag.has_value(), spread.motor_lag,
           m.brushed ? "typical brushed motors" : "4 ms per inch of propeller"),
      rotor.lag_up, rotor.lag_down, rotor.drag, rotor.inflow);
  text +=
      "# CHECK the spin of each rotor on the vehicle, seen from above: a wrong one makes yaw "
      "unstable.\n";
  for (int i = 0; i < m.rotors; ++i)
    text += fmt::format(
        "[[rotors]]                      # {}, {}\nposition_m = {}\nspin = \"{}\"\n\n", i + 1,
        place(m, i), position(m, i),
        to_string((i % 2 == 0) == (m.first_spin == Spin::clockwise) ? Spin::clockwise
                                                                    : Spin::counter_clockwise));
  return text;
}

std::string motor_text(const MeasuredVehicle& m, const RotorNumbers& rotor) {
  const char* source = m.max_speed ? "measured"
                       : m.max_thrust || m.thrust_to_weight
                           ? "from the largest thrust"
                           : "ESTIMATE: a thrust-to-weight ratio of 2";
  return fmt::format(
      "[motor]\ncommand = \"speed\"\nmin_rad_s = {:.4g}                 # ESTIMATE: idle\n"
      "max_rad_s = {:.5g}                # {}\ncommand_delay_s = 0.002         # ESTIMATE\n\n"
      "[flight]\ntakeoff_gain = 0.2\naltitude_thrust_fraction = {}\n\n",
      rotor.min_speed, rotor.max_speed, source, m.brushed ? 0.92 : 0.9);
}

constexpr char kInertialSensors[] =
    "# TYPICAL sensors of this class. Replace them with your own: docs/formats.md, [sensors].\n"
    "[sensors.accelerometer]\nrate_Hz = 400\ndelay_s = 0.002\nnoise_m_per_s2 = 0.1\n\n"
    "[sensors.gyroscope]\nrate_Hz = 400\ndelay_s = 0.002\nnoise_rad_per_s = 0.005\n\n"
    "[sensors.barometer]\nrate_Hz = 50\nnoise_Pa = 3\n\n";
constexpr char kGpsSensors[] =
    "[sensors.magnetometer]\nrate_Hz = 50\nnoise_uT = 0.5\n\n"
    "[sensors.gps]\nrate_Hz = 5\ndelay_s = 0.15\nnoise_m = [0.3, 0.3, 0.5]\n"
    "velocity_noise_m_per_s = 0.1\n\n";
constexpr char kFlowSensors[] =
    "[sensors.sonar]\nrate_Hz = 50\ndelay_s = 0.01\nnoise_m = 0.01\nleast_range_m = 0.02\n"
    "greatest_range_m = 4\n\n"
    "[sensors.flow]\nrate_Hz = 100\ndelay_s = 0.01\nnoise_rad_per_s = 0.03\n"
    "half_field_x_rad = 0.37\nhalf_field_y_rad = 0.37\nleast_height_m = 0.08\n\n";

std::string spread_text(const VehicleSpread& spread) {
  return fmt::format(
      "# Relative half widths of 95 % intervals. Campaigns draw from them, certify covers them.\n"
      "[spread]\nmass = {}\ninertia = {}\nthrust = {}\nmotor_lag = {}\n",
      spread.mass, spread.inertia, spread.thrust, spread.motor_lag);
}

}  // namespace

NewVehicle new_vehicle(const MeasuredVehicle& measured) {
  validate(measured);
  const RotorNumbers rotor = rotor_numbers(measured);
  require_slow_tips(measured, rotor);
  const Eigen::Vector3d inertia =
      measured.inertia ? *measured.inertia : estimated_inertia(measured);
  NewVehicle made;
  made.spread = spread_for(measured);
  made.text = fmt::format(
      "# Vehicle file of quadtune. Body axes: x forward, y right, z down, origin at the centre of "
      "mass.\n# Written by `quadtune vehicle new`. Numbers marked ESTIMATE were not measured.\n\n"
      "name = \"{}\"\ndescription = \"{} rotors, {} layout, {:.4g} kg\"\n"
      "source = \"measured with a scale and a ruler; estimates are marked\"\n\n"
      "[environment]\ngravity_m_per_s2 = {}\nair_density_kg_per_m3 = {}\n\n",
      measured.name, measured.rotors, measured.layout == FrameLayout::x ? "X" : "plus",
      measured.mass, kGravity, kDensity);
  made.text += body_text(measured, inertia, made.spread);
  made.text += rotor_text(measured, rotor, made.spread);
  made.text += motor_text(measured, rotor);
  made.text += kInertialSensors;
  made.text += measured.sensors == SensorSet::gps ? kGpsSensors : kFlowSensors;
  made.text += spread_text(made.spread);
  made.vehicle = parse_vehicle(made.text, measured.name + ".toml");
  made.estimates = estimates_of(measured, rotor, inertia, made.spread);
  return made;
}

}  // namespace quadtune
