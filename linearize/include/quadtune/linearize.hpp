// SPDX-License-Identifier: Apache-2.0
/// Steady flights, and linear models near them.
#pragma once

#include "quadtune/linearize/linearize.hpp"  // Jacobians near a trim
#include "quadtune/linearize/trim.hpp"       // states and rotor speeds of a steady flight
