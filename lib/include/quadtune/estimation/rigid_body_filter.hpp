// SPDX-License-Identifier: Apache-2.0
/// Model of the uquad's extended Kalman filter for the estimation of its noise: a rigid body driven
/// by its rotor speeds, and the accelerometer biases. Theory: "Covariances from logs".
#pragma once

#include <string>

#include "quadtune/estimation/filter_model.hpp"

namespace quadtune {

/// Model with the states of the uquad's filter (px py pz, roll pitch yaw, u v w, p q r of
/// ned_convention(), then the accelerometer biases), the rotor speeds as inputs and one noise per
/// state, without sensors and covariances.
/// @param vehicle  name or file
/// @throws InvalidInput, FileError  as load_vehicle()
[[nodiscard]] FilterModel rigid_body_model(const std::string& vehicle);

/// A sensor of the filter, without its R: tilt, yaw, force, rates, height, position (GPS), velocity
/// (GPS, world axes) or vision.
/// @throws InvalidInput  "where: no sensor 'gps', expected one of …"
[[nodiscard]] FilterSensor rigid_body_sensor(const std::string& name, const std::string& where);

}  // namespace quadtune
