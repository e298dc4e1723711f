// SPDX-License-Identifier: Apache-2.0
/// Verifies an export by reading it as the flight program would.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/design.hpp"
#include "quadtune/exports/file_set.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// One check with its result.
struct VerifyCheck {
  std::string name;    ///< e.g. "files match the manifest"
  bool ok = false;     ///< whether the check passes
  std::string detail;  ///< the finding, on one line
};

/// All checks of an export; it passes only if every check passes.
struct VerifyReport {
  std::vector<VerifyCheck> checks;  ///< in the order in which they were made
  std::optional<Gains> gains;       ///< as read from the files; empty if they could not be read
  std::optional<CascadeDesign> cascade;  ///< likewise
  Eigen::VectorXcd poles;  ///< of the gains' closed loop; empty if it was not computed

  [[nodiscard]] bool ok() const;  ///< whether every check passes
};

/// The recomputed vehicle model with the states and inputs of an export's gains, at the trim of the
/// gains.
struct VerifyModel {
  DiscreteLti plant;   ///< with the sample time of the gains
  Eigen::VectorXd x0;  ///< (nx) trim
  Eigen::VectorXd u0;  ///< (nu)
};

/// The current version of a file from which an export may have been made.
struct InputAtHand {
  std::string name;   ///< without folder
  std::string where;  ///< path for messages; empty for a built-in file
  std::string bytes;  ///< content of the file
};

/// Further data with which an export is compared.
struct VerifyFacts {
  /// From the wrench to the 12 states of ned_convention() at hover, with the sample time of the
  /// export's cascade and the motor lag. Without it, the check of the cascade's loop fails.
  std::optional<DiscreteLti> cascade_plant;
  /// If several have the same name, one of them must be the file from which the export was made.
  std::vector<InputAtHand> inputs = {};
};

/// Reads an export and checks that there is a manifest, each listed file is unchanged, there are no
/// other gain files, the available inputs are those of the manifest, the flight program would
/// accept the files, laws and weights are those of the manifest (including signals), the trim is
/// that of `model`, each closed loop is stable under the law as written, and its poles are those of
/// the manifest. Wrong files give failed checks, not exceptions.
/// @param directory  of the export
/// @param model      for the gains of the manifest; without it, the checks of trim and loop fail
/// @param facts      plant of the cascade and files at hand, with which the export is compared
/// @throws FileError  if `directory` is not a directory
[[nodiscard]] VerifyReport verify_export(const std::filesystem::path& directory,
                                         const std::optional<VerifyModel>& model,
                                         const VerifyFacts& facts = {});

/// Regenerates the files of an export from the laws of its manifest and the vehicle, and compares
/// them byte by byte. The check fails if the export belongs to a vehicle of another name. If
/// another version of quadtune wrote the export, nothing is compared, and the detail says so.
/// @return  one check; none for a kind of export that cannot be regenerated
[[nodiscard]] std::vector<VerifyCheck> written_again_checks(const std::filesystem::path& directory,
                                                            const Vehicle& vehicle);

/// Describes the first file of `expected` that differs from the file of the same name in
/// `directory`, with the line; "" if all agree.
/// @param directory  of the export
/// @param expected   files with names within the directory
/// @param source     origin of the expected files in the message "… differs from what SOURCE give"
/// @throws FileError, InvalidInput  if a file cannot be read
[[nodiscard]] std::string file_difference(const std::filesystem::path& directory,
                                          const std::vector<FileContent>& expected,
                                          const std::string& source);

/// Pairs each pole with the nearest remaining pole and returns the largest distance; infinite if
/// the numbers of poles differ.
[[nodiscard]] double pole_distance(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b);

/// Largest distance at which poles count as equal. For the same files and vehicle they agree
/// between machines to about 1e-12; a change of one gain by 0.1 % moves them by more than this
/// constant.
inline constexpr double kPoleTolerance = 1e-7;

/// Poles of the law with the plant. In each sample, an integral advances by dt times the error.
///
/// @param plant  states and inputs named as in `gains`; states in any order
/// @param gains  discrete, in any convention
/// @return       (nx + ni) sorted by real, then imaginary part
/// @throws InvalidInput  if a state is missing in the plant or the inputs differ
[[nodiscard]] Eigen::VectorXcd closed_loop_poles(const DiscreteLti& plant, const Gains& gains);

/// The same for a cascade with all its loops closed.
/// @param plant    as VerifyFacts::cascade_plant
/// @param cascade  with dt > 0
[[nodiscard]] Eigen::VectorXcd closed_loop_poles(const DiscreteLti& plant,
                                                 const CascadeDesign& cascade);

}  // namespace quadtune
