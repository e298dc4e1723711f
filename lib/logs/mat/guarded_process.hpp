// SPDX-License-Identifier: Apache-2.0
/// Work on bytes that nobody vouches for, in a process of its own with limits.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <functional>
#include <string>

namespace quadtune::internal {

/// What the process may use.
struct ProcessLimits {
  std::size_t memory = 0;  ///< [bytes] of address space; not kept where a sanitizer needs it all
  double time_s = 0;       ///< of the processor; silence may last five times as long
};

/// A child of this process that writes into a pipe. It ends with the object.
class GuardedProcess {
 public:
  /// @param work  Runs in the child with the end of the pipe to write to. It must not throw, and
  ///              what it changes stays in the child.
  /// @throws FileError  if the system gives no process.
  GuardedProcess(const ProcessLimits& limits, const std::function<void(int pipe)>& work);
  ~GuardedProcess();
  GuardedProcess(const GuardedProcess&) = delete;
  GuardedProcess& operator=(const GuardedProcess&) = delete;

  /// Reads exactly `size` bytes.
  /// @return  false where the child wrote fewer: why_ended() tells more.
  bool read(void* bytes, std::size_t size);

  /// Why it wrote no more: "ran into its limit of …", "was ended by signal 11", "ended".
  [[nodiscard]] std::string why_ended();

 private:
  bool wait_for_bytes();

  ProcessLimits limits_;
  pid_t child_ = -1;
  int pipe_ = -1;
  bool silent_ = false;  // it was given up
};

/// Writes all bytes; false where nobody reads any more.
bool write_fully(int pipe, const void* bytes, std::size_t size);

}  // namespace quadtune::internal
