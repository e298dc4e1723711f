// SPDX-License-Identifier: Apache-2.0
/// The input of an export.
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

/// Evidence that the gains are right, as reported by the solver. NaN or empty means unknown; such
/// values are omitted from the manifest.
struct ExportEvidence {
  std::string method;  ///< e.g. "sampled-data LQR"
  std::string status;  ///< e.g. "solved"
  /// Relative residual of the solved equation.
  double residual = std::numeric_limits<double>::quiet_NaN();
  /// Reciprocal condition number of the equation.
  double rcond = std::numeric_limits<double>::quiet_NaN();
  int iterations = 0;      ///< iterations of the solver
  Eigen::VectorXcd poles;  ///< poles of the design, as reported by the solver
};

/// Everything that is written to the files and the manifest.
struct ExportContent {
  Vehicle vehicle;             ///< for which the laws were designed
  std::optional<Gains> gains;  ///< in the convention of the target flight program
  Eigen::MatrixXd Q;           ///< weights of states, then integrals, ordered as in `gains`; or
                               ///< empty
  Eigen::MatrixXd R;           ///< weights of the inputs, or empty
  /// The vehicle with the states and inputs of `gains`. The poles of its closed loop are written to
  /// the manifest, where `verify` reads them.
  std::optional<DiscreteLti> plant;
  /// From the wrench to the 12 states of ned_convention(), as the computer of the cascade sees
  /// them. The poles of its closed loop are written to the manifest likewise.
  std::optional<DiscreteLti> cascade_plant;
  std::vector<KalmanFilter> filters;  ///< "altitude" and "velocity" for the Mambo
  /// Diagonals of Q and R of the uquad's filter; empty: none are written.
  std::optional<UquadDiagonals> uquad_filter;
  std::optional<ImuCalibrationFile> imu_calibration;  ///< for the uquad's sensors
  bool uquad_constants = false;          ///< whether to write a header with the vehicle's constants
  std::optional<CascadeDesign> cascade;  ///< PID cascade; empty if there is none
  std::optional<GainSchedule> schedule;  ///< instead of laws; only flight code supports it
  std::optional<StoredEstimator> estimator;    ///< with which the laws were evaluated
  FlightCodeOptions flight_code;               ///< for exports of flight code
  FirmwareOptions firmware;                    ///< for exports of firmware parameters
  std::optional<StoredParameters> parameters;  ///< of a board whose loops `cascade` represents
  /// The parameters of the board from which the cascade was imported. The board keeps the values of
  /// all parameters that an export to its firmware does not list.
  std::optional<StoredParameters> board = {};
  std::vector<std::string> firmware_notes;  ///< changes that the parameters make to the cascade;
                                            ///< set by Exporter::fit
  ExportEvidence evidence;                  ///< of `gains`
  std::vector<std::string> forced;          ///< reasons for rejection that --force overrode
  std::vector<FileContent> inputs;  ///< design and vehicle files: name without path, and bytes
  /// Further libraries: name, version.
  std::vector<std::pair<std::string, std::string>> versions;
  std::string made_at;  ///< time that is written to the manifest; empty (default): none
};

}  // namespace quadtune
