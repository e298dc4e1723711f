// SPDX-License-Identifier: Apache-2.0
/// What is thrown when a caller or a file is at fault. A numerical outcome is never thrown: it is a
/// status in the solver's result.
#pragma once

#include <stdexcept>
#include <string>

namespace quadtune {

/// A caller's mistake: a bad argument or a bad line of a file. what() reads
/// "<where>: <what came>, expected <what>, because <why>" on one line.
class InvalidInput : public std::invalid_argument {
 public:
  /// @param where    "file:line", an option, or the function and argument; may be empty.
  /// @param message  What came, what was expected and why, without a final full stop.
  InvalidInput(const std::string& where, const std::string& message)
      : std::invalid_argument(where.empty() ? message : where + ": " + message), where_(where) {}

  /// @return  the place alone, as it stands at the start of what().
  [[nodiscard]] const std::string& where() const { return where_; }

 private:
  std::string where_;
};

/// A file that could not be read or written, with the system's reason.
class FileError : public std::runtime_error {
 public:
  FileError(const std::string& path, const std::string& message)
      : std::runtime_error(path + ": " + message), path_(path) {}

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// The user asked to stop (SIGINT or SIGTERM) while something was being written.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

}  // namespace quadtune
