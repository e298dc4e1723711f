// SPDX-License-Identifier: Apache-2.0
/// Control laws as data and as they run on board, and what a design asks for.
#pragma once

#include "quadtune/cascade.hpp"                     // gains of a PID cascade, requirements on them
#include "quadtune/control/allocation.hpp"          // from a wrench to rotor speeds
#include "quadtune/control/cascade_law.hpp"         // a PID cascade as a linear law near hover
#include "quadtune/control/cascaded_pid.hpp"        // the PID cascade as it runs on board
#include "quadtune/control/guarded_integral.hpp"    // the integral of the uquad flight program
#include "quadtune/control/limited_allocation.hpp"  // commands that the motors cannot produce
#include "quadtune/control/pid.hpp"                 // a PID controller as it runs on board
#include "quadtune/control/pid_method.hpp"          // ways to sample a PID controller
#include "quadtune/control/scheduled_feedback.hpp"  // a gain schedule as it runs on board
#include "quadtune/control/state_feedback_law.hpp"  // state feedback as it runs on board
#include "quadtune/design.hpp"                      // the content of a design file
#include "quadtune/design/export_target.hpp"        // the names of what a design is exported to
#include "quadtune/design/firmware_options.hpp"     // options of an export to firmware
#include "quadtune/design/flight_code_options.hpp"  // options of an export to C
#include "quadtune/gain_schedule.hpp"               // gains over a grid of flights, interpolated
#include "quadtune/gains.hpp"                       // a state feedback, ready to be applied
