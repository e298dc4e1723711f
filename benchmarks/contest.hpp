// SPDX-License-Identifier: Apache-2.0
/// quadtune against its peers on the same problem in the same run, and the table that tells who
/// won.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace quadtune::bench {

/// One solver on one problem.
struct Contestant {
  std::string name;                  ///< e.g. "SB02MD scaled"
  bool ours = false;                 ///< quadtune's, not a peer
  std::function<bool()> run;         ///< solves once; false when the solver reports failure
  std::function<double()> residual;  ///< of the last result; the same formula for all of a contest
};

/// One problem and the goal that quadtune set itself on it.
struct Contest {
  std::string name;       ///< e.g. "care random n=12"
  double goal_ratio = 0;  ///< time of the fastest peer over ours; 0: no goal, for information
  /// Our residual must not exceed this, nor ten times the smallest residual of the peers.
  double goal_residual = std::numeric_limits<double>::infinity();
  /// Part of a peer's name: the goal is against the peers that have it; empty: against all.
  std::string rival;
  std::vector<Contestant> contestants;  ///< the first that is ours is the one that is judged
};

/// Runs all contests under Google Benchmark with randomly interleaved repetitions, prints the
/// medians and then a Markdown table.
///
/// @param argc, argv  of main(): options of Google Benchmark; those given win over the defaults.
/// @return  exit status of the program: 0, or 2 for an unknown option
int run(const std::vector<Contest>& contests, int argc, char** argv);

}  // namespace quadtune::bench
