// SPDX-License-Identifier: Apache-2.0
/// Handling of SIGINT, SIGTERM and SIGHUP. They set a flag that long computations poll. Whatever
/// does not poll it in time (a computation of a library, a read from an idle pipe) is ended from
/// outside: a timer prints `interrupted` and ends the process with status 130, unless files are
/// being written.
#pragma once

#include <string>

namespace quadtune::cli {

/// For main(). A second signal ends the process at once, except while files are being written.
void install_signal_handlers();

/// True after a signal; long computations and file writing poll it.
[[nodiscard]] bool interrupted();

/// While an object exists, no signal ends the process, so that files are written completely or
/// removed again. For work that polls interrupted() or is short.
class WritingFiles {
 public:
  WritingFiles();
  ~WritingFiles();
  WritingFiles(const WritingFiles&) = delete;
  WritingFiles& operator=(const WritingFiles&) = delete;
};

/// While an object exists, the first signal does not end the process: the work polls interrupted()
/// and then prints and writes the best result so far. A message says so; a second signal ends the
/// process.
class KeepsTheBest {
 public:
  KeepsTheBest();
  ~KeepsTheBest();
  KeepsTheBest(const KeepsTheBest&) = delete;
  KeepsTheBest& operator=(const KeepsTheBest&) = delete;
};

/// Sets what the timer prints before it ends the process.
/// @param line  for standard error, without a line feed
/// @param json  for standard output unless something has been written there; empty: nothing
void set_last_words(const std::string& line, const std::string& json);

/// Claims the last words: the program prints its own and ends normally.
void take_last_words();

/// Records that something has been written to standard output.
void standard_output_has_begun();

}  // namespace quadtune::cli
