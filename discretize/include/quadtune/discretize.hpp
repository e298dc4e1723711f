// SPDX-License-Identifier: Apache-2.0
/// Sampled models: every method, by one function or by its own.
#pragma once

#include "quadtune/discretize/backward_euler.hpp"      // backward Euler
#include "quadtune/discretize/compare.hpp"             // sampled against continuous
#include "quadtune/discretize/delay.hpp"               // delays of inputs and outputs as states
#include "quadtune/discretize/discretize.hpp"          // all methods by one function
#include "quadtune/discretize/euler.hpp"               // forward Euler
#include "quadtune/discretize/foh.hpp"                 // first-order hold
#include "quadtune/discretize/impulse.hpp"             // impulse invariance
#include "quadtune/discretize/matched.hpp"             // matched poles and zeros
#include "quadtune/discretize/matrix_exponential.hpp"  // the matrix exponential
#include "quadtune/discretize/sample_time.hpp"         // whether a sample period is short enough
#include "quadtune/discretize/to_continuous.hpp"       // from a discrete model to a continuous one
#include "quadtune/discretize/tustin.hpp"              // Tustin's method
#include "quadtune/discretize/van_loan.hpp"            // cost and noise of a sampled model
#include "quadtune/discretize/zoh.hpp"                 // zero-order hold
