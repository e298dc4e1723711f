// SPDX-License-Identifier: Apache-2.0
/// Exceptions for errors of callers and of files. Solvers do not throw on a numerical failure: they
/// return a status in their result. Functions that combine several steps throw NoSolution.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace quadtune {

/// Invalid input of a caller: a bad argument or a bad line of a file. what() is one line,
/// "<where>: <what is wrong>, expected <what>, because <why>".
class InvalidInput : public std::invalid_argument {
 public:
  /// @param where    "file:line", an option, or the function and argument; may be empty.
  /// @param message  What is wrong, what was expected and why, without a final full stop.
  InvalidInput(const std::string& where, const std::string& message);

  /// @return  the place alone, as it appears at the start of what().
  [[nodiscard]] const std::string& where() const { return where_; }
  /// @return  what() without the place, for callers that add a more specific place.
  [[nodiscard]] const std::string& message() const { return message_; }

 protected:
  /// Selects the constructor for a message that already contains its place.
  struct Whole {};
  /// Uses the message without adding the place.
  InvalidInput(Whole, std::string where, const std::string& message)
      : std::invalid_argument(message), where_(std::move(where)), message_(message) {}

 private:
  std::string where_, message_;
};

/// A rejected word or number of an option, on a command line or in a file. what() begins with the
/// option's key, so that the caller can put the place in front: "quadtune fly: --" for a command
/// line, "file:line: " for a file.
class OptionError : public InvalidInput {
 public:
  /// @param option   its key, e.g. "estimator"; followed by the rejected word if only that word is
  ///                 rejected, e.g. "flow simplified"
  /// @param message  e.g. "sensors is 'x', expected ideal or real"
  OptionError(std::string option, const std::string& message)
      : InvalidInput(Whole{}, std::move(option), message) {}

  /// The key of the option, e.g. "estimator".
  [[nodiscard]] const std::string& option() const { return where(); }
};

/// No solution exists or none was found; the message names the cause.
class NoSolution : public std::runtime_error {
 public:
  /// @param message  the cause, in one line
  /// @param where    the option, file or vehicle that requested it, for scripts.
  NoSolution(const std::string& message, std::string where)
      : std::runtime_error(message), where_(std::move(where)) {}

  /// The option, file or vehicle that requested the solution.
  [[nodiscard]] const std::string& where() const { return where_; }

 private:
  std::string where_;
};

/// A file that could not be read or written, with the operating system's reason.
class FileError : public std::runtime_error {
 public:
  /// what() is "path: message".
  FileError(const std::string& path, const std::string& message)
      : std::runtime_error(path + ": " + message), path_(path), message_(message) {}

  [[nodiscard]] const std::string& path() const { return path_; }  ///< the file
  /// @return  what() without the path.
  [[nodiscard]] const std::string& message() const { return message_; }

 private:
  std::string path_, message_;
};

/// The user interrupted the program (SIGINT or SIGTERM) while it was writing output.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

}  // namespace quadtune
