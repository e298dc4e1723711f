// SPDX-License-Identifier: Apache-2.0
/// Whether the loops of an export are stable for every vehicle of a box: a proof, and a search for
/// an unstable one.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/control/pid_method.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/synthesis/robustness.hpp"
#include "quadtune/tuning/uncertain_vehicle.hpp"
#include "quadtune/workbench/flown/flown_box.hpp"

namespace quadtune {

/// The box of vehicles, the laws, and limits of the effort.
struct CertifyOptions {
  std::string vehicle;     ///< a name or a file; empty: that of the export's manifest
  std::string controller;  ///< as controller_kind(); empty: every law of the export
  /// Ratios to the values of the vehicle's file; 0 < low ≤ 1 ≤ high. See VehicleUncertainty. None:
  /// the file's [spread], or where it states none 0.9 to 1.1, 0.8 to 1.2 and 0.9 to 1.1.
  std::optional<UncertainRange> mass = {};
  std::optional<UncertainRange> inertia = {};
  std::optional<UncertainRange> thrust = {};
  /// [s], 0 ≤ low ≤ high ≤ kMostDelayPeriods periods; none: from the delay of the motors' command
  /// to its jitter and one control period more.
  std::optional<UncertainRange> delay = {};
  /// [s], 0 < low ≤ high ≤ kLongestLag, or {0, 0}; none: that of the rotors, with the file's
  /// [spread].
  std::optional<UncertainRange> lag = {};
  std::optional<PidMethod> integrator = {};  ///< of a cascade; none: that of the export
  bool flown = true;                ///< whether flown loops of the box are analysed as well
  int most_boxes = 20000;           ///< that a proof may look at, ≥ 1
  std::uint64_t seed = 1;           ///< of the search
  std::size_t threads = 0;          ///< at most so many; 0: one for each processor
  std::function<bool()> stop = {};  ///< called from time to time; true ends with Interrupted
};

/// One law of an export.
struct CertifiedLaw {
  std::string name;  ///< "state feedback" or "cascade"
  double dt = 0;     ///< [s]
  LoopFamily family;
  Robustness robustness;
  std::optional<FlownBox> flown = {};  ///< none where it was not asked for

  /// Whether a vehicle of the box was found whose flown loop grows.
  [[nodiscard]] bool flown_unstable() const {
    return flown && flown->worst && flown->worst->grows();
  }
  /// Whether the whole box is proved, and means something.
  [[nodiscard]] bool proved() const;
  /// Why not, in words; empty if it is.
  [[nodiscard]] std::string reason() const;
};

struct CertifyReport {
  std::string directory;
  std::string vehicle;                     ///< name
  std::optional<VerifyCheck> failed = {};  ///< of verify_directory(), which ended it: no laws
  std::vector<CertifiedLaw> laws = {};

  [[nodiscard]] bool proved() const;
  /// "proved", "unstable" where a search found such a loop in the box, else "not proved".
  [[nodiscard]] std::string verdict() const;
};

/// Verifies an export, and then certifies each of its laws that was asked for about a hover.
///
///     const CertifyReport report = certify("out/uquad-hover");
///     std::cout << report.verdict() << '\n';
///
/// @throws OptionError   for a controller that is not known, a delay or a lag that is too long
/// @throws InvalidInput  for an export without such a law, or a vehicle that is not built in
/// @throws FileError, NoSolution, Interrupted
[[nodiscard]] CertifyReport certify(const std::string& directory,
                                    const CertifyOptions& options = {});

/// A vehicle of the box in words: "mass 0.9, delay 0.01 s"; parameters without width are left out.
/// @param values  one for each parameter of the family
[[nodiscard]] std::string in_words(const LoopFamily& family, const Eigen::VectorXd& values);

}  // namespace quadtune
