// SPDX-License-Identifier: Apache-2.0
/// A file that only this process sees, for libraries that read and write nothing but named files.
#pragma once

#include <string>

namespace quadtune::internal {

/// An empty file in memory, gone with the object: no disk can be full, nothing is left behind.
class MemoryFile {
 public:
  /// @throws FileError  if the system gives none.
  MemoryFile();
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  /// What to open it by, in this process.
  [[nodiscard]] const std::string& path() const { return path_; }

  /// Replaces what it holds.
  /// @throws FileError  with the system's reason.
  void write(const std::string& bytes) const;

  /// What it holds.
  /// @throws FileError  with the system's reason.
  [[nodiscard]] std::string read() const;

 private:
  int descriptor_;
  std::string path_;
};

}  // namespace quadtune::internal
