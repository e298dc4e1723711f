// SPDX-License-Identifier: Apache-2.0
/// In this process, so that the fuzzer sees what the child does: the guard is for what it misses.
#include "fuzz_log.hpp"
#include "logs/mat/mat_content.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kMost = std::size_t{1} << 22U;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  quadtune::internal::ByteStream stream(bytes, "f");
  try {
    const quadtune::internal::MatContent content = quadtune::internal::decode_mat(stream, kMost);
    for (const quadtune::internal::MatTable& table : content.tables) {
      for (const std::vector<double>& column : table.columns)
        quadtune::fuzz::require(column.size() == table.rows(), "columns have one length");
      quadtune::fuzz::require(table.time.empty() || table.time.size() == table.rows(),
                              "the clock has a time for each row");
    }
  } catch (const quadtune::InvalidInput&) {
  }
  return 0;
}
