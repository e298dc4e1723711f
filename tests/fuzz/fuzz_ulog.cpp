// SPDX-License-Identifier: Apache-2.0
#include "fuzz_log.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  quadtune::fuzz::read(data, size, "ulog");
  return 0;
}
