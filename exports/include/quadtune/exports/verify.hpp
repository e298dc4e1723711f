// SPDX-License-Identifier: Apache-2.0
/// Proves an export by reading it back as the flight program would.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/gains.hpp"
#include "quadtune/lti.hpp"

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
  Eigen::VectorXcd poles;      ///< of the closed loop; empty if it was not computed

  [[nodiscard]] bool ok() const;
};

/// The vehicle in the states and inputs of an export's gains, about the steady flight that they are
/// for, computed anew.
struct VerifyModel {
  DiscreteLti plant;   ///< in the sample time of the gains
  Eigen::VectorXd x0;  ///< (nx) trim
  Eigen::VectorXd u0;  ///< (nu)
};

/// Re-reads an export and asks: is there a manifest, is each listed file as it was written, is no
/// other gain file beside them, do the files read as the flight program would read them, are the
/// gains and weights those of the manifest, is the trim that of `model`, is the closed loop with it
/// stable under the sign law as written, and does it have the poles of the manifest. Wrong files
/// give failed checks, not exceptions.
///
/// @param model  of the manifest's gains; without it neither trim nor loop can be right
/// @throws FileError  if `directory` is not a directory.
[[nodiscard]] VerifyReport verify_export(const std::filesystem::path& directory,
                                         const std::optional<VerifyModel>& model);

/// Poles of the law with the plant. The integrals advance by dt times the error each sample.
///
/// @param plant  states and inputs named as the gains', in any order of states
/// @return       (nx + ni) sorted by real, then imaginary part
/// @throws InvalidInput  if the plant lacks a state or has other inputs.
[[nodiscard]] Eigen::VectorXcd closed_loop_poles(const DiscreteLti& plant, const Gains& gains);

}  // namespace quadtune
