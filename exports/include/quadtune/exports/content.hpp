// SPDX-License-Identifier: Apache-2.0
/// What an export is made from.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "quadtune/design.hpp"
#include "quadtune/exports/file_set.hpp"
#include "quadtune/exports/firmware_names.hpp"
#include "quadtune/exports/flight_code.hpp"
#include "quadtune/exports/imu_calibration_file.hpp"
#include "quadtune/exports/stored_estimator.hpp"
#include "quadtune/exports/uquad.hpp"
#include "quadtune/filter.hpp"
#include "quadtune/gain_schedule.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// That the gains are right, as the solver told it. NaN and empty mean not known; they are left
/// out.
struct ExportEvidence {
  std::string method;  ///< e.g. "sampled-data LQR"
  std::string status;  ///< e.g. "solved"
  double residual = std::numeric_limits<double>::quiet_NaN();
  double rcond = std::numeric_limits<double>::quiet_NaN();
  int iterations = 0;
  Eigen::VectorXcd poles;  ///< of the design, as the solver gave them
};

/// Everything that goes into the files and the manifest.
struct ExportContent {
  Vehicle vehicle;
  std::optional<Gains> gains;  ///< in the convention of the flight program it is written for
  Eigen::MatrixXd Q;           ///< weights of states, then integrals, in the gains' order; or empty
  Eigen::MatrixXd R;           ///< weights of the inputs, or empty
  std::optional<DiscreteLti> plant;  ///< the vehicle in the gains' states and inputs; its closed
                                     ///< loop goes into the manifest, for `verify`
  std::optional<DiscreteLti>
      cascade_plant;  ///< from the wrench to the 12 states of ned_convention(), as the cascade's
                      ///< computer sees them; its closed loop goes into the manifest likewise
  std::vector<KalmanFilter> filters;  ///< "altitude" and "velocity" for the Mambo
  std::optional<UquadDiagonals> uquad_filter;
  std::optional<ImuCalibrationFile> imu_calibration;  ///< of the uquad's sensors
  bool uquad_constants = false;  ///< whether a header of its vehicle's constants is written
  std::optional<CascadeDesign> cascade;
  std::optional<GainSchedule> schedule;      ///< in the place of laws; flight code alone holds one
  std::optional<StoredEstimator> estimator;  ///< that the laws were judged with
  FlightCodeOptions flight_code;             ///< of exports that are flight code
  FirmwareOptions firmware;                  ///< of exports that are a firmware's parameters
  std::optional<StoredParameters> parameters;  ///< of a board, for which `cascade` stands
  std::vector<std::string> firmware_notes;  ///< what these change of the cascade, by Exporter::fit
  ExportEvidence evidence;
  std::vector<std::string> forced;  ///< why it would not have been written without --force
  std::vector<FileContent> inputs;  ///< design and vehicle files: name without path, and bytes
  std::vector<std::pair<std::string, std::string>>
      versions;         ///< of further libraries: name, version
  std::string made_at;  ///< a time to write into the manifest; empty, the default, writes none
};

}  // namespace quadtune
