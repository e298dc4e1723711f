// SPDX-License-Identifier: Apache-2.0
/// A temporary folder for a program that is compiled.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

#include "quadtune/errors.hpp"

namespace quadtune::exports {

/// A folder that goes away with the object.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::error_code error;
    const std::filesystem::path temporary = std::filesystem::temp_directory_path(error);
    if (error) throw FileError("TMPDIR", "names no directory, expected one for temporary files");
    std::string pattern = (temporary / "quadtune-c-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr)
      throw FileError(pattern, "no temporary directory can be made here");
    path_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace quadtune::exports
