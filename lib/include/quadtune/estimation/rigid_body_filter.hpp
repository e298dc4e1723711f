// SPDX-License-Identifier: Apache-2.0
/// A model of the uquad's extended Kalman filter, for finding its noise: the rigid body driven by
/// its rotors' speeds, and the accelerometer's offsets. Theory: "Covariances from logs".
#pragma once

#include <string>

#include "quadtune/estimation/filter_model.hpp"

namespace quadtune {

/// A model with the states of the uquad's filter (px py pz, roll pitch yaw, u v w, p q r of
/// ned_convention(), then the offsets of the accelerometer), the rotors' speeds as inputs, one
/// noise a state, and no sensors or covariances yet.
/// @param vehicle  name or file
/// @throws InvalidInput, FileError  as load_vehicle()
[[nodiscard]] FilterModel rigid_body_model(const std::string& vehicle);

/// A sensor that the filter knows, without its R: tilt, yaw, force, rates, height, position (GPS),
/// velocity (GPS, world axes) or vision.
/// @throws InvalidInput  "where: no sensor 'gps', expected one of …"
[[nodiscard]] FilterSensor rigid_body_sensor(const std::string& name, const std::string& where);

}  // namespace quadtune
