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
  /// Starts a program, searched in PATH. Its standard error is merged into its standard output.
  /// @throws FileError  if it cannot be started
  explicit Process(const std::vector<std::string>& words);
  /// Terminates the program if it still runs.
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// @return  false if the program no longer reads its input
  [[nodiscard]] bool write(const std::string& text);
  /// The next line without its end; no value at the end of the output.
  [[nodiscard]] std::optional<std::string> read_line();
  /// Closes its input, reads the rest of its output into `said`, and waits until it ends.
  /// @return  its exit status; 128 and more for a signal; 255 if the system does not report it
  int finish(std::string& said);

 private:
  void close_input();
  [[nodiscard]] bool fill();
  int wait();

  pid_t id_ = -1;
  int in_ = -1, out_ = -1;
  std::string buffer_;
};

/// Whether a program of this name is in PATH.
[[nodiscard]] bool has_program(const std::string& name);

}  // namespace quadtune::exports
