// SPDX-License-Identifier: Apache-2.0
/// SIGINT, SIGTERM and SIGHUP. They set a flag that long work polls. Whatever does not poll it in
/// time (a library's computation, a read from a pipe in which nothing comes) is ended from outside:
/// a timer says `interrupted` and ends the process with status 130, unless files are being written.
#pragma once

#include <string>

namespace quadtune::cli {

/// For main(). A second signal ends the process at once, files excepted.
void install_signal_handlers();

/// True once a signal came; long work and file writing poll it.
[[nodiscard]] bool interrupted();

/// While one exists no signal ends the process: what is written is written whole or taken back.
/// For work that polls interrupted() or is short.
class WritingFiles {
 public:
  WritingFiles();
  ~WritingFiles();
  WritingFiles(const WritingFiles&) = delete;
  WritingFiles& operator=(const WritingFiles&) = delete;
};

/// While one exists the first signal leaves the process to work that polls interrupted() and then
/// prints and writes the best that it found. The user is told so; a second signal ends the process.
class KeepsTheBest {
 public:
  KeepsTheBest();
  ~KeepsTheBest();
  KeepsTheBest(const KeepsTheBest&) = delete;
  KeepsTheBest& operator=(const KeepsTheBest&) = delete;
};

/// What the timer prints.
/// @param line  for standard error, without a line feed
/// @param json  for standard output unless something is there already; empty: nothing
void set_last_words(const std::string& line, const std::string& json);

/// The program says them itself, as it ends in its own way.
void take_last_words();

/// From now on something is on standard output.
void standard_output_has_begun();

}  // namespace quadtune::cli
