// SPDX-License-Identifier: Apache-2.0
#include "quadtune/instruction_set.hpp"

namespace quadtune {

std::string_view instruction_set() {
#if defined(__AVX512F__)
  return "AVX-512";
#elif defined(__AVX2__)
  return "AVX2";
#else
  return "baseline";
#endif
}

}  // namespace quadtune
