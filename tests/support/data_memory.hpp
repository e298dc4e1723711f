// SPDX-License-Identifier: Apache-2.0
/// Private memory of the process that is not backed by a file.
#pragma once

#include <fstream>
#include <string>

namespace quadtune::testing {

/// [bytes]
inline long data_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "VmData:") {
      long kilobytes = 0;
      status >> kilobytes;
      return kilobytes * 1024;
    }
  return 0;
}

}  // namespace quadtune::testing
