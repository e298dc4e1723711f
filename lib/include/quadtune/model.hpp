// SPDX-License-Identifier: Apache-2.0
/// What describes a vehicle and a linear model, and the errors that every call may throw.
#pragma once

#include "quadtune/convention.hpp"            // names, order, axes and signs of states and inputs
#include "quadtune/convention_file.hpp"       // conventions of your own, from a file
#include "quadtune/errors.hpp"                // InvalidInput, NoSolution, FileError, …
#include "quadtune/flight_condition.hpp"      // hover, straight flight, circle, turn on the spot
#include "quadtune/frequency_response.hpp"    // responses of linear models to sines
#include "quadtune/lti.hpp"                   // state-space models, continuous and discrete
#include "quadtune/model/assumed_values.hpp"  // what is assumed where a vehicle file is silent
#include "quadtune/model/atmosphere.hpp"      // the air: uniform or the standard atmosphere
#include "quadtune/model/battery.hpp"         // voltage and capacity of a battery
#include "quadtune/model/environment.hpp"     // air, wind, gravity, magnetic field, ground
#include "quadtune/model/inertia.hpp"         // inertia of a body made of simple parts
#include "quadtune/model/mixer.hpp"           // rotor thrusts to the wrench, and back
#include "quadtune/model/plausibility.hpp"    // values that no multirotor is likely to have
#include "quadtune/model/rigid_body.hpp"      // the equations of motion
#include "quadtune/model/rotation.hpp"        // Euler angles, rotation matrices, quaternions
#include "quadtune/model/sensors.hpp"         // the sensors of a vehicle: rates, delays, errors
#include "quadtune/model/vehicle.hpp"         // a vehicle, and reading its file
#include "quadtune/model/vehicle_spread.hpp"  // how uncertain the values of a vehicle are
#include "quadtune/text_matrix.hpp"           // reads a matrix from text
#include "quadtune/transfer_function.hpp"     // transfer functions of one input and one output
#include "quadtune/version.hpp"               // the version of quadtune
