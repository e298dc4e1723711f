// SPDX-License-Identifier: Apache-2.0
/// A file read from front to back in constant memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace quadtune::internal {

/// Bytes of a file, of standard input, or in memory. Views stay good until the next call.
class ByteStream {
 public:
  /// The most that can be looked at at once, and the longest line [bytes].
  static constexpr std::size_t kWindow = std::size_t{1} << 20;

  /// @param path  "-" is standard input.
  /// @throws FileError  if it cannot be opened.
  explicit ByteStream(const std::string& path);
  /// @param bytes  Kept as they are, not copied; they must outlive the stream.
  /// @param name   What messages call them.
  ByteStream(std::string_view bytes, std::string name);
  ~ByteStream();
  ByteStream(ByteStream&& other) noexcept;
  ByteStream& operator=(ByteStream&&) = delete;

  /// What messages call it.
  [[nodiscard]] const std::string& name() const { return name_; }
  /// Where the next byte stands.
  [[nodiscard]] std::uint64_t offset() const { return offset_; }
  /// The next bytes, `count` of them (at most kWindow) unless the file ends before.
  /// @throws FileError  if the file cannot be read.
  std::string_view peek(std::size_t count);
  /// Passes over bytes, as many as there are.
  /// @return  how many.
  std::uint64_t skip(std::uint64_t count);

  enum class LineEnd { kFeed, kTorn, kTooLong };
  struct Line {
    std::string_view text;  ///< without the line feed and a carriage return before it
    LineEnd end;            ///< kFeed unless the file ends within, or the line is beyond kWindow
  };
  /// The next line, passed over; nothing at the end of the file.
  std::optional<Line> line();

 private:
  bool fill();  // reads more behind what is there; false at the end

  std::string name_;
  int descriptor_ = -1;
  bool at_end_ = false;
  std::vector<char> buffer_;
  std::string_view ready_;  // read and not passed over
  std::uint64_t offset_ = 0;
};

}  // namespace quadtune::internal
