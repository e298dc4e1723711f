// SPDX-License-Identifier: Apache-2.0
/// Simulated flights: missions, laws and estimators of your own, campaigns.
#pragma once

#include "quadtune/simulation/campaign/campaign.hpp"        // many flights with drawn parameters
#include "quadtune/simulation/campaign/campaign_shard.hpp"  // parts of a campaign on disk
#include "quadtune/simulation/campaign/campaign_statistics.hpp"  // success rates, sensitivities
#include "quadtune/simulation/campaign/campaign_table.hpp"  // the records of a campaign as a table
#include "quadtune/simulation/campaign/spread_uncertainty.hpp"  // the uncertainty of a vehicle file, drawn
#include "quadtune/simulation/campaign/uncertainty.hpp"         // what is drawn for each flight
#include "quadtune/simulation/designed_controller.hpp"          // the laws of a design as they fly
#include "quadtune/simulation/flight.hpp"                       // one flight, or many
#include "quadtune/simulation/flight_estimator.hpp"             // an estimator of your own
#include "quadtune/simulation/flight_event.hpp"  // failing motors, loads that come and go
#include "quadtune/simulation/flight_law.hpp"    // a control law of your own
#include "quadtune/simulation/integrators.hpp"   // integration methods
#include "quadtune/simulation/metric.hpp"        // what is measured of a flight
#include "quadtune/simulation/mission.hpp"       // missions, and reading their files
#include "quadtune/simulation/smooth_path.hpp"   // lines, circles and lemniscates
