// SPDX-License-Identifier: Apache-2.0
/// What a user may say of a text: the first line of the input is the list, the rest the text.
#include "fuzz_log.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const std::size_t feed = bytes.find('\n');
  if (feed == std::string_view::npos) return 0;
  quadtune::LogOptions options;
  options.format = "text";
  try {
    options.columns = quadtune::parse_log_columns(std::string(bytes.substr(0, feed)), "--columns");
  } catch (const quadtune::InvalidInput&) {
    return 0;
  }
  quadtune::fuzz::read(bytes.substr(feed + 1), options);
  return 0;
}
