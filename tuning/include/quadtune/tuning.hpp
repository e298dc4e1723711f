// SPDX-License-Identifier: Apache-2.0
/// Weights from requirements, covariances and calibrations from logs, gains over flights.
#pragma once

#include "quadtune/tuning/allan.hpp"                  // Allan deviation of a stationary sensor
#include "quadtune/tuning/autocovariance_fit.hpp"     // covariances from autocovariances
#include "quadtune/tuning/bryson.hpp"                 // weights by Bryson's rule
#include "quadtune/tuning/consistency.hpp"            // whether innovations are consistent
#include "quadtune/tuning/fixed_gains.hpp"            // gains of a given structure
#include "quadtune/tuning/imu_calibration.hpp"        // calibration of inertial sensors
#include "quadtune/tuning/innovation_likelihood.hpp"  // the likelihood of logs under a filter model
#include "quadtune/tuning/likelihood_profile.hpp"     // the likelihood along one parameter
#include "quadtune/tuning/match_gains.hpp"            // weights whose gain is a given one
#include "quadtune/tuning/mission_search.hpp"         // the search for gains over missions
#include "quadtune/tuning/mission_trial.hpp"          // the cost and the limits of that search
#include "quadtune/tuning/noise_agreement.hpp"        // whether two estimates of covariances agree
#include "quadtune/tuning/noise_fit.hpp"              // covariances of maximum likelihood
#include "quadtune/tuning/noise_tuning.hpp"           // covariances from logs, with a verdict
#include "quadtune/tuning/running_size.hpp"           // the size of innovations over time
#include "quadtune/tuning/schedule.hpp"               // LQR gains over a grid of flights
#include "quadtune/tuning/simulated_imu.hpp"          // a simulated inertial sensor
#include "quadtune/tuning/smoother.hpp"               // all states of a record at once
#include "quadtune/tuning/state_errors.hpp"           // errors of estimates
#include "quadtune/tuning/stationary.hpp"             // where a sensor was stationary
#include "quadtune/tuning/uncertain_vehicle.hpp"      // a hover over an uncertainty box
