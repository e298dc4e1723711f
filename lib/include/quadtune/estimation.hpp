// SPDX-License-Identifier: Apache-2.0
/// Estimators as they run on board, and filter models whose noise is tuned from logs.
#pragma once

#include "quadtune/estimation/angles.hpp"                   // angles as sensors measure them
#include "quadtune/estimation/complementary_filter.hpp"     // attitude from inertial sensors
#include "quadtune/estimation/covariance_model.hpp"         // parametrized covariance matrices
#include "quadtune/estimation/dual.hpp"                     // numbers with derivatives
#include "quadtune/estimation/extended_kalman_filter.hpp"   // a filter for your own models
#include "quadtune/estimation/filter_file.hpp"              // reads and writes filter models
#include "quadtune/estimation/filter_model.hpp"             // a filter of unknown covariances
#include "quadtune/estimation/filter_record.hpp"            // measurements in order of time
#include "quadtune/estimation/general_filter.hpp"           // the filter for every suite of sensors
#include "quadtune/estimation/general_filter_settings.hpp"  // its settings
#include "quadtune/estimation/inertial_filter.hpp"          // a model of inertial navigation
#include "quadtune/estimation/kalman_filter.hpp"            // a Kalman filter as it runs on board
#include "quadtune/estimation/log_signals.hpp"              // finds a model's signals in a log
#include "quadtune/estimation/mambo_estimator.hpp"          // the estimator of the Mambo
#include "quadtune/estimation/model_needs.hpp"              // which filter models a log can feed
#include "quadtune/estimation/nonlinear_filter.hpp"         // a nonlinear filter over its logs
#include "quadtune/estimation/on_board.hpp"                 // sensor frame, estimate, reference
#include "quadtune/estimation/record_of_log.hpp"            // from channels of a log to a record
#include "quadtune/estimation/rigid_body_filter.hpp"        // a model of the uquad's filter
#include "quadtune/estimation/steady_filter.hpp"            // a filter with steady gains, on board
#include "quadtune/estimation/tuned_noise.hpp"              // tuned covariances for use on board
#include "quadtune/estimation/uquad_filter.hpp"             // the extended filter of the uquad
#include "quadtune/filter.hpp"                              // a steady-state filter with its model
