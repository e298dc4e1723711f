// SPDX-License-Identifier: Apache-2.0
/// Runs another program, writes to its standard input and reads its output.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace quadtune::exports {

class Process {
 public:
  /// Starts a program, found by PATH. Its standard error goes where its standard output goes.
  /// @throws FileError  if it cannot be started
  explicit Process(const std::vector<std::string>& words);
  /// Stops it if it still runs.
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// @return  false if the program does not read any more
  [[nodiscard]] bool write(const std::string& text);
  /// The next line without its end; none at the end of what the program says.
  [[nodiscard]] std::optional<std::string> read_line();
  /// Ends its input, reads the rest of what it says, and waits until it ends.
  /// @return  its exit status; 128 and more for a signal; 255 where the system does not tell
  int finish(std::string& said);

 private:
  void close_input();
  [[nodiscard]] bool fill();
  int wait();

  pid_t id_ = -1;
  int in_ = -1, out_ = -1;
  std::string buffer_;
};

/// Whether a program of this name is found by PATH.
[[nodiscard]] bool has_program(const std::string& name);

}  // namespace quadtune::exports
