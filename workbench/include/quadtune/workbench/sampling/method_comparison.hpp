// SPDX-License-Identifier: Apache-2.0
/// What sampling makes of a vehicle's closed loops: every method at several periods.
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

/// A way to sample a loop, at all periods of the comparison.
struct MethodErrors {
  std::string name;  ///< "tustin"; "run" of the law as it runs, "run, euler" by its integrals
  std::array<std::optional<SamplingError>, 3> errors;  ///< none where the method cannot be had
  double limit = 0;                                    ///< stable up to this period [s]
  double searched = 0;  ///< up to which it was looked for [s]; 0 where a formula gives it
};

/// A law as it runs, on the flown plant at all periods.
struct FlownMethod {
  std::string name;  ///< as MethodErrors
  std::vector<FlownPeriod> periods;
};

/// A law that was designed in continuous time. Channels of its loop are set points and outputs, in
/// the order px, py, pz, yaw.
struct ComparedLaw {
  std::string name;   ///< "lqr", "cascade"
  std::string about;  ///< how it was designed
  ContinuousLti loop;
  DiscreteLti run;  ///< the same as the law runs at MethodComparison::dt, integrals by Euler
  std::string why;  ///< why nothing is compared; empty where something is
  std::vector<MethodErrors> methods = {};
  std::vector<FlownMethod> flown = {};  ///< empty where it was not asked for
};

struct MethodComparison {
  std::string vehicle;              ///< name
  double dt = 0;                    ///< [s]
  std::array<double, 3> periods{};  ///< dt/2, dt, 2 dt [s]
  bool flown = false;               ///< whether the flown plant was asked for
  std::vector<ComparedLaw> laws;    ///< an LQR gain, then the PID cascade
};

/// Compares every method at dt/2, dt and 2 dt, for the loop of an LQR gain and of the PID cascade.
/// @param vehicle  name or file
/// @param dt       [s], > 0
/// @param flown    whether the same laws are judged on the plant that flies as well
/// @throws NoSolution  when the vehicle cannot hover or a law cannot be had
[[nodiscard]] MethodComparison compare_sampling_methods(const std::string& vehicle, double dt,
                                                        bool flown = true);

/// The smallest margins of all loops of a flown loop.
struct LeastMargins {
  double phase = std::numeric_limits<double>::infinity();  ///< [rad]
  double Ms = 0;                                           ///< the greatest
  double disk = 2;
};

[[nodiscard]] LeastMargins least_margins(const FlownLoop& loop);

}  // namespace quadtune
