// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/atmosphere.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

// ISO 2533:1975.
constexpr double kGravity = 9.80665;                 // [m/s²]
constexpr double kGasConstant = 287.05287;           // of dry air [J/(kg K)]
constexpr double kHeatRatio = 1.4;                   // of specific heats
constexpr double kGroundTemperature = 288.15;        // [K]
constexpr double kGroundPressure = 101325;           // [Pa]
constexpr double kLapseRate = 6.5e-3;                // below the tropopause [K/m]
constexpr double kTropopause = 11000;                // [m]
constexpr double kStratosphereTemperature = 216.65;  // up to 20 km [K]

Air ideal_gas(double temperature, double pressure) {
  return {temperature, pressure, pressure / (kGasConstant * temperature),  // ρ = p / (R T)
          std::sqrt(kHeatRatio * kGasConstant * temperature)};             // a = √(γ R T)
}

// p = p₀ (T/T₀)^(g/(R L)) where the temperature decreases by L per metre.
double troposphere_pressure(double temperature) {
  return kGroundPressure *
         std::pow(temperature / kGroundTemperature, kGravity / (kGasConstant * kLapseRate));
}

}  // namespace

Air standard_atmosphere(double height) {
  if (!(height >= kStandardAtmosphereFloor && height <= kStandardAtmosphereCeiling))
    throw InvalidInput("standard_atmosphere",
                       fmt::format("height is {} m, expected {} to {} m, where this model holds",
                                   height, kStandardAtmosphereFloor, kStandardAtmosphereCeiling));
  if (height <= kTropopause) {
    const double temperature = kGroundTemperature - kLapseRate * height;
    return ideal_gas(temperature, troposphere_pressure(temperature));
  }
  // p = p₁₁ exp(-g (h - h₁₁) / (R T)) where the temperature is constant.
  const double scale_height = kGasConstant * kStratosphereTemperature / kGravity;
  return ideal_gas(kStratosphereTemperature, troposphere_pressure(kStratosphereTemperature) *
                                                 std::exp(-(height - kTropopause) / scale_height));
}

Air air_of_density(double density) {
  if (!(density > 0) || !std::isfinite(density))
    throw InvalidInput("air_of_density",
                       fmt::format("density is {} kg/m3, expected more than 0", density));
  return ideal_gas(kGroundTemperature, density * kGasConstant * kGroundTemperature);
}

Air Atmosphere::at(double height) const {
  return model == AtmosphereModel::still ? air : standard_atmosphere(ground_height + height);
}

}  // namespace quadtune
