// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/text_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "quadtune/errors.hpp"

namespace quadtune::internal {
namespace {

[[noreturn]] void throw_system_error(const std::string& path) {
  const int error = errno;
  std::string reason = std::strerror(error);
  if (error == EISDIR) reason += ", expected a file";
  throw FileError(path, reason);
}

std::string size_in_words(std::size_t bytes) { return fmt::format("{} MiB", bytes >> 20); }

// Reads at most one byte more than the limit, so that reading an endless device terminates.
std::string read_all(std::FILE* stream, const std::string& path, std::size_t limit) {
  std::string text;
  std::array<char, 65536> block;
  while (text.size() <= limit) {
    const std::size_t got = std::fread(block.data(), 1, block.size(), stream);
    text.append(block.data(), got);
    if (got < block.size()) break;
  }
  if (std::ferror(stream) != 0) throw_system_error(path);
  return text;
}

void require_size(std::size_t size, const std::string& origin, std::size_t limit) {
  if (size > limit)
    throw InvalidInput(origin, fmt::format("is larger than {0} ({1} bytes), expected at most {0}",
                                           size_in_words(limit), limit));
}

std::string origin_of(const std::string& path) { return path == "-" ? "standard input" : path; }

}  // namespace

std::string read_file(const std::string& path, std::size_t limit) {
  std::string bytes;
  if (path == "-") {
    bytes = read_all(stdin, origin_of(path), limit);
  } else {
    const auto close = [](std::FILE* file) { std::fclose(file); };
    const std::unique_ptr<std::FILE, decltype(close)> file(std::fopen(path.c_str(), "rb"), close);
    if (!file) throw_system_error(path);
    bytes = read_all(file.get(), path, limit);
  }
  require_size(bytes.size(), origin_of(path), limit);
  return bytes;
}

std::string read_text_file(const std::string& path, std::size_t limit) {
  std::string text = read_file(path, limit);
  require_text(text, origin_of(path), limit);
  return text;
}

void require_text(std::string_view text, const std::string& origin, std::size_t limit) {
  require_size(text.size(), origin, limit);
  const std::size_t zero = text.find('\0');
  if (zero != std::string_view::npos)
    throw InvalidInput(
        origin,
        fmt::format("has a zero byte at offset {}, expected text; is it a binary file?", zero));
}

std::string printable(std::string_view text, std::size_t longest) {
  std::string clean;
  for (const char c : text.substr(0, longest)) {
    const auto byte = static_cast<unsigned char>(c);
    clean += byte < 0x20 || byte >= 0x7f ? '?' : c;
  }
  return text.size() > longest ? clean + "..." : clean;
}

}  // namespace quadtune::internal
