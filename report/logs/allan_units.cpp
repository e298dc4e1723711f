// SPDX-License-Identifier: Apache-2.0
#include "report/logs/allan_units.hpp"

#include <numbers>

namespace quadtune::report {
namespace {

constexpr double kDegree = 180 / std::numbers::pi;
constexpr double kHour = 3600;    // [s]
constexpr double kRootHour = 60;  // [√s]
constexpr double kMilliG = 1e3 / 9.80665;

/// The units of N, B, K and Q of a rate, and those of data sheets with the factors to them.
struct Units {
  std::string density, floor, walk, quantum;
  double to_density = 1, to_floor = 1, to_walk = 1, to_quantum = 1;
  std::string other_density, other_floor, other_walk, other_quantum;
};

Units units_of(const std::string& unit) {
  const bool degrees = unit == "deg/s";
  if (degrees || unit == "rad/s" || unit == "rad s^-1") {
    const double to_degrees = degrees ? 1 : kDegree;
    const std::string angle = degrees ? "deg" : "rad";
    return {angle + "/s/sqrt(Hz)",
            angle + "/s",
            angle + "/s^2/sqrt(Hz)",
            angle,
            to_degrees * kRootHour,
            to_degrees * kHour,
            to_degrees * kHour * kRootHour,
            to_degrees * kHour,
            "deg/sqrt(h)",
            "deg/h",
            "deg/h/sqrt(h)",
            "arcsec"};
  }
  if (unit == "m/s^2" || unit == "m/s2" || unit == "m s^-2")
    return {"m/s^2/sqrt(Hz)", "m/s^2", "m/s^3/sqrt(Hz)", "m/s", 1e3 * kMilliG,   kMilliG,
            kRootHour,        1e3,     "ug/sqrt(Hz)",    "mg",  "m/s^2/sqrt(h)", "mm/s"};
  const std::string name = unit.empty() ? "1" : unit;
  return {name + "/sqrt(Hz)", name, name + "/s/sqrt(Hz)", name + " s", 1, 1, 1, 1, "", "", "", ""};
}

}  // namespace

std::vector<AllanLine> allan_lines(const AllanAnalysis& a, const std::string& unit) {
  const Units u = units_of(unit);
  const bool angle = !u.other_floor.empty() && u.other_floor == "deg/h";
  return {{angle ? "noise density (angle random walk), slope -1/2, at tau = 1 s"
                 : "noise density, slope -1/2, at tau = 1 s",
           "noise_density", a.noise_density, u.density, u.to_density, u.other_density},
          {"bias instability, least deviation / 0.664", "bias_instability", a.bias_instability,
           u.floor, u.to_floor, u.other_floor},
          {"random walk, slope +1/2, at tau = 3 s", "random_walk", a.random_walk, u.walk, u.to_walk,
           u.other_walk},
          {"quantization, slope -1, at tau = sqrt(3) s", "quantization", a.quantization, u.quantum,
           u.to_quantum, u.other_quantum}};
}

}  // namespace quadtune::report
