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

/// Bytes of a file, of standard input, or in memory. Views are valid until the next call.
class ByteStream {
 public:
  /// Maximum number of bytes that can be peeked, and maximum length of a line [bytes].
  static constexpr std::size_t kWindow = std::size_t{1} << 20;

  /// @param path  "-" is standard input
  /// @throws FileError  if it cannot be opened
  explicit ByteStream(const std::string& path);
  /// @param bytes  not copied; they must outlive the stream
  /// @param name   name of the stream in messages
  ByteStream(std::string_view bytes, std::string name);
  ~ByteStream();
  ByteStream(ByteStream&& other) noexcept;
  ByteStream& operator=(ByteStream&&) = delete;

  /// Name of the stream in messages.
  [[nodiscard]] const std::string& name() const { return name_; }
  /// Offset of the next byte.
  [[nodiscard]] std::uint64_t offset() const { return offset_; }
  /// The next `count` bytes (at most kWindow), or fewer at the end of the file.
  /// @throws FileError  if the file cannot be read
  std::string_view peek(std::size_t count);
  /// Skips `count` bytes, or fewer at the end of the file.
  /// @return  number of bytes skipped
  std::uint64_t skip(std::uint64_t count);

  enum class LineEnd { kFeed, kTorn, kTooLong };
  struct Line {
    std::string_view text;  ///< without the line feed and a preceding carriage return
    /// kFeed unless the file ends within the line, or the line is longer than kWindow
    LineEnd end;
  };
  /// Reads the next line; empty at the end of the file.
  std::optional<Line> line();

 private:
  bool fill();  // reads more bytes after the existing ones; false at the end

  std::string name_;
  int descriptor_ = -1;
  bool at_end_ = false;
  std::vector<char> buffer_;
  std::string_view ready_;  // read and not yet consumed
  std::uint64_t offset_ = 0;
};

}  // namespace quadtune::internal
