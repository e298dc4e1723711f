// SPDX-License-Identifier: Apache-2.0
/// Everything that the program reads, with a valid example of each and the commands that read it.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "mutate.hpp"

namespace quadtune::mutations {

/// Names in a folder, and their bytes.
using Files = std::map<std::string, std::string>;

/// A command line; "@" in it stands for the folder.
using Command = std::vector<std::string>;

/// A folder of files that belong together, one of which is changed.
struct Sample {
  Files files;
  std::string target;  ///< the file to change; none: the command lines are
  Format format = Format::words;
  std::vector<Command> commands;  ///< each reads the target, and is done within a second
  /// Makes right again what depends on the target's bytes, such as a hash of it.
  std::function<void(Files&)> mend = {};
};

/// A kind of input.
struct Kind {
  std::string name;
  std::vector<Sample> samples = {};
};

/// All kinds, the same at every call. Some samples are written by the program, into `folder`.
[[nodiscard]] std::vector<Kind> all_kinds(const std::string& folder);

/// Options of each command, by its name: what a changed command line may get.
[[nodiscard]] std::map<std::string, std::vector<std::string>> options_of_commands();

// The parts of all_kinds().

/// Vehicles, designs, missions, campaigns, requirements, filter models: what people write.
[[nodiscard]] std::vector<Kind> written_kinds();
/// Matrices and logs.
[[nodiscard]] std::vector<Kind> number_kinds();
/// What commands leave for others: exports, campaigns, schedules, calibrations.
[[nodiscard]] std::vector<Kind> made_kinds(const std::string& folder);
[[nodiscard]] Kind command_lines();

/// A file of the project.
[[nodiscard]] std::string project_file(const std::string& name);
/// The text with one part replaced. @throws std::runtime_error  where it is not there.
[[nodiscard]] std::string with(std::string text, const std::string& part, const std::string& by);
/// `t_s,y[m],az[m/s^2],height[m]`, a made-up log of a vehicle that bobs.
[[nodiscard]] std::string small_log_text();

}  // namespace quadtune::mutations
