// SPDX-License-Identifier: Apache-2.0
#include "logs/formats/byte_stream.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "quadtune/errors.hpp"

namespace quadtune::internal {

ByteStream::ByteStream(const std::string& path)
    : name_(path == "-" ? "standard input" : path),
      descriptor_(path == "-" ? ::dup(STDIN_FILENO) : ::open(path.c_str(), O_RDONLY | O_CLOEXEC)),
      buffer_(kWindow) {
  if (descriptor_ < 0) throw FileError(name_, std::strerror(errno));
}

ByteStream::ByteStream(std::string_view bytes, std::string name)
    : name_(std::move(name)), at_end_(true), ready_(bytes) {}

ByteStream::~ByteStream() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

ByteStream::ByteStream(ByteStream&& other) noexcept
    : name_(std::move(other.name_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      at_end_(other.at_end_),
      buffer_(std::move(other.buffer_)),
      ready_(other.ready_),
      offset_(other.offset_) {}

bool ByteStream::fill() {
  if (at_end_ || ready_.size() == buffer_.size()) return false;
  // Move the remaining bytes to the front only when there is no space after them.
  char* const front = buffer_.data();
  const std::size_t used =
      ready_.empty() ? 0 : static_cast<std::size_t>(ready_.data() + ready_.size() - front);
  std::size_t end = used;
  if (ready_.empty() || buffer_.size() - used < buffer_.size() / 4) {
    std::memmove(front, ready_.empty() ? front : ready_.data(), ready_.size());
    ready_ = {front, ready_.size()};
    end = ready_.size();
  }
  while (true) {
    const ssize_t got = ::read(descriptor_, front + end, buffer_.size() - end);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw FileError(name_, std::strerror(errno));
    at_end_ = got == 0;
    ready_ = {ready_.data(), ready_.size() + static_cast<std::size_t>(got)};
    return got > 0;
  }
}

std::string_view ByteStream::peek(std::size_t count) {
  while (ready_.size() < count && fill()) {
  }
  return ready_.substr(0, count);
}

std::uint64_t ByteStream::skip(std::uint64_t count) {
  std::uint64_t left = count;
  while (left > 0) {
    const std::size_t here = std::min<std::uint64_t>(left, ready_.size());
    ready_.remove_prefix(here);
    offset_ += here;
    left -= here;
    if (left > 0 && !fill()) break;
  }
  return count - left;
}

std::optional<ByteStream::Line> ByteStream::line() {
  std::size_t seen = 0;
  while (true) {
    const std::size_t feed = ready_.find('\n', seen);
    if (feed != std::string_view::npos) {
      std::string_view text = ready_.substr(0, feed);
      ready_.remove_prefix(feed + 1);
      offset_ += feed + 1;
      if (text.ends_with('\r')) text.remove_suffix(1);
      return Line{text, LineEnd::kFeed};
    }
    seen = ready_.size();
    if (fill()) continue;
    if (ready_.empty()) return std::nullopt;
    const Line rest{ready_, at_end_ ? LineEnd::kTorn : LineEnd::kTooLong};
    offset_ += ready_.size();
    ready_.remove_prefix(ready_.size());
    return rest;
  }
}

}  // namespace quadtune::internal
