// SPDX-License-Identifier: Apache-2.0
/// What each command computes, as calls: designs, flights, campaigns, tuning, verification.
#pragma once

#include "quadtune/workbench/campaign/campaign_folder.hpp"    // a campaign on disk
#include "quadtune/workbench/campaign/campaign_merge.hpp"     // results of a campaign
#include "quadtune/workbench/campaign/campaign_plan.hpp"      // a campaign, from its file
#include "quadtune/workbench/campaign/campaign_run.hpp"       // flies a campaign
#include "quadtune/workbench/campaign/campaign_scripts.hpp"   // scripts for clusters
#include "quadtune/workbench/design/cascade_options.hpp"      // requirements on a cascade
#include "quadtune/workbench/design/cascade_report.hpp"       // a PID cascade with its evidence
#include "quadtune/workbench/design/chosen_law.hpp"           // the law that options choose
#include "quadtune/workbench/design/design.hpp"               // a design, flown
#include "quadtune/workbench/design/design_verdict.hpp"       // whether a design may be flown
#include "quadtune/workbench/design/gain_match.hpp"           // weights of a given gain
#include "quadtune/workbench/design/gains_difference.hpp"     // the laws of two files compared
#include "quadtune/workbench/design/given_gains.hpp"          // laws from files
#include "quadtune/workbench/design/linearize_or_refuse.hpp"  // a linear model, or why not
#include "quadtune/workbench/design/lqg_report.hpp"           // LQG on the flown plant
#include "quadtune/workbench/design/lqi_report.hpp"           // LQI on the flown plant
#include "quadtune/workbench/design/lqr_report.hpp"           // LQR of matrices or of a vehicle
#include "quadtune/workbench/design/margins_report.hpp"       // margins by name, and warnings
#include "quadtune/workbench/design/matrix_report.hpp"        // state feedback as plain matrices
#include "quadtune/workbench/design/named_loop.hpp"           // loops whose margins are computed
#include "quadtune/workbench/design/near_hover.hpp"           // bounds that keep a law near hover
#include "quadtune/workbench/design/standard_axes.hpp"        // default weights by groups of axes
#include "quadtune/workbench/design/standard_lqr.hpp"         // the default LQR
#include "quadtune/workbench/design/usual_design.hpp"         // a design without a design file
#include "quadtune/workbench/design/vehicle_cascade.hpp"      // the PID cascade of a vehicle
#include "quadtune/workbench/export/export_content.hpp"       // what the exporters need of a design
#include "quadtune/workbench/export/gains_export.hpp"         // gains from files, exported again
#include "quadtune/workbench/export/source_export.hpp"        // any source to any format
#include "quadtune/workbench/export/written_exports.hpp"      // the exports of a design
#include "quadtune/workbench/files/file_kind.hpp"             // what a file is
#include "quadtune/workbench/firmware/firmware_gains.hpp"  // gains within the margins of a firmware
#include "quadtune/workbench/firmware/firmware_import.hpp"    // margins of a firmware's parameters
#include "quadtune/workbench/firmware/firmware_law.hpp"       // a firmware's loops as a law
#include "quadtune/workbench/flight/diagnosis.hpp"            // why a flight failed
#include "quadtune/workbench/flight/error_quantiles.hpp"      // quantiles of an error over a flight
#include "quadtune/workbench/flight/filter_covariance.hpp"    // covariance of the best filter
#include "quadtune/workbench/flight/flight_difference.hpp"    // two flights compared
#include "quadtune/workbench/flight/flight_options.hpp"       // how a mission is flown, in words
#include "quadtune/workbench/flight/flight_plan.hpp"          // from options to a flight setup
#include "quadtune/workbench/flight/fly.hpp"                  // flies a mission and judges it
#include "quadtune/workbench/flight/predicted_rms.hpp"        // motion caused by sensor noise
#include "quadtune/workbench/flight/sensor_bound.hpp"         // what sensors can measure
#include "quadtune/workbench/flight/widened_limits.hpp"       // limits that no filter could keep
#include "quadtune/workbench/flown/flown_box.hpp"             // an uncertainty box, searched
#include "quadtune/workbench/flown/flown_check.hpp"           // whether laws stabilize
#include "quadtune/workbench/flown/flown_family.hpp"          // the plants of a vehicle
#include "quadtune/workbench/flown/flown_gains.hpp"           // gains of a given structure
#include "quadtune/workbench/flown/flown_loop.hpp"            // the loop as it flies
#include "quadtune/workbench/flown/flown_lqi.hpp"             // the default LQI
#include "quadtune/workbench/flown/flown_periods.hpp"         // one law at several control periods
#include "quadtune/workbench/flown/flying_loop.hpp"           // the loop of a state feedback
#include "quadtune/workbench/link/send_link.hpp"              // sends commands to a Mambo
#include "quadtune/workbench/logs/allan_of_log.hpp"           // Allan deviation of a log
#include "quadtune/workbench/logs/filter_choice.hpp"          // a filter with fixed values
#include "quadtune/workbench/logs/imu_calibration.hpp"        // calibration from logs
#include "quadtune/workbench/logs/noise_evidence.hpp"         // before and after tuning
#include "quadtune/workbench/logs/noise_logs.hpp"             // logs as samples of a filter model
#include "quadtune/workbench/logs/sensor_log.hpp"             // channels of a sensor
#include "quadtune/workbench/logs/tuned_noise.hpp"            // covariances from logs
#include "quadtune/workbench/missions/flown_evidence.hpp"     // flown loops of tuned gains
#include "quadtune/workbench/sampling/method_comparison.hpp"  // methods of sampling compared
#include "quadtune/workbench/sampling/sampled_plant.hpp"      // a plant sampled by a method
#include "quadtune/workbench/schedule/schedule_axes.hpp"      // a grid, from text
#include "quadtune/workbench/schedule/schedule_report.hpp"    // a gain schedule with its notes
#include "quadtune/workbench/systems/matrix_loop.hpp"         // loops of matrices, measured loops
#include "quadtune/workbench/systems/matrix_lqr.hpp"          // LQI and LQG of matrices
#include "quadtune/workbench/systems/pid_report.hpp"          // PID gains for a transfer function
#include "quadtune/workbench/systems/system_report.hpp"       // poles, zeros and norms
#include "quadtune/workbench/vehicle/new_vehicle.hpp"         // a vehicle file from measurements
#include "quadtune/workbench/vehicle/quantity.hpp"            // a quantity with its unit, from text
#include "quadtune/workbench/vehicle/vehicle_check.hpp"       // whether a vehicle can fly
#include "quadtune/workbench/verify/certify.hpp"              // proof of stability of an export
#include "quadtune/workbench/verify/changed_export.hpp"       // whether an export was edited
#include "quadtune/workbench/verify/uncertain_range.hpp"      // an uncertain range, from text
#include "quadtune/workbench/verify/verify_design.hpp"        // an export compared with its design
#include "quadtune/workbench/verify/verify_directory.hpp"     // an export, read back and checked
#include "quadtune/workbench/verify/verify_evidence.hpp"      // evidence computed again
