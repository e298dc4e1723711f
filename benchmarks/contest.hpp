// SPDX-License-Identifier: Apache-2.0
/// quadtune against its peers on the same problem in the same run, and a table of the results.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace quadtune::bench {

/// One solver on one problem.
struct Contestant {
  std::string name;                  ///< e.g. "SB02MD scaled"
  bool ours = false;                 ///< whether it is quadtune, not a peer
  std::function<bool()> run;         ///< solves once; false if the solver reports failure
  std::function<double()> residual;  ///< of the last result; the same formula for all contestants
};

/// One problem and the goal of quadtune for it.
struct Contest {
  std::string name;  ///< e.g. "care random n=12"
  /// Ratio of the time of the fastest peer to ours; 0: no goal, for information
  double goal_ratio = 0;
  /// Maximum of our residual, which must not exceed ten times the smallest residual of the peers
  /// either.
  double goal_residual = std::numeric_limits<double>::infinity();
  /// Part of the name of a peer: the goal applies to the peers whose name contains it; empty: to
  /// all.
  std::string rival;
  std::vector<Contestant> contestants;  ///< the first of quadtune is compared with the goal
};

/// Runs all contests under Google Benchmark with randomly interleaved repetitions, prints the
/// medians and then a Markdown table.
///
/// @param argc, argv  of main(): options of Google Benchmark, which override the defaults.
/// @return  exit status of the program: 0, or 2 for an unknown option
int run(const std::vector<Contest>& contests, int argc, char** argv);

}  // namespace quadtune::bench
