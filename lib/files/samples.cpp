// SPDX-License-Identifier: Apache-2.0
#include "quadtune/samples.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace quadtune::internal {
namespace {

/// Maps heap blocks as well as files, so that both are released the same way.
void* map_block(std::size_t bytes, int flags, int file) {
  void* block = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, flags, file, 0);
  return block == MAP_FAILED ? nullptr : block;
}

/// Creating a file longer than the process may write would terminate it by a signal.
bool may_write(std::size_t bytes) {
  rlimit limit{};
  return getrlimit(RLIMIT_FSIZE, &limit) == 0 && bytes <= limit.rlim_cur;
}

/// @return  nullptr if the file cannot be created or the file system has no room
void* spool(std::size_t bytes) {
  if (!may_write(bytes)) return nullptr;
  const char* directory = std::getenv("TMPDIR");
  std::string name =
      std::string(directory && *directory ? directory : "/var/tmp") + "/quadtune-XXXXXX";
  const int file = mkostemp(name.data(), O_CLOEXEC);
  if (file < 0) return nullptr;
  unlink(name.c_str());
  void* block = nullptr;
  // Reserve all space now: running out of space when a page is written would terminate the program.
  if (posix_fallocate(file, 0, static_cast<off_t>(bytes)) == 0)
    block = map_block(bytes, MAP_SHARED, file);
  close(file);
  return block;
}

}  // namespace

void* allocate_samples(std::size_t bytes) {
  if (bytes < kMinSpooled) return ::operator new(bytes);
  void* block = spool(bytes);
  if (!block) block = map_block(bytes, MAP_PRIVATE | MAP_ANONYMOUS, -1);
  if (!block) throw std::bad_alloc();
  return block;
}

void free_samples(void* block, std::size_t bytes) noexcept {
  if (bytes < kMinSpooled)
    ::operator delete(block);
  else
    munmap(block, bytes);
}

}  // namespace quadtune::internal
