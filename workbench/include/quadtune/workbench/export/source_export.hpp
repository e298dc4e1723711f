// SPDX-License-Identifier: Apache-2.0
/// Exports of any source, as `quadtune export` requests them.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "quadtune/design/firmware_options.hpp"
#include "quadtune/exports/content.hpp"
#include "quadtune/exports/export.hpp"

namespace quadtune {

/// What to export, and to which format.
struct SourceExport {
  /// Directory of an export, file of gains, design file, vehicle (its default cascade) or, for
  /// flight code, table of a gain schedule.
  std::string source;
  std::string to;       ///< format, e.g. "json" or "px4"
  std::string vehicle;  ///< name or file; empty: the vehicle that the source names

  std::string name;       ///< flight code: prefix of its names; empty: the default
  std::string precision;  ///< flight code: "float" or "double"; empty: the default
  std::string law;        ///< flight code: "cascaded-pid" or "state-feedback"; empty: the only one
  std::string adapter;    ///< flight code: board to connect to; empty: none

  FirmwareOptions firmware;     ///< parameters of a firmware: its version and set-up
  std::string imu_calibration;  ///< uquad: file of the calibrated sensors; empty: none
  bool constants = false;       ///< uquad: whether to write a header of the vehicle's constants

  /// Exports although there are reasons against it, which the manifest records.
  bool force = false;
};

/// The content of an export.
struct PreparedExport {
  ExportKind kind;                    ///< of the target
  ExportContent content;              ///< for write_export()
  std::vector<std::string> notes;     ///< what the target program changes of the gains
  std::vector<std::string> warnings;  ///< reasons against the export that `force` overrode
  /// Whether only what the files of the source hold is exported: no weights and Kalman filters.
  bool of_files = false;
};

/// An export that must not be written.
class ExportRefused : public std::runtime_error {
 public:
  /// @param why       the reason, with the source or the vehicle
  /// @param where     the source or the vehicle
  /// @param forcible  whether SourceExport::force overrides the reason
  ExportRefused(const std::string& why, std::string where, bool forcible)
      : std::runtime_error(why), where_(std::move(where)), forcible_(forcible) {}

  /// The source or the vehicle.
  [[nodiscard]] const std::string& where() const { return where_; }
  /// Whether SourceExport::force overrides the reason.
  [[nodiscard]] bool forcible() const { return forcible_; }

 private:
  std::string where_;
  bool forcible_;
};

/// Reads the source, solves it if it is a design, and converts the gains to the convention of the
/// target program. Writes nothing; write_export() writes the content.
/// @throws OptionError    naming the member of the request that is wrong, or that does not apply to
///                        the format or the source, e.g. "filter-noise"
/// @throws ExportRefused  if a loop is unstable, if a design does not pass, if its covariances are
///                        not confirmed, if the source was forced, or if margins are too small for
///                        the firmware
/// @throws InvalidInput, FileError, NoSolution  as run_design(), read_laws() and schedule_content()
[[nodiscard]] PreparedExport prepare_export(const SourceExport& request);

}  // namespace quadtune
