// SPDX-License-Identifier: Apache-2.0
/// Logs: reading those of other programs, reading and writing those of simulated flights.
#pragma once

#include "quadtune/logs/flight_log.hpp"    // logs of simulated flights: CSV and MAT files
#include "quadtune/logs/log_channels.hpp"  // whole channels of a log by name
#include "quadtune/logs/log_reader.hpp"    // any log, row by row
#include "quadtune/logs/log_survey.hpp"    // what is in a log
#include "quadtune/logs/log_table.hpp"     // columns over one clock, and events
#include "quadtune/samples.hpp"            // memory for long series of samples
