// SPDX-License-Identifier: Apache-2.0
#include "logs/mat/mat_content.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <deque>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "logs/formats/log_lines.hpp"
#include "logs/mat/mat_elements.hpp"
#include "logs/mat/mat_tables.hpp"
#include "quadtune/errors.hpp"

namespace quadtune::internal {
namespace {

constexpr std::size_t kKindSize = 520;  // [bytes] that distinguish MAT v5 from v7.3

struct Tag {
  std::uint32_t type = 0;
  std::uint32_t size = 0;
};

Tag tag_at(std::string_view bytes) {
  Tag tag;
  std::memcpy(&tag.type, bytes.data(), sizeof tag.type);
  std::memcpy(&tag.size, bytes.data() + sizeof tag.type, sizeof tag.size);
  return tag;
}

// Inflates a whole stream and appends it to `bytes`; false if the stream is damaged. zlib compares
// its checksum. Inflated bytes remain charged even then, which bounds the time spent on damaged
// streams.
bool inflate_behind(std::string& bytes, std::string_view compressed, MemoryBudget& budget) {
  z_stream z{};
  if (inflateInit(&z) != Z_OK) return false;
  const std::unique_ptr<z_stream, decltype(&inflateEnd)> end(&z, inflateEnd);
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data()));
  z.avail_in = static_cast<uInt>(compressed.size());
  int status = Z_OK;
  while (status == Z_OK) {
    constexpr std::size_t kStep = std::size_t{1} << 20U;
    const std::size_t done = bytes.size();
    bytes.resize(done + kStep);
    z.next_out = reinterpret_cast<Bytef*>(bytes.data() + done);
    z.avail_out = static_cast<uInt>(kStep);
    status = inflate(&z, Z_NO_FLUSH);
    bytes.resize(done + kStep - z.avail_out);
    budget.charge(bytes.size() - done);
    if (status == Z_OK && z.avail_in == 0 && z.avail_out > 0) break;  // the stream is truncated
  }
  return status == Z_STREAM_END;
}

class Decoder {
 public:
  Decoder(ByteStream& stream, std::size_t memory_limit) : stream_(stream), budget_(memory_limit) {}

  MatContent content() {
    require_mat_header(stream_.peek(kKindSize), stream_.name());
    header_ = stream_.peek(kMatHeaderSize);
    stream_.skip(kMatHeaderSize);
    while (read_element()) {
    }
    LogCondition& condition = content_.condition;
    if (variables_.empty() && !condition.whole())
      throw InvalidInput("", (condition.torn.empty() ? condition.first_skipped : condition.torn) +
                                 "; no variable can be read");
    content_.tables = tables_of(variables_, budget_, condition.notes);
    return std::move(content_);
  }

 private:
  [[nodiscard]] std::string at(std::uint64_t offset, std::string_view what) const {
    return fmt::format("{}: {} at offset {}", stream_.name(), what, offset);
  }

  // Reads the next element with its tag; false at the end of the readable data.
  bool read_element() {
    const std::uint64_t start = stream_.offset();
    const std::string_view head = stream_.peek(kMatTagSize);
    if (head.empty()) return false;
    const Tag tag = head.size() < kMatTagSize ? Tag{} : tag_at(head);
    const bool compressed = MatType{tag.type} == MatType::compressed;
    std::string element = compressed ? "" : header_;
    if (head.size() < kMatTagSize || !append_bytes(kMatTagSize + tag.size, element)) {
      content_.condition.torn = at(start, "the file ends within a variable");
      return false;
    }
    if (compressed) {
      std::string bytes = header_;
      if (!inflate_behind(bytes, std::string_view(element).substr(kMatTagSize), budget_) ||
          bytes.size() < kMatHeaderSize + kMatTagSize) {
        skip_record(content_.condition, at(start, "a compressed variable is damaged or too large"));
        return true;
      }
      element = std::move(bytes);
    } else {
      stream_.skip((8 - tag.size % 8) % 8);  // padding
      budget_.charge(element.size());
    }
    read_variable(std::move(element), start);
    return true;
  }

  bool append_bytes(std::size_t count, std::string& bytes) {
    for (std::size_t left = count; left > 0;) {
      const std::string_view part = stream_.peek(std::min(left, ByteStream::kWindow));
      if (part.empty()) return false;
      if (bytes.size() + part.size() > budget_.left()) throw std::bad_alloc();
      bytes.append(part);
      left -= part.size();
      stream_.skip(part.size());
    }
    return true;
  }

  // @param bytes  a complete file with header and one variable
  void read_variable(std::string bytes, std::uint64_t start) {
    if (MatType{tag_at(std::string_view(bytes).substr(kMatHeaderSize)).type} != MatType::matrix) {
      skip_record(content_.condition, at(start, "an element that is not a variable"));
      return;
    }
    bytes_.push_back(std::move(bytes));
    try {
      std::vector<MatArray> found = parse_mat(bytes_.back(), at(start, "a variable"), budget_);
      variables_.push_back(std::move(found.front()));
    } catch (const InvalidInput& damage) {
      bytes_.pop_back();
      skip_record(content_.condition, damage.what());
    }
  }

  ByteStream& stream_;
  MemoryBudget budget_;
  std::string header_;
  std::deque<std::string> bytes_;  // of the variables, which contain views of them
  std::vector<MatArray> variables_;
  MatContent content_;
};

}  // namespace

MatContent decode_mat(ByteStream& stream, std::size_t memory_limit) {
  try {
    return Decoder(stream, memory_limit).content();
  } catch (const std::bad_alloc&) {
    throw InvalidInput("", fmt::format("{}: needs more than {} MiB of memory to be read",
                                       stream.name(), memory_limit >> 20U));
  }
}

}  // namespace quadtune::internal
