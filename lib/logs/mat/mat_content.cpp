// SPDX-License-Identifier: Apache-2.0
#include "logs/mat/mat_content.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "logs/formats/log_lines.hpp"
#include "logs/mat/mat_elements.hpp"
#include "logs/mat/mat_inner_names.hpp"
#include "logs/mat/mat_tables.hpp"
#include "logs/mat/mat_variable.hpp"
#include "logs/mat/memory_file.hpp"
#include "quadtune/errors.hpp"

namespace quadtune::internal {
namespace {

constexpr std::size_t kHeaderSize = 128;  // [bytes]
constexpr std::size_t kTagSize = 8;       // [bytes]
constexpr std::size_t kKindSize = 520;    // [bytes] that tell MAT v5 from v7.3
constexpr std::uint32_t kMatrix = 14;
constexpr std::uint32_t kCompressed = 15;

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

// Inflates a whole stream; "" where it is damaged or larger than `most`. zlib compares its
// checksum.
std::string inflated(const std::string& compressed, std::size_t most) {
  z_stream z{};
  if (inflateInit(&z) != Z_OK) return "";
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data()));
  z.avail_in = static_cast<uInt>(compressed.size());
  std::string bytes;
  int status = Z_OK;
  while (status == Z_OK && bytes.size() <= most) {
    constexpr std::size_t kStep = std::size_t{1} << 20U;
    const std::size_t done = bytes.size();
    bytes.resize(done + kStep);
    z.next_out = reinterpret_cast<Bytef*>(bytes.data() + done);
    z.avail_out = static_cast<uInt>(kStep);
    status = inflate(&z, Z_NO_FLUSH);
    bytes.resize(done + kStep - z.avail_out);
    if (status == Z_OK && z.avail_in == 0 && z.avail_out > 0) break;  // it wants more than there is
  }
  inflateEnd(&z);
  return status == Z_STREAM_END && bytes.size() <= most ? bytes : "";
}

class Decoder {
 public:
  Decoder(ByteStream& stream, std::size_t most) : stream_(stream), most_(most) {}

  MatContent content() {
    require_mat_header(stream_.peek(kKindSize), stream_.name());
    header_ = stream_.peek(kHeaderSize);
    stream_.skip(kHeaderSize);
    while (read_element()) {
    }
    LogCondition& condition = content_.condition;
    if (variables_.empty() && !condition.whole())
      throw InvalidInput("", (condition.torn.empty() ? condition.first_skipped : condition.torn) +
                                 "; no variable can be read");
    content_.tables = tables_of(variables_, condition.notes);
    return std::move(content_);
  }

 private:
  [[nodiscard]] std::string at(std::uint64_t offset, std::string_view what) const {
    return fmt::format("{}: {} at offset {}", stream_.name(), what, offset);
  }

  // The next element with its tag; false at the end of what can be read.
  bool read_element() {
    const std::uint64_t start = stream_.offset();
    const std::string_view head = stream_.peek(kTagSize);
    if (head.empty()) return false;
    const Tag tag = head.size() < kTagSize ? Tag{} : tag_at(head);
    std::string element;
    if (head.size() < kTagSize || !read_bytes(kTagSize + tag.size, element)) {
      content_.condition.torn = at(start, "the file ends within a variable");
      return false;
    }
    // Uncompressed elements are padded to eight bytes.
    if (tag.type != kCompressed) stream_.skip((8 - tag.size % 8) % 8);
    if (tag.type == kCompressed) {
      element = inflated(element.substr(kTagSize), most_);
      if (element.size() < kTagSize) {
        skip_record(content_.condition, at(start, "a compressed variable is damaged or too large"));
        return true;
      }
    }
    if (tag_at(element).type == kMatrix)
      read_variable(element, start);
    else
      skip_record(content_.condition, at(start, "an element that is no variable"));
    return true;
  }

  bool read_bytes(std::size_t count, std::string& bytes) {
    while (bytes.size() < count) {
      const std::string_view part =
          stream_.peek(std::min(count - bytes.size(), ByteStream::kWindow));
      if (part.empty()) return false;
      bytes.append(part);
      stream_.skip(part.size());
    }
    return true;
  }

  // As a file of its own, so that matio sees nothing that was not checked.
  void read_variable(const std::string& element, std::uint64_t start) {
    try {
      require_mat_v5(header_ + element, at(start, "a variable"));
    } catch (const InvalidInput& damage) {
      skip_record(content_.condition, damage.what());
      return;
    }
    const MemoryFile file;
    file.write(header_ + without_inner_names(element));
    const MatFile mat(Mat_Open(file.path().c_str(), MAT_ACC_RDONLY));
    MatVariable variable(mat ? Mat_VarReadNext(mat.get()) : nullptr);
    if (variable)
      variables_.push_back(std::move(variable));
    else
      skip_record(content_.condition, at(start, "matio cannot read a variable"));
  }

  ByteStream& stream_;
  std::size_t most_;
  std::string header_;
  std::vector<MatVariable> variables_;
  MatContent content_;
};

}  // namespace

MatContent decode_mat(ByteStream& stream, std::size_t most) {
  return Decoder(stream, most).content();
}

}  // namespace quadtune::internal
