// SPDX-License-Identifier: Apache-2.0
/// Proves an export by reading it back as the flight program would.
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

/// One question and its answer.
struct VerifyCheck {
  std::string name;  ///< e.g. "files match the manifest"
  bool ok = false;
  std::string detail;  ///< what was found, on one line
};

/// All questions. The verdict is yes only if every answer is.
struct VerifyReport {
  std::vector<VerifyCheck> checks;
  std::optional<Gains> gains;  ///< as read from the files; empty if they could not be read
  std::optional<CascadeDesign> cascade;  ///< likewise
  Eigen::VectorXcd poles;  ///< of the gains' closed loop; empty if it was not computed

  [[nodiscard]] bool ok() const;
};

/// The vehicle in the states and inputs of an export's gains, about the steady flight that they are
/// for, computed anew.
struct VerifyModel {
  DiscreteLti plant;   ///< in the sample time of the gains
  Eigen::VectorXd x0;  ///< (nx) trim
  Eigen::VectorXd u0;  ///< (nu)
};

/// A file as it is now from which an export may have been made.
struct InputAtHand {
  std::string name;   ///< without folder
  std::string where;  ///< its path, for messages; empty of one that is built in
  std::string bytes;
};

/// What else an export is held against.
struct VerifyFacts {
  /// From the wrench to the 12 states of ned_convention() at hover, in the sample time of the
  /// export's cascade, with the motors' lag; without it the loop of a cascade cannot be right.
  std::optional<DiscreteLti> cascade_plant;
  /// Of several with one name, one has to be the one that the export was made from.
  std::vector<InputAtHand> inputs = {};
};

/// Re-reads an export and asks: is there a manifest, is each listed file as it was written, is no
/// other gain file beside them, are the inputs that are at hand those of the manifest, do the files
/// read as the flight program would read them, are the laws and weights those of the manifest,
/// signals included, is the trim that of `model`, is each closed loop stable under the law as
/// written, and does it have the poles of the manifest. Wrong files give failed checks, not
/// exceptions.
///
/// @param model  of the manifest's gains; without it neither trim nor loop can be right
/// @throws FileError  if `directory` is not a directory.
[[nodiscard]] VerifyReport verify_export(const std::filesystem::path& directory,
                                         const std::optional<VerifyModel>& model,
                                         const VerifyFacts& facts = {});

/// Writes the files of an export again, from the laws of its manifest and the vehicle, and compares
/// them byte by byte. An export for a vehicle of another name is not right. Of an export that
/// another version wrote the detail says that nothing was compared.
/// @return  one check; none for a kind of export that cannot be written again
[[nodiscard]] std::vector<VerifyCheck> written_again_checks(const std::filesystem::path& directory,
                                                            const Vehicle& vehicle);

/// The first of `expected` that differs from the file of its name in `directory`, with the line;
/// "" where none does.
/// @param source  what the expected files were made from, for the message: "… differs from what
///                SOURCE give"
/// @throws FileError, InvalidInput  for a file that cannot be read
[[nodiscard]] std::string file_difference(const std::filesystem::path& directory,
                                          const std::vector<FileContent>& expected,
                                          const std::string& source);

/// Largest distance when each pole is paired with the nearest that is left; infinite where there
/// are more of one than of the other.
[[nodiscard]] double pole_distance(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b);

/// Poles of the same files and vehicle on another machine agree to about 1e-12; one gain that is
/// off by a thousandth moves them by more than this.
inline constexpr double kPoleTolerance = 1e-7;

/// Poles of the law with the plant. The integrals advance by dt times the error each sample.
///
/// @param plant  states and inputs named as the gains', in any order of states
/// @return       (nx + ni) sorted by real, then imaginary part
/// @throws InvalidInput  if the plant lacks a state or has other inputs.
[[nodiscard]] Eigen::VectorXcd closed_loop_poles(const DiscreteLti& plant, const Gains& gains);

/// The same of a cascade, all its loops closed.
/// @param plant  as VerifyFacts::cascade_plant
[[nodiscard]] Eigen::VectorXcd closed_loop_poles(const DiscreteLti& plant,
                                                 const CascadeDesign& cascade);

}  // namespace quadtune
