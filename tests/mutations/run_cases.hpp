// SPDX-License-Identifier: Apache-2.0
/// Runs cases in child processes with limits and reports the results.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "cases.hpp"

namespace quadtune::mutations {

/// The limits of a case. Processor time and not wall time, so that the load of the machine does not
/// matter.
struct Limits {
  double patience_s = 3;  ///< processor time of a command, after which it receives a signal
  double grace_s = 20;    ///< of the processor until it then has to have ended
  double wall_s = 600;    ///< without any sign of life
  std::size_t memory = std::size_t{3} << 30U;  ///< [bytes] of addresses; 0: no limit
};

struct Finding {
  Case of;
  Command command;
  std::string what;
};

/// How often commands ended with each status.
struct Tally {
  std::map<int, std::uint64_t> statuses;
  std::uint64_t cases = 0;
  std::uint64_t commands = 0;
  std::uint64_t stopped = 0;  ///< commands that received a signal
  std::uint64_t findings = 0;
};

struct Run {
  Limits limits = {};
  std::filesystem::path place;  ///< for the files of the cases; emptied at the end
  /// The case with this number.
  std::function<Case(std::uint64_t)> make;
  std::function<testing::ProgramResult(const Command&, const std::string&)> program = run_command;
  std::function<void(const Finding&)> found;
  std::function<bool(std::uint64_t)> wanted = [](std::uint64_t) { return true; };
  std::function<bool()> enough = [] { return false; };  ///< asked between cases
};

/// The selected cases from `from` (inclusive) to `to` (exclusive).
Tally run_cases(const Run& run, std::uint64_t from, std::uint64_t to);

}  // namespace quadtune::mutations
