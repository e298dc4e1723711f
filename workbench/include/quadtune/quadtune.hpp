// SPDX-License-Identifier: Apache-2.0
/// Everything at once. To compile faster, include one of these, or a single header.
#pragma once

#include "quadtune/control.hpp"     // laws, gains, design files
#include "quadtune/discretize.hpp"  // sampled models
#include "quadtune/estimation.hpp"  // filters, filter models
#include "quadtune/exports.hpp"     // files for flight code
#include "quadtune/linearize.hpp"   // trims, linear models near them
#include "quadtune/logs.hpp"        // logs of other programs and of simulated flights
#include "quadtune/model.hpp"       // vehicles, linear models, conventions, errors
#include "quadtune/simulation.hpp"  // missions, flights, campaigns
#include "quadtune/synthesis.hpp"   // LQR, Kalman, PID, margins, proofs
#include "quadtune/tuning.hpp"      // weights, covariances, calibrations
#include "quadtune/workbench.hpp"   // what each command computes, as calls
