// SPDX-License-Identifier: Apache-2.0
/// Gains that were designed, tuned, exported and verified, as text and JSON. The results are only
/// declared here; include the header of a result to use it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/flight_condition.hpp"
#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/lti.hpp"

namespace quadtune {
struct DesignOutcome;
struct ExportContent;
struct FlownGains;
struct FlownLoop;
struct GainMatch;
struct GainSchedule;
struct Gains;
struct GainsDiff;
struct KalmanResult;
struct LqgReport;
struct LqiReport;
struct LqrReport;
struct ManifestFile;
struct MarginsReport;
struct MatrixReport;
struct MissionDiagnoses;
struct StoredEstimator;
struct Vehicle;
struct VehicleLqrReport;
struct VerifyReport;
struct WrittenExport;
}  // namespace quadtune

namespace quadtune::report {

/// A design, for `design`.
[[nodiscard]] internal::Json design_json(const DesignOutcome& outcome,
                                         const MissionDiagnoses& diagnoses,
                                         const std::vector<WrittenExport>& written);
[[nodiscard]] std::string design_text(const DesignOutcome& outcome,
                                      const MissionDiagnoses& diagnoses,
                                      const std::vector<WrittenExport>& written);

/// LQR gains of matrices, with their evidence.
/// @param report  solved
[[nodiscard]] internal::Json to_json(const LqrReport& report);
[[nodiscard]] std::string to_text(const LqrReport& report);
/// LQR gains of a vehicle at a trim; the JSON contains the law in the format of `fly --gains`.
[[nodiscard]] internal::Json to_json(const VehicleLqrReport& report);
[[nodiscard]] std::string to_text(const VehicleLqrReport& report);

/// LQI gains that were designed on the flown plant, with their evidence.
[[nodiscard]] internal::Json to_json(const LqiReport& report, const Vehicle& vehicle);
[[nodiscard]] std::string to_text(const LqiReport& report);
/// The same together with the filter, and the deviations that sensor noise causes.
[[nodiscard]] internal::Json to_json(const LqgReport& report, const Vehicle& vehicle);
[[nodiscard]] std::string to_text(const LqgReport& report);

/// Gains of a given structure, for programs that store only matrices, with their evidence.
[[nodiscard]] internal::Json to_json(const MatrixReport& report, const Vehicle& vehicle);
[[nodiscard]] std::string to_text(const MatrixReport& report);

/// The margins of each group of axes on each plant of the family that the gains were designed for.
[[nodiscard]] internal::Json family_json(const FlownGains& flown);
[[nodiscard]] std::string family_text(const FlownGains& flown);

/// Shared by the laws of the flown plant: the gains with their names, the flown loop and the ideal
/// one, and the law in the format of `fly --gains`.
void add_gains(internal::Json& json, const Gains& gains);
void add_loops(internal::Json& json, const FlownLoop& flown, const MarginsReport& ideal);
void add_export(internal::Json& json, const Vehicle& vehicle, const Gains& gains,
                const std::optional<StoredEstimator>& estimator);
/// Adds the keys by which read_laws() recognizes laws in the JSON output of a command: "format",
/// "format_version", and "gains", "cascade" and "estimator" if `content` has them.
void add_laws(internal::Json& json, const ExportContent& content);

/// A steady-state Kalman filter for matrices.
/// @param dt  sample period [s]; 1 for a discrete model without one; 0 for a continuous filter
[[nodiscard]] internal::Json to_json(const KalmanResult& result, double dt);
[[nodiscard]] std::string to_text(const KalmanResult& result, double dt);

/// Gains over a grid of trims: the grid, how many points have a gain, and the first of these gains.
/// The JSON of a schedule is its table: schedule_text().
/// @param schedule  with at least one gain
[[nodiscard]] std::string to_text(const GainSchedule& schedule);

/// Weights that were computed for a gain.
struct GainMatchReport {
  const Vehicle& vehicle;
  const std::string& vehicle_word;  ///< a built-in vehicle, or its file
  FlightCondition flight;           ///< the trim at which the plant is linearized
  const std::string& file;          ///< file of the gains
  const Eigen::MatrixXd& K;
  const Eigen::MatrixXd& K_int;
  const GainMatch& match;
  double tolerance;
};

[[nodiscard]] internal::Json to_json(const GainMatchReport& report);
[[nodiscard]] std::string to_text(const GainMatchReport& report);

/// A design file with the weights, and with the given gain as the published one, so that `quadtune
/// design` reports the difference.
/// @param path     file that it will be written to; a vehicle file is named relative to it
/// @param command  for the first line
[[nodiscard]] std::string design_file(const GainMatchReport& report, const std::string& path,
                                      const std::string& command);

/// Files that were written for another program: [{"path": …, "sha256": …}, …], or one line for each
/// file, as sha256sum prints it.
/// @param directory  of the files
[[nodiscard]] internal::Json to_json(const std::vector<ManifestFile>& files);
[[nodiscard]] std::string to_text(const std::vector<ManifestFile>& files,
                                  const std::string& directory);

/// The checks of an export: for `verify`, `design` and `certify`.
[[nodiscard]] internal::Json to_json(const VerifyReport& report);
[[nodiscard]] std::string to_text(const VerifyReport& report);

/// Where two sets of gains differ; as text, a table of the entries that differ most.
[[nodiscard]] internal::Json to_json(const GainsDiff& difference);
[[nodiscard]] std::string to_text(const GainsDiff& difference);

}  // namespace quadtune::report
