// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/assumed_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/internal/toml_reader.hpp"

namespace quadtune {
namespace {

using internal::TomlTable;

class Absent {
 public:
  explicit Absent(const Vehicle& vehicle)
      : vehicle_(vehicle), file_(TomlTable::parse(vehicle.text, vehicle.name)) {}

  std::vector<AssumedValue> values() {
    in("environment", "gravity_m_per_s2", fmt::format("{} m/s2", vehicle_.gravity));
    in("environment", "air_density_kg_per_m3",
       fmt::format("{} kg/m3, for which the rotors' curves hold", vehicle_.air_density));
    in("body", "drag_area_m2", "0 m2: no drag that grows with the square of the speed");
    in("body", "drag_linear_N_s_per_m", "0 N s/m: no drag in proportion to the speed");
    of_rotors("thrust_a1_N_s_per_rad", {"Ct"},
              "0 N s/rad: thrust goes with the square of the speed");
    of_rotors("torque_d1_N_m_s_per_rad", {"Cq"},
              "0 N m s/rad: drag torque goes with the square of the speed");
    of_rotors("inertia_kg_m2", {}, "0 kg m2: rotors have no angular momentum");
    of_lag();
    const std::string unit = vehicle_.motor.law == CommandLaw::speed ? "rad_s" : "count";
    in("motor", "quantum_" + unit, "0: commands have no steps");
    in("motor", "direction", "1 for all");
    if (!file_.has("sensors")) add("sensors", "typical ones of small vehicles");
    if (!file_.has("battery")) add("battery", "none: a supply that never falls");
    in("flight", "takeoff_gain", "0: thrust at take-off is m g");
    in("flight", "altitude_thrust_fraction", "1: all thrust is the altitude loop's");
    return std::move(values_);
  }

 private:
  void add(const std::string& key, const std::string& value) { values_.push_back({key, value}); }

  void in(const std::string& table, const std::string& key, const std::string& value) {
    const std::optional<TomlTable> found = file_.maybe_table(table);
    if (!found || !found->has(key)) add(table + "." + key, value);
  }

  [[nodiscard]] bool given_for_rotors(const std::string& key) const {
    std::vector<TomlTable> tables = file_.tables("rotors");
    if (const auto shared = file_.maybe_table("rotor")) tables.push_back(*shared);
    return std::any_of(tables.begin(), tables.end(),
                       [&](const TomlTable& table) { return table.has(key); });
  }

  /// @param instead  alternative keys
  void of_rotors(const std::string& key, const std::vector<std::string>& instead,
                 const std::string& value) {
    const bool said = given_for_rotors(key) ||
                      std::any_of(instead.begin(), instead.end(), [&](const std::string& other) {
                        return given_for_rotors(other);
                      });
    if (!said) add("rotor." + key, value);
  }

  void of_lag() {
    if (given_for_rotors("lag_up_s") || given_for_rotors("lag_down_s")) {
      of_rotors("lag_up_s", {"lag_s"}, "0 s: speeds rise to their commands at once");
      of_rotors("lag_down_s", {"lag_s"}, "0 s: speeds fall to their commands at once");
    } else {
      of_rotors("lag_s", {}, "0 s: speeds follow their commands at once");
    }
  }

  const Vehicle& vehicle_;
  TomlTable file_;
  std::vector<AssumedValue> values_;
};

}  // namespace

std::vector<AssumedValue> assumed_values(const Vehicle& vehicle) {
  if (vehicle.text.empty()) return {};
  return Absent(vehicle).values();
}

}  // namespace quadtune
