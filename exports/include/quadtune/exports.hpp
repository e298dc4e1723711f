// SPDX-License-Identifier: Apache-2.0
/// Files for flight code: exporters, manifests, verification, flight code in C.
#pragma once

#include "quadtune/exports/content.hpp"               // what an export is made from
#include "quadtune/exports/convert.hpp"               // a law in another convention
#include "quadtune/exports/diff.hpp"                  // two gains entry by entry
#include "quadtune/exports/export.hpp"                // writes an export
#include "quadtune/exports/exporter.hpp"              // an exporter of your own
#include "quadtune/exports/file_set.hpp"              // writes all files or none
#include "quadtune/exports/firmware.hpp"              // parameters of autopilot firmware
#include "quadtune/exports/firmware_names.hpp"        // which firmware
#include "quadtune/exports/flight_code.hpp"           // flight code in C99
#include "quadtune/exports/flight_code_check.hpp"     // whether flight code is what was designed
#include "quadtune/exports/imu_calibration_file.hpp"  // imu_calib.txt of the uquad
#include "quadtune/exports/link.hpp"                  // command frames of the Mambo
#include "quadtune/exports/mambo.hpp"                 // files of the Mambo's model project
#include "quadtune/exports/manifest.hpp"              // the manifest of an export
#include "quadtune/exports/read_gains.hpp"            // reads laws from any export
#include "quadtune/exports/schedule_table.hpp"        // gain schedules as files
#include "quadtune/exports/stored_estimator.hpp"      // the estimator that a law was designed with
#include "quadtune/exports/uquad.hpp"                 // gain files of the uquad
#include "quadtune/exports/verify.hpp"                // reads an export back and checks it
