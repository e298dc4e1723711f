// SPDX-License-Identifier: Apache-2.0
/// Gains with their evidence: Riccati, LQR, Kalman, PID, margins, proofs of stability.
#pragma once

#include "quadtune/synthesis/actuator_lqi.hpp"          // LQI with actuators that lag
#include "quadtune/synthesis/delayed_lqi.hpp"           // integrals of outputs, delayed inputs
#include "quadtune/synthesis/diagonal_lqr.hpp"          // an LQR as a function of its weights
#include "quadtune/synthesis/flown_axis.hpp"            // one group of axes of the flown plant
#include "quadtune/synthesis/flown_plant.hpp"           // the plant with lag, delays, estimator
#include "quadtune/synthesis/frequency_data.hpp"        // margins of measured responses
#include "quadtune/synthesis/invariant_zeros.hpp"       // zeros of any system
#include "quadtune/synthesis/kalman.hpp"                // steady-state Kalman filters
#include "quadtune/synthesis/lqg_regulator.hpp"         // LQR and filter as one controller
#include "quadtune/synthesis/lqr.hpp"                   // linear-quadratic regulators
#include "quadtune/synthesis/lyapunov.hpp"              // Lyapunov equations, Gramians and norms
#include "quadtune/synthesis/margins.hpp"               // margins of one loop
#include "quadtune/synthesis/open_loop.hpp"             // a loop cut open
#include "quadtune/synthesis/output_feedback.hpp"       // static output feedback
#include "quadtune/synthesis/periodic_loop.hpp"         // loops whose sensors sample at other rates
#include "quadtune/synthesis/pid/cascade_loop.hpp"      // one loop of a PID cascade
#include "quadtune/synthesis/pid/pid_cascade.hpp"       // the PID cascade of a vehicle near hover
#include "quadtune/synthesis/pid/pid_gains.hpp"         // PID gains in every form
#include "quadtune/synthesis/pid/pid_loop.hpp"          // PID gains for a crossover
#include "quadtune/synthesis/pid/pid_optimum.hpp"       // the best PID gains within bounds
#include "quadtune/synthesis/pid/pid_rules.hpp"         // PID gains by published rules
#include "quadtune/synthesis/pid/step_response.hpp"     // closed loops in time
#include "quadtune/synthesis/pid/ultimate_rules.hpp"    // PID rules from Ku and Tu
#include "quadtune/synthesis/pole_placement.hpp"        // gains for given poles
#include "quadtune/synthesis/riccati.hpp"               // Riccati equations
#include "quadtune/synthesis/riccati_batch.hpp"         // many Riccati equations of one size
#include "quadtune/synthesis/robust_stability.hpp"      // proof over an uncertainty box
#include "quadtune/synthesis/robustness.hpp"            // how large that box may become
#include "quadtune/synthesis/series.hpp"                // two systems in series
#include "quadtune/synthesis/simultaneous_margins.hpp"  // margins of several loops at once
#include "quadtune/synthesis/state_feedback.hpp"        // the gains of an LQR design
#include "quadtune/synthesis/uncertain_loop.hpp"        // a loop with uncertain parameters
