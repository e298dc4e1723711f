// SPDX-License-Identifier: Apache-2.0
#include "logs/mat/memory_file.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "quadtune/errors.hpp"

namespace quadtune::internal {
namespace {

[[noreturn]] void throw_system_error() {
  throw FileError("a file in memory", std::strerror(errno));
}

// Runs read or write until `size` bytes are through: either may stop early.
template <typename Transfer>
void transfer_all(std::size_t size, const Transfer& transfer) {
  for (std::size_t done = 0; done < size;) {
    const ssize_t count = transfer(done);
    if (count < 0 && errno == EINTR) continue;
    if (count == 0) errno = EIO;
    if (count <= 0) throw_system_error();
    done += static_cast<std::size_t>(count);
  }
}

}  // namespace

MemoryFile::MemoryFile() : descriptor_(::memfd_create("quadtune", MFD_CLOEXEC)) {
  if (descriptor_ < 0) throw_system_error();
  path_ = fmt::format("/proc/self/fd/{}", descriptor_);
}

MemoryFile::~MemoryFile() { ::close(descriptor_); }

void MemoryFile::write(const std::string& bytes) const {
  if (::ftruncate(descriptor_, 0) != 0) throw_system_error();
  transfer_all(bytes.size(), [&](std::size_t done) {
    return ::pwrite(descriptor_, bytes.data() + done, bytes.size() - done,
                    static_cast<off_t>(done));
  });
}

std::string MemoryFile::read() const {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) throw_system_error();
  std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
  transfer_all(bytes.size(), [&](std::size_t done) {
    return ::pread(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
  });
  return bytes;
}

}  // namespace quadtune::internal
