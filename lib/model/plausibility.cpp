// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/plausibility.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "quadtune/model/mixer.hpp"

namespace quadtune {
namespace {

constexpr double kRpm = 2 * std::numbers::pi / 60;  // [rad/s]

struct PlausibleRange {
  double low;
  double high;
  [[nodiscard]] bool holds(double value) const { return low <= value && value <= high; }
};

/// C_T = T / (ρ π R⁴ w²) of propellers.
constexpr PlausibleRange kThrustCoefficient = {0.002, 0.06};

/// A mistake that multiplies the correct value by `factor`.
struct Mistake {
  double factor;
  std::string what;
};

class Search {
 public:
  explicit Search(const Vehicle& vehicle) : vehicle_(vehicle) {
    const auto n = static_cast<double>(vehicle.rotors.size());
    for (const Rotor& rotor : vehicle.rotors) arm_ += rotor.position.head<2>().norm() / n;
    thrust_ = vehicle.mass * vehicle.gravity / n;
  }

  std::vector<Implausibility> found() {
    environment();
    const bool arm_fits = arm();
    // If the arm length is wrong, a correct inertia would be reported as wrong.
    const bool inertia_fits = arm_fits && inertia();
    if (inertia_fits) inertia_order();
    const bool weight_fits = weight();
    if (weight_fits) flight_settings();
    drag_torque();
    bool speed_fits = true;
    if (arm_fits || !std::isnan(vehicle_.rotors.front().radius)) speed_fits = speed();
    motors(inertia_fits);
    if (arm_fits && weight_fits) battery();
    if (weight_fits && speed_fits) air();
    delays();
    rates();
    noise();
    return std::move(found_);
  }

 private:
  /// @param mistakes  the one reported brings the value into the range, closest to its middle
  /// @return          whether the value is within the range
  bool look(const std::string& quantity, const std::string& unit, double value,
            const PlausibleRange& range, const std::vector<Mistake>& mistakes) {
    if (range.holds(value)) return true;
    std::string cause = "a unit or a power of ten may be wrong";
    const double middle = std::sqrt(range.low * range.high);
    double nearest = range.high / middle;  // as a ratio
    for (const Mistake& mistake : mistakes) {
      const double right = value / mistake.factor;
      const double ratio = std::max(right / middle, middle / right);
      if (!(ratio < nearest)) continue;
      nearest = ratio;
      cause = mistake.what;
    }
    found_.push_back({quantity, unit, value, range.low, range.high, cause});
    return false;
  }

  void environment() {
    look("gravity", "m/s2", vehicle_.gravity, {1.5, 25},
         {{100, "gravity_m_per_s2 seems to be in cm/s2"},
          {9.81 / 32.2, "gravity_m_per_s2 seems to be in ft/s2"},
          {0.10197, "gravity_m_per_s2 seems to be in units of g"}});
    look("air density", "kg/m3", vehicle_.air_density, {0.1, 2},
         {{1e-3, "air_density_kg_per_m3 seems to be in g/cm3"},
          {1e3, "air_density_kg_per_m3 seems to be in g/m3"}});
  }

  /// m/L³ of multirotors between 10 g and 30 kg is 20 to 1000 kg/m³.
  bool arm() {
    if (!(arm_ > 0)) return false;
    const PlausibleRange range{std::cbrt(vehicle_.mass / 5000), std::cbrt(vehicle_.mass / 5)};
    // The range scales with the cube root of the mass: ten times the arm, a thousand times the
    // mass.
    const std::vector<Mistake> mistakes = {
        {1000, "position_m seems to be in mm"},
        {100, "position_m seems to be in cm"},
        {39.37, "position_m seems to be in inches"},
        {0.1, "mass_kg seems to be in g, or position_m is too small by a factor of ten"},
        {10, "position_m may be too large by a factor of ten, or mass_kg too small by a thousand"}};
    return look("arm (mean distance of the rotors from the centre)", "m", arm_, range, mistakes);
  }

  /// Arms with motors at their ends have 0.2 to 0.5 m L² about each horizontal axis, twice that
  /// about the vertical axis.
  bool inertia() {
    const double size = vehicle_.mass * arm_ * arm_;
    const Eigen::Vector3d moments =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(vehicle_.inertia).eigenvalues();
    const std::vector<Mistake> units = {{1e7, "inertia_kg_m2 seems to be in g cm2"},
                                        {1e4, "inertia_kg_m2 seems to be in kg cm2"},
                                        {1e9, "inertia_kg_m2 seems to be in g mm2"},
                                        {1e6, "inertia_kg_m2 seems to be in kg mm2"},
                                        {1e3, "inertia_kg_m2 seems to be in g m2"}};
    // One line for all three moments, because they share a key.
    const PlausibleRange range{0.03, 3};
    const double largest = moments(2) / size;
    if (range.holds(largest))
      return look("smallest principal moment over mass times the square of the arm", "",
                  moments(0) / size, range, units);
    return look("largest principal moment over mass times the square of the arm", "", largest,
                range, units);
  }

  /// As look(), for a value that is outside its range for one reason only.
  void look_for(const std::string& cause, const std::string& quantity, const std::string& unit,
                double value, const PlausibleRange& range) {
    if (!look(quantity, unit, value, range, {})) found_.back().cause = cause;
  }

  /// Rotors in one plane make the moment about the vertical axis the largest; that of a body
  /// cannot exceed the sum of the other two.
  void inertia_order() {
    const Eigen::Vector3d moments = vehicle_.inertia.diagonal();
    look_for("the order of inertia_kg_m2 may be wrong, expected x, y, z with z downwards",
             "moment of inertia about z over the mean of those about x and y", "",
             moments(2) / (0.5 * (moments(0) + moments(1))), {0.6, 2.1});
  }

  /// Limits of the laws for height and take-off.
  void flight_settings() {
    const double ratio = thrust_to_weight(vehicle_);
    look_for("altitude_thrust_fraction is too small for a hover",
             "thrust-to-weight within altitude_thrust_fraction", "",
             ratio * vehicle_.altitude_thrust_fraction, {1, 10});
    if (vehicle_.takeoff_gain > 0)
      look("takeoff_gain", "", vehicle_.takeoff_gain, {1e-3, ratio},
           {{100, "takeoff_gain may be in percent, expected a fraction of the weight"}});
  }

  bool weight() {
    const double ratio = thrust_to_weight(vehicle_);
    constexpr double kTooHeavy = 0.4;  // unlikely to be a wrong unit
    if (ratio < 1 && ratio > kTooHeavy) {
      look_for("the vehicle is too heavy for its rotors", "maximum thrust over weight", "", ratio,
               {1, 10});
      return false;
    }
    const bool speed = vehicle_.motor.law == CommandLaw::speed;
    const std::string max = speed ? "max_rad_s" : "max_count";
    std::vector<Mistake> mistakes;
    if (speed) mistakes.push_back({1 / (kRpm * kRpm), "max_rad_s seems to be in rpm"});
    mistakes.push_back({static_cast<double>(vehicle_.rotors.size()),
                        "the thrust of one rotor may be that of all rotors together"});
    mistakes.insert(mistakes.end(), {{kRpm * kRpm, "the thrust curve may be for speeds in rpm"},
                                     {1 / (kRpm * kRpm), "the motor's gain may give (rpm)2"},
                                     {1e-3, "mass_kg seems to be in g, or the thrust curve in kN"},
                                     {1e3, "the thrust curve seems to be in mN, or mass_kg in t"},
                                     {1 / 9.81, "the thrust curve seems to be in kgf"},
                                     {1e3 / 9.81, "the thrust curve seems to be in gf"}});
    // A curve from Ct is proportional to the fourth power of the radius.
    if (kThrustCoefficient.holds(thrust_coefficient()))
      mistakes.insert(mistakes.end(), {{std::pow(2, 4), "radius_m may be the diameter"},
                                       {std::pow(39.37, 4), "radius_m seems to be in inches"},
                                       {std::pow(1e2, 4), "radius_m seems to be in cm"},
                                       {std::pow(1e3, 4), "radius_m seems to be in mm"}});
    return look("thrust-to-weight at " + max, "", ratio, {1, 10}, mistakes);
  }

  /// Ratio of a rotor's drag torque to its thrust: a twentieth to a third of its radius.
  void drag_torque() {
    const Rotor& rotor = vehicle_.rotors.front();
    const double w = rotor_speed_for_thrust(rotor, thrust_);
    const double torque = rotor_torque(rotor, w);
    if (!(torque > 0)) return;  // no drag torque is known
    look("drag torque over thrust of a rotor at hover", "m", torque / thrust_, {5e-4, 0.1},
         {{1000, "the torque curve seems to be in N mm"},
          {100, "the torque curve seems to be in N cm"},
          {1e-3, "the torque curve seems to be in kN m"},
          {1 / (kRpm * kRpm), "thrust and torque may be for speeds in different units"},
          {kRpm * kRpm, "thrust and torque may be for speeds in different units"}});
  }

  /// T = C_T ρ π R⁴ w² with the C_T of propellers; R is known or limited by the distance between
  /// rotors.
  bool speed() {
    const Rotor& rotor = vehicle_.rotors.front();
    const bool known = !std::isnan(rotor.radius);
    const double radius = known ? rotor.radius : room();
    if (!(radius > 0)) return true;
    constexpr PlausibleRange kDistance{0.1, 2.1};  // two rotors: 2; 24 on a circle: 0.26
    if (const double distance = 2 * room() / arm_;
        !known && arm_ > 0 && !kDistance.holds(distance)) {
      found_.push_back({"smallest distance between two rotors over the arm", "", distance,
                        kDistance.low, kDistance.high,
                        "position_m of one of the two rotors may be wrong"});
      return true;
    }
    const double w = rotor_speed_for_thrust(rotor, thrust_);
    // A propeller may be smaller than half of the available radius: C_T scales with its fourth
    // power.
    const PlausibleRange coefficient = known ? kThrustCoefficient : PlausibleRange{0.0002, 0.06};
    const double disc = vehicle_.air_density * std::numbers::pi * std::pow(radius, 4);
    const PlausibleRange range{std::sqrt(thrust_ / (disc * coefficient.high)),
                               std::sqrt(thrust_ / (disc * coefficient.low))};
    std::vector<Mistake> mistakes = {
        {1 / kRpm, "the thrust curve may be for speeds in rpm"},
        {1 / (2 * std::numbers::pi), "the thrust curve may be for turns a second"},
        {std::sqrt(1e-3), "the thrust curve seems to be in mN"}};
    if (known)
      mistakes.insert(mistakes.end(),
                      {{1 / std::sqrt(std::pow(std::numbers::pi, 3) / 4),
                        "Ct may be that of T = Ct rho n2 D4, expected that of T = Ct rho pi r4 w2"},
                       {4, "radius_m may be the diameter"},
                       {std::pow(1e3, 2), "radius_m seems to be in mm"}});
    return look(fmt::format("rotor speed at hover (for a propeller of {} {:.3g} m)",
                            known ? "radius" : "at most", radius),
                "rad/s", w, range, mistakes);
  }

  /// C_T of the first rotor; not a number if its radius is unknown.
  [[nodiscard]] double thrust_coefficient() const {
    const Rotor& rotor = vehicle_.rotors.front();
    return rotor.thrust_a2 / (vehicle_.air_density * std::numbers::pi * std::pow(rotor.radius, 4));
  }

  /// Half the horizontal distance between the two rotors that are closest to each other.
  [[nodiscard]] double room() const {
    double min = 0;
    for (const Rotor& a : vehicle_.rotors)
      for (const Rotor& b : vehicle_.rotors) {
        const double distance = (a.position - b.position).head<2>().norm();
        // Coaxial rotors do not limit each other.
        if (distance > 1e-6 * arm_ && (min == 0 || distance < min)) min = distance;
      }
    return min / 2;
  }

  void motors(bool inertia_fits) {
    const double yaw = vehicle_.inertia(2, 2);
    double lag = 0, inertia = 0;
    for (const Rotor& rotor : vehicle_.rotors) {
      lag = std::max(lag, slower_lag(rotor));
      inertia = std::max(inertia, rotor.inertia);
    }
    if (lag > 0) look("motor lag", "s", lag, {1e-3, 0.5}, {{1000, "lag_s seems to be in ms"}});
    if (inertia > 0 && inertia_fits)
      look("inertia of a rotor over that of the vehicle about z", "", inertia / yaw, {1e-6, 0.05},
           {{1e7, "inertia_kg_m2 of the rotor seems to be in g cm2"},
            {1e4, "inertia_kg_m2 of the rotor seems to be in kg cm2"},
            {1e9, "inertia_kg_m2 of the rotor seems to be in g mm2"},
            {1e3, "inertia_kg_m2 of the rotor seems to be in g m2"}});
  }

  /// Drag and inflow of all rotors at hover, and drag of the body, as rates at which they change the
  /// velocity of the vehicle.
  void air() {
    double drag = 0, inflow = 0, flapping = 0;
    for (const Rotor& rotor : vehicle_.rotors) {
      const double w = rotor_speed_for_thrust(rotor, thrust_);
      drag += rotor.drag * w / vehicle_.mass;
      inflow += rotor.inflow * w / vehicle_.mass;
      flapping = std::max(flapping, rotor.flapping * w / thrust_);
    }
    const double w = rotor_speed_for_thrust(vehicle_.rotors.front(), thrust_);
    const auto mistakes = [&](const std::string& key) -> std::vector<Mistake> {
      return {{w, key + " may be that of a rotor at hover, expected that per rad/s"},
              {kRpm, key + " may be for speeds in rpm"}};
    };
    if (drag > 0)
      look("drag of the rotors at hover over mass", "1/s", drag, {2e-3, 3},
           mistakes("drag_N_s2_per_rad_m"));
    if (inflow > 0)
      look("inflow of the rotors at hover over mass", "1/s", inflow, {0.01, 10},
           mistakes("inflow_N_s2_per_rad_m"));
    if (flapping > 0)
      look("flapping of a rotor at hover over its thrust", "s", flapping, {1e-7, 0.05},
           mistakes("flapping_N_s2_per_rad"));
    const double area = vehicle_.drag.cda.maxCoeff(), linear = vehicle_.drag.linear.maxCoeff();
    if (area > 0)
      look("speed at which the drag of drag_area_m2 is the weight", "m/s",
           std::sqrt(2 * vehicle_.mass * vehicle_.gravity / (vehicle_.air_density * area)),
           {3, 300},
           {{1e-2, "drag_area_m2 seems to be in cm2"}, {1e-3, "drag_area_m2 seems to be in mm2"}});
    if (linear > 0)
      look("linear drag over mass", "1/s", linear / vehicle_.mass, {1e-3, 5},
           {{1e3, "drag_linear_N_s_per_m seems to be in mN s/m"}});
  }

  /// Energy per mass of the vehicle; the best cells have 300 W h/kg.
  void battery() {
    if (!vehicle_.battery) return;
    const Battery& battery = *vehicle_.battery;
    const double energy = battery.capacity / 3600 * battery.full_voltage / vehicle_.mass;
    look("energy of the battery over the vehicle's mass", "W h/kg", energy, {1, 400},
         {{1000, "capacity_A_h seems to be in mA h"}, {1e-3, "capacity_A_h seems to be in kA h"}});
  }

  /// Flown loops are not analysed with sensor delays above 40 control periods of 5 ms.
  void delays() {
    const Sensors& sensors = vehicle_.sensors;
    const auto delay = [&](const char* name, const SensorFaults* faults) {
      if (faults != nullptr && faults->delay > 0)
        look(fmt::format("delay of the {}", name), "s", faults->delay, {1e-5, 0.2},
             {{1000, "delay_s seems to be in ms"}});
    };
    const auto of = [](const auto& sensor) { return sensor ? &sensor->faults : nullptr; };
    delay("accelerometer", sensors.accelerometer ? &*sensors.accelerometer : nullptr);
    delay("gyroscope", sensors.gyroscope ? &*sensors.gyroscope : nullptr);
    delay("magnetometer", sensors.magnetometer ? &*sensors.magnetometer : nullptr);
    delay("barometer", of(sensors.barometer));
    delay("sonar", of(sensors.sonar));
    delay("optical flow", of(sensors.flow));
    delay("GPS", sensors.gps ? &sensors.gps->position : nullptr);
    delay("vision", sensors.vision ? &*sensors.vision : nullptr);
    if (vehicle_.motor.delay > 0)
      look("delay of the commands", "s", vehicle_.motor.delay, {1e-5, 0.2},
           {{1000, "command_delay_s seems to be in ms"}});
  }

  void rates() {
    const Sensors& sensors = vehicle_.sensors;
    const auto rate = [&](const char* name, const std::optional<SensorFaults>& faults) {
      if (faults)
        look_for("attitude control requires a faster sensor; rate_Hz may be in kHz",
                 fmt::format("rate of the {}", name), "Hz", faults->rate, {40, 1e5});
    };
    rate("accelerometer", sensors.accelerometer);
    rate("gyroscope", sensors.gyroscope);
  }

  /// Standard deviations of samples, several times those of the worst usual sensors.
  void noise() {
    constexpr double kDegree = 180 / std::numbers::pi;
    const Sensors& sensors = vehicle_.sensors;
    const auto largest = [&](const char* name, const char* unit, const SensorFaults* faults,
                             double high, const std::vector<Mistake>& mistakes) {
      if (faults == nullptr || !(faults->noise.maxCoeff() > 0)) return;
      look(fmt::format("noise of the {}", name), unit, faults->noise.maxCoeff(), {1e-7, high},
           mistakes);
    };
    const auto of = [](const auto& sensor) { return sensor ? &sensor->faults : nullptr; };
    const auto plain = [](const auto& sensor) { return sensor ? &*sensor : nullptr; };
    const std::vector<Mistake> lengths = {{1e3, "noise seems to be in mm"},
                                          {1e2, "noise seems to be in cm"}};
    largest("accelerometer", "m/s2", plain(sensors.accelerometer), 10,
            {{1e3 / 9.81, "noise seems to be in mg"}});
    largest("gyroscope", "rad/s", plain(sensors.gyroscope), 1,
            {{kDegree, "noise seems to be in deg/s"}});
    largest("magnetometer", "uT", plain(sensors.magnetometer), 30,
            {{1e3, "noise seems to be in nT"}});
    largest("barometer", "Pa", of(sensors.barometer), 200, {});
    largest("sonar", "m", of(sensors.sonar), 1, lengths);
    largest("optical flow", "rad/s", of(sensors.flow), 5,
            {{kDegree, "noise seems to be in deg/s"}});
    largest("GPS", "m", sensors.gps ? &sensors.gps->position : nullptr, 30, lengths);
    largest("vision", "m", plain(sensors.vision), 1, lengths);
  }

  const Vehicle& vehicle_;
  double arm_ = 0;     // [m]
  double thrust_ = 0;  // of a rotor at hover [N]
  std::vector<Implausibility> found_;
};

}  // namespace

std::vector<Implausibility> find_implausible_values(const Vehicle& vehicle) {
  return Search(vehicle).found();
}

std::string to_string(const Implausibility& figure) {
  const std::string unit = figure.unit.empty() ? "" : " " + figure.unit;
  return fmt::format("{} is {:.4g}{}, expected {:.3g} to {:.3g}{}: {}", figure.quantity,
                     figure.value, unit, figure.low, figure.high, unit, figure.cause);
}

}  // namespace quadtune
