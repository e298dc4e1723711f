// SPDX-License-Identifier: Apache-2.0
/// Cases: a mutated input with the commands that read it, and the checks of their results.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "kinds.hpp"
#include "run_program.hpp"

namespace quadtune::mutations {

struct Case {
  std::uint64_t seed = 0;
  std::uint64_t number = 0;
  std::string kind;
  Files files;
  std::vector<Command> commands;  ///< "@" stands for the folder of the files
};

/// Generates cases; a case depends only on its seed and number.
class Cases {
 public:
  Cases(std::vector<Kind> kinds, std::map<std::string, std::vector<std::string>> options,
        std::uint64_t seed);

  [[nodiscard]] Case make(std::uint64_t number) const;
  [[nodiscard]] const Kind& kind_of(std::uint64_t number) const;
  [[nodiscard]] const std::vector<Kind>& kinds() const { return kinds_; }
  /// The unchanged inputs: case i is sample i of all, with all its commands.
  [[nodiscard]] std::vector<Case> unchanged() const;

 private:
  std::vector<Kind> kinds_;
  std::map<std::string, std::vector<std::string>> options_;
  std::uint64_t seed_;
};

/// The deviation from the documentation in how a command ended; empty if there is none.
/// @param asked_to_stop  whether a signal was sent
/// @param files          its files: a text `nan` in one may be printed
[[nodiscard]] std::string complaint(const Command& command, const testing::ProgramResult& result,
                                    bool asked_to_stop, const Files& files = {});

/// A command as it would be typed, "@" replaced.
[[nodiscard]] std::string typed(const Command& command, const std::string& folder);

/// The command on a folder: the program's, or the library's where the first word is "(library)".
[[nodiscard]] testing::ProgramResult run_command(const Command& command, const std::string& folder);

}  // namespace quadtune::mutations
