// SPDX-License-Identifier: Apache-2.0
#include "simulation/campaign/uncertain_quantities.hpp"

#include <fmt/format.h>

#include <cmath>

namespace quadtune::internal {
namespace {

using Parts = UncertainParts;

constexpr double kMinRatio = 0.01, kMaxRatio = 100;
constexpr double kStrongestWind = 50;  // [m/s]

/// Builds the table of quantities.
class Table {
 public:
  void ratio(const std::string& name, const std::string& meaning,
             std::function<bool(Parts&, double)> change) {
    add({name, "1", QuantityKind::ratio, kMinRatio, kMaxRatio, meaning}, std::move(change));
  }
  void addition(const std::string& name, const std::string& unit, double size,
                const std::string& meaning, std::function<bool(Parts&, double)> change) {
    add({name, unit, QuantityKind::addition, -size, size, meaning}, std::move(change));
  }
  void value(const std::string& name, const std::string& unit, double min, double max,
             const std::string& meaning, std::function<bool(Parts&, double)> change) {
    add({name, unit, QuantityKind::value, min, max, meaning}, std::move(change));
  }

  std::vector<QuantityEffect> all;
  bool of_sensors = false;  ///< whether the quantities being added belong to sensors
  bool of_air = false;      ///< whether they belong to the wind

 private:
  void add(UncertainQuantity quantity, std::function<bool(Parts&, double)> change) {
    all.push_back({std::move(quantity), std::move(change), of_sensors, of_air});
  }
};

/// Wind affects a vehicle only through its drag.
bool has_drag(const Parts& p) { return has_aerodynamics(p.flown); }

void add_body(Table& table) {
  table.ratio("mass", "mass of the vehicle", [](Parts& p, double x) {
    p.flown.mass *= x;
    return true;
  });
  // J_ij is scaled by √(s_i s_j), so that the inertia matrix remains positive definite.
  for (int axis = 0; axis < 3; ++axis)
    table.ratio(fmt::format("inertia_{}", "xyz"[axis]),
                fmt::format("moment of inertia about body {}", "xyz"[axis]),
                [axis](Parts& p, double x) {
                  p.flown.inertia.row(axis) *= std::sqrt(x);
                  p.flown.inertia.col(axis) *= std::sqrt(x);
                  return true;
                });
  for (int axis = 0; axis < 3; ++axis)
    table.addition(fmt::format("centre_of_mass_{}", "xyz"[axis]), "m", 1,
                   fmt::format("offset of the centre of mass along body {}", "xyz"[axis]),
                   [axis](Parts& p, double x) {
                     for (Rotor& rotor : p.flown.rotors) rotor.position(axis) -= x;
                     return true;
                   });
  table.ratio("drag", "drag of body and rotors", [](Parts& p, double x) {
    p.flown.drag.cda *= x;
    p.flown.drag.linear *= x;
    for (Rotor& rotor : p.flown.rotors) rotor.drag *= x;
    return has_drag(p);
  });
}

void scale_thrust(Rotor& rotor, double x) {
  rotor.thrust_a2 *= x;
  rotor.thrust_a1 *= x;
}

void add_motors(Table& table) {
  table.ratio("thrust", "thrust of all rotors at a given speed", [](Parts& p, double x) {
    for (Rotor& rotor : p.flown.rotors) scale_thrust(rotor, x);
    return true;
  });
  table.ratio("torque", "drag torque of all rotors at a given speed", [](Parts& p, double x) {
    for (Rotor& rotor : p.flown.rotors) {
      rotor.torque_d2 *= x;
      rotor.torque_d1 *= x;
    }
    return true;
  });
  for (std::size_t i = 0; i < 8; ++i)
    table.ratio(fmt::format("thrust_{}", i + 1),
                fmt::format("thrust of rotor {} at a given speed, in addition to `thrust`", i + 1),
                [i](Parts& p, double x) {
                  if (i >= p.flown.rotors.size()) return false;
                  scale_thrust(p.flown.rotors[i], x);
                  return true;
                });
  table.ratio("motor_lag", "time constant of the motors", [](Parts& p, double x) {
    bool any = false;
    for (Rotor& rotor : p.flown.rotors) {
      any = any || slower_lag(rotor) > 0;
      rotor.lag *= x;
      rotor.lag_down *= x;
    }
    return any;
  });
  table.ratio("battery_voltage", "voltages of the battery without load", [](Parts& p, double x) {
    if (!p.flown.battery) return false;
    p.flown.battery->full_voltage *= x;
    p.flown.battery->empty_voltage *= x;
    return true;
  });
  table.ratio("battery_capacity", "charge that the battery holds", [](Parts& p, double x) {
    if (!p.flown.battery) return false;
    p.flown.battery->capacity *= x;
    return true;
  });
}

void add_air(Table& table) {
  const char* const directions[] = {"north", "east", "down"};
  for (int axis = 0; axis < 3; ++axis)
    table.addition(fmt::format("wind_{}", directions[axis]), "m/s", kStrongestWind,
                   fmt::format("mean wind towards {}", directions[axis]),
                   [axis](Parts& p, double x) {
                     p.environment.wind.mean(axis) += x;
                     return has_drag(p);
                   });
  for (int axis = 0; axis < 3; ++axis)
    table.addition(fmt::format("gust_{}", directions[axis]), "m/s", kStrongestWind,
                   fmt::format("strongest wind of the gust towards {}", directions[axis]),
                   [axis](Parts& p, double x) {
                     p.environment.wind.gust.velocity(axis) += x;
                     return has_drag(p);
                   });
  table.value("gust_at", "s", 0, 86400, "when the gust begins", [](Parts& p, double x) {
    p.environment.wind.gust.start = x;
    return has_drag(p);
  });
  table.value("gust_length", "s", 0.01, 86400, "how long the gust lasts", [](Parts& p, double x) {
    p.environment.wind.gust.length = x;
    return has_drag(p);
  });
  table.value("turbulence", "m/s", 0, kStrongestWind, "wind at 6 m that drives the turbulence",
              [](Parts& p, double x) {
                p.environment.wind.turbulence = x;
                return has_drag(p);
              });
}

/// The faults of a sensor by name; null if the vehicle does not have the sensor.
SensorFaults* faults_of(Sensors& sensors, const std::string& name) {
  const auto plain = [](std::optional<SensorFaults>& s) { return s ? &*s : nullptr; };
  if (name == "accelerometer") return plain(sensors.accelerometer);
  if (name == "gyroscope") return plain(sensors.gyroscope);
  if (name == "magnetometer") return plain(sensors.magnetometer);
  if (name == "barometer") return sensors.barometer ? &sensors.barometer->faults : nullptr;
  if (name == "sonar") return sensors.sonar ? &sensors.sonar->faults : nullptr;
  if (name == "flow") return sensors.flow ? &sensors.flow->faults : nullptr;
  if (name == "gps") return sensors.gps ? &sensors.gps->position : nullptr;
  return plain(sensors.vision);
}

struct SensorWords {
  const char* name;
  const char* unit;
  int axes;
  double max;         ///< maximum bias or noise, in the sensor's unit
  const char* title;  ///< the name in a sentence
};

void add_sensor(Table& table, const SensorWords& sensor) {
  const std::string name = sensor.name;
  const auto with_faults = [name](auto&& change) {
    return [name, change](Parts& p, double x) {
      SensorFaults* faults = faults_of(p.flown.sensors, name);
      if (faults == nullptr) return false;
      change(*faults, x);
      return true;
    };
  };
  table.ratio(name + "_scale", fmt::format("scale of the {}", sensor.title),
              with_faults([](SensorFaults& f, double x) { f.scale *= x; }));
  for (int axis = 0; axis < sensor.axes; ++axis)
    table.addition(sensor.axes == 1 ? name + "_bias" : fmt::format("{}_bias_{}", name, "xyz"[axis]),
                   sensor.unit, sensor.max,
                   sensor.axes == 1
                       ? fmt::format("bias of the {}", sensor.title)
                       : fmt::format("bias of the {} along {}", sensor.title, "xyz"[axis]),
                   with_faults([axis](SensorFaults& f, double x) { f.bias(axis) += x; }));
  table.ratio(name + "_noise", fmt::format("noise of the {}", sensor.title),
              with_faults([](SensorFaults& f, double x) { f.noise *= x; }));
  table.value(name + "_deviation", sensor.unit, 0, sensor.max,
              fmt::format("standard deviation of a sample of the {}{}", sensor.title,
                          sensor.axes == 1 ? "" : ", every axis"),
              with_faults([axes = sensor.axes](SensorFaults& f, double x) {
                f.noise.head(axes).setConstant(x);
              }));
  table.addition(
      name + "_delay", "s", 1, fmt::format("delay of the {}", sensor.title),
      with_faults([](SensorFaults& f, double x) { f.delay = std::max(0.0, f.delay + x); }));
  table.value(name + "_dropout", "1", 0, 1,
              fmt::format("probability that a sample of the {} is lost", sensor.title),
              with_faults([](SensorFaults& f, double x) { f.dropout = x; }));
}

std::vector<QuantityEffect> make_table() {
  Table table;
  add_body(table);
  add_motors(table);
  table.of_air = true;
  add_air(table);
  table.of_air = false;
  table.of_sensors = true;
  for (const SensorWords& sensor : {SensorWords{"accelerometer", "m/s^2", 3, 100, "accelerometer"},
                                    SensorWords{"gyroscope", "rad/s", 3, 100, "gyroscope"},
                                    SensorWords{"magnetometer", "uT", 3, 1000, "magnetometer"},
                                    SensorWords{"barometer", "Pa", 1, 1e4, "barometer"},
                                    SensorWords{"sonar", "m", 1, 100, "sonar"},
                                    SensorWords{"flow", "rad/s", 2, 100, "optical-flow sensor"},
                                    SensorWords{"gps", "m", 3, 1000, "GPS receiver"},
                                    SensorWords{"vision", "m", 3, 1000, "vision sensor"}})
    add_sensor(table, sensor);
  return std::move(table.all);
}

}  // namespace

const std::vector<QuantityEffect>& quantity_effects() {
  static const std::vector<QuantityEffect> table = make_table();
  return table;
}

}  // namespace quadtune::internal
