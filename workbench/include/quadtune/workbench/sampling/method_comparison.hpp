// SPDX-License-Identifier: Apache-2.0
/// Effect of sampling on a vehicle's closed loops: every method at several periods.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/discretize/compare.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/workbench/flown/flown_periods.hpp"

namespace quadtune {

/// A sampling method, at all periods of the comparison.
struct MethodErrors {
  std::string name;  ///< e.g. "tustin"; "run" for the implemented law, "run, euler" with its
                     ///< integration method
  std::array<std::optional<SamplingError>, 3> errors;  ///< no value if the method is not applicable
  double limit = 0;                                    ///< stable up to this period [s]
  double searched = 0;  ///< maximum period of the search [s]; 0 if a formula gives the limit
};

/// An implemented law, on the flown plant at all periods.
struct FlownMethod {
  std::string name;                  ///< as MethodErrors
  std::vector<FlownPeriod> periods;  ///< one for each period of MethodComparison
};

/// A law that was designed in continuous time. The channels of its loop are set points and outputs,
/// in the order px, py, pz, yaw.
struct ComparedLaw {
  std::string name;    ///< "lqr", "cascade"
  std::string about;   ///< how it was designed
  ContinuousLti loop;  ///< continuous, cut at the inputs of the plant
  DiscreteLti run;     ///< the loop of the law as implemented with MethodComparison::dt and Euler
                       ///< integrals
  std::string why;     ///< why nothing is compared; otherwise empty
  std::vector<MethodErrors> methods = {};  ///< one for each method
  std::vector<FlownMethod> flown = {};     ///< empty if not requested
};

/// Errors of every method for the laws of a vehicle.
struct MethodComparison {
  std::string vehicle;              ///< name
  double dt = 0;                    ///< [s]
  std::array<double, 3> periods{};  ///< dt/2, dt, 2 dt [s]
  bool flown = false;               ///< whether the flown plant was requested
  std::vector<ComparedLaw> laws;    ///< an LQR gain, then the PID cascade
};

/// Compares every method at dt/2, dt and 2 dt, for the loop of an LQR gain and of the PID cascade.
/// @param vehicle  name or file
/// @param dt       [s], > 0
/// @param flown    whether the same laws are analysed on the flown plant as well
/// @throws NoSolution  if the vehicle cannot hover or a law cannot be computed
[[nodiscard]] MethodComparison compare_sampling_methods(const std::string& vehicle, double dt,
                                                        bool flown = true);

/// The worst margins over all channels of a flown loop.
struct MinMargins {
  double phase = std::numeric_limits<double>::infinity();  ///< [rad]
  double Ms = 0;                                           ///< maximum
  double disk = 2;                                         ///< smallest disk margin alpha
};

/// The worst margins of a loop's channels.
[[nodiscard]] MinMargins min_margins(const FlownLoop& loop);

}  // namespace quadtune
