// SPDX-License-Identifier: Apache-2.0
/// What is thrown when a caller or a file is at fault. A numerical outcome is never thrown by a
/// solver: it is a status in its result. What goes several steps at once throws NoSolution.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace quadtune {

/// A caller's mistake: a bad argument or a bad line of a file. what() reads
/// "<where>: <what came>, expected <what>, because <why>" on one line.
class InvalidInput : public std::invalid_argument {
 public:
  /// @param where    "file:line", an option, or the function and argument; may be empty.
  /// @param message  What came, what was expected and why, without a final full stop.
  InvalidInput(const std::string& where, const std::string& message);

  /// @return  the place alone, as it stands at the start of what().
  [[nodiscard]] const std::string& where() const { return where_; }
  /// @return  what() without the place, for who knows a better one.
  [[nodiscard]] const std::string& message() const { return message_; }

 protected:
  /// For a message that names its place in its own words.
  struct Whole {};
  InvalidInput(Whole, std::string where, const std::string& message)
      : std::invalid_argument(message), where_(std::move(where)), message_(message) {}

 private:
  std::string where_;
  std::string message_;
};

/// An option's word or number that cannot be taken, wherever it was written. what() begins with the
/// option's key, so that who knows the place puts it before: "quadtune fly: --" of a command line,
/// "file:line: " of a file.
class OptionError : public InvalidInput {
 public:
  /// @param option   its key, e.g. "estimator"; with a word after it where that alone is refused,
  ///                 e.g. "flow simplified"
  /// @param message  e.g. "sensors is 'x', expected ideal or real"
  OptionError(std::string option, const std::string& message)
      : InvalidInput(Whole{}, std::move(option), message) {}

  [[nodiscard]] const std::string& option() const { return where(); }
};

/// No solution exists or none was found; the message names the culprit.
class NoSolution : public std::runtime_error {
 public:
  /// @param where  the option, file or vehicle that asked for it, for scripts.
  NoSolution(const std::string& message, std::string where)
      : std::runtime_error(message), where_(std::move(where)) {}

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
