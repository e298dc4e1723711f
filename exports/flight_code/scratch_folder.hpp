// SPDX-License-Identifier: Apache-2.0
/// A temporary folder in which a program is compiled.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

#include "quadtune/errors.hpp"

namespace quadtune::exports {

/// A temporary folder that is deleted with the object.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::error_code error;
    const std::filesystem::path temporary = std::filesystem::temp_directory_path(error);
    if (error)
      throw FileError("TMPDIR", "is not a directory; set it to a directory for temporary files");
    std::string pattern = (temporary / "quadtune-c-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr)
      throw FileError(pattern, "cannot create a temporary directory");
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
