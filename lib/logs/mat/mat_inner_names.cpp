// SPDX-License-Identifier: Apache-2.0
// Source: The MathWorks, "MAT-File Format", level 5.
#include "logs/mat/mat_inner_names.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace quadtune::internal {
namespace {

constexpr std::size_t kTagSize = 8;  // [bytes]
constexpr std::uint32_t kInt8 = 1;
constexpr std::uint32_t kMatrix = 14;
constexpr int kNamePart = 2;  // behind flags and dimensions

struct Part {
  std::uint32_t type;
  std::string_view data;
  std::string_view whole;  // with tag and padding
};

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

// The part at the start of `rest`, which moves behind it.
Part next_part(std::string_view& rest) {
  const std::uint32_t type = word_at(rest, 0);
  const bool small = type > 0xffff;  // up to four bytes, in the tag itself
  const std::size_t size = small ? type >> 16U : word_at(rest, 4);
  const std::size_t padded = small ? kTagSize : kTagSize + (size + 7) / 8 * 8;
  const Part part{small ? type & 0xffffU : type, rest.substr(small ? 4 : kTagSize, size),
                  rest.substr(0, padded)};
  rest.remove_prefix(std::min(padded, rest.size()));
  return part;
}

std::string tag(std::uint32_t type, std::size_t size) {
  std::string bytes(kTagSize, '\0');
  const auto length = static_cast<std::uint32_t>(size);
  std::memcpy(bytes.data(), &type, sizeof type);
  std::memcpy(bytes.data() + sizeof type, &length, sizeof length);
  return bytes;
}

// A matrix with its tag.
std::string renamed(std::string_view matrix, bool outermost) {
  std::string body;
  int parts = 0;
  for (std::string_view rest = matrix; rest.size() >= kTagSize; ++parts) {
    const Part part = next_part(rest);
    if (part.type == kMatrix)
      body += renamed(part.data, false);
    else if (parts == kNamePart && !outermost)
      body += tag(kInt8, 0);
    else
      body += part.whole;
  }
  body.resize((body.size() + 7) / 8 * 8, '\0');
  return tag(kMatrix, body.size()) + body;
}

}  // namespace

std::string without_inner_names(std::string_view element) {
  return renamed(next_part(element).data, true);
}

}  // namespace quadtune::internal
