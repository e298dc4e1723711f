// SPDX-License-Identifier: Apache-2.0
/// Everything that the program reads, with a valid example of each and the commands that read it.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "mutate.hpp"

namespace quadtune::mutations {

/// File names in a folder and their contents.
using Files = std::map<std::string, std::string>;

/// A command line; "@" in it is replaced by the folder.
using Command = std::vector<std::string>;

/// A folder of files that belong together, one of which is changed.
struct Sample {
  Files files;
  std::string target;  ///< the file to change; empty: the command lines are changed
  Format format = Format::words;
  std::vector<Command> commands;  ///< each reads the target, and is done within a second
  /// Updates what depends on the bytes of the target, such as its hash.
  std::function<void(Files&)> mend = {};
};

/// A kind of input.
struct Kind {
  std::string name;
  std::vector<Sample> samples = {};
};

/// All kinds, the same in every call. Some samples are written by the program, into `folder`.
[[nodiscard]] std::vector<Kind> all_kinds(const std::string& folder);

/// The options of each command, by its name, for changed command lines.
[[nodiscard]] std::map<std::string, std::vector<std::string>> options_of_commands();

// The parts of all_kinds().

/// Vehicles, designs, missions, campaigns, requirements, filter models: files that people write.
[[nodiscard]] std::vector<Kind> written_kinds();
/// Matrices and logs.
[[nodiscard]] std::vector<Kind> number_kinds();
/// Files that commands write for others: exports, campaigns, schedules, calibrations.
[[nodiscard]] std::vector<Kind> made_kinds(const std::string& folder);
[[nodiscard]] Kind command_lines();

/// A file of the project.
[[nodiscard]] std::string project_file(const std::string& name);
/// The text with one part replaced.
/// @throws std::runtime_error  if it does not contain the part
[[nodiscard]] std::string with(std::string text, const std::string& part, const std::string& by);
/// `t_s,y[m],az[m/s^2],height[m]`, a synthetic log of a vehicle that moves up and down.
[[nodiscard]] std::string small_log_text();

}  // namespace quadtune::mutations
