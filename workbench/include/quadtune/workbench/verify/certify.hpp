// SPDX-License-Identifier: Apache-2.0
/// Whether the loops of an export are stable for every vehicle of an uncertainty box: a proof, and
/// a search for an unstable vehicle.
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

/// The uncertainty box, the laws, and limits of the effort.
struct CertifyOptions {
  std::string vehicle;     ///< a name or a file; empty: that of the export's manifest
  std::string controller;  ///< as in controller_kind(); empty: every law of the export
  /// Ratios to the values in the vehicle file; 0 < low ≤ 1 ≤ high. See VehicleUncertainty. None:
  /// the [spread] of the file, or 0.9 to 1.1, 0.8 to 1.2 and 0.9 to 1.1 if the file states none.
  std::optional<UncertainRange> mass = {};
  std::optional<UncertainRange> inertia = {};  ///< of each moment of inertia, likewise
  std::optional<UncertainRange> thrust = {};   ///< of the thrust and the drag torque, likewise
  /// [s], 0 ≤ low ≤ high ≤ kMaxDelayPeriods periods; none: from the delay of the motor commands to
  /// that delay plus its jitter and one control period.
  std::optional<UncertainRange> delay = {};
  /// [s], 0 < low ≤ high ≤ kMaxLag, or {0, 0}; none: the motor lag of the vehicle with the
  /// [spread] of its file.
  std::optional<UncertainRange> lag = {};
  std::optional<PidMethod> integrator = {};  ///< of a cascade; none: that of the export
  bool flown = true;                ///< whether flown loops of the box are analysed as well
  int max_boxes = 20000;            ///< maximum number of boxes of a proof, ≥ 1
  std::uint64_t seed = 1;           ///< of the search
  std::size_t threads = 0;          ///< maximum number of threads; 0: one per processor
  std::function<bool()> stop = {};  ///< called regularly; if it returns true, Interrupted is thrown
};

/// One law of an export.
struct CertifiedLaw {
  std::string name;       ///< "state feedback" or "cascade"
  double dt = 0;          ///< [s]
  LoopFamily family;      ///< the loop as a function of mass, inertia, thrust, lag and delay
  Robustness robustness;  ///< proof and largest box that is proved
  std::optional<FlownBox> flown = {};  ///< none if not requested

  /// Whether a vehicle of the box has a flown loop that grows.
  [[nodiscard]] bool flown_unstable() const {
    return flown && flown->worst && flown->worst->grows();
  }
  /// Whether the proof covers the whole box and applies to the exported law.
  [[nodiscard]] bool proved() const;
  /// Why it is not proved; empty if it is.
  [[nodiscard]] std::string reason() const;
};

/// Verdicts on all laws of an export.
struct CertifyReport {
  std::string directory;                   ///< of the export
  std::string vehicle;                     ///< name
  std::optional<VerifyCheck> failed = {};  ///< failed check of verify_directory() that ended the
                                           ///< certification; then there are no laws
  std::vector<CertifiedLaw> laws = {};     ///< in the order of the manifest

  [[nodiscard]] bool proved() const;  ///< whether the loop of every law is proved stable
  /// "proved", "unstable" if the search found an unstable loop in the box, else "not proved".
  [[nodiscard]] std::string verdict() const;
};

/// Verifies an export, and then certifies each of its selected laws at hover.
///
///     const CertifyReport report = certify("out/uquad-hover");
///     std::cout << report.verdict() << '\n';
///
/// @throws OptionError   if the controller is unknown, or the delay or the lag is too long
/// @throws InvalidInput  if the export has no such law, or the vehicle is unknown
/// @throws FileError, NoSolution, Interrupted
[[nodiscard]] CertifyReport certify(const std::string& directory,
                                    const CertifyOptions& options = {});

/// Describes a vehicle of the box: "mass 0.9, delay 0.01 s"; parameters without width are omitted.
/// @param family  of the law
/// @param values  one for each parameter of the family
[[nodiscard]] std::string describe(const LoopFamily& family, const Eigen::VectorXd& values);

}  // namespace quadtune
