// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/file_set.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <openssl/evp.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <set>
#include <thread>
#include <utility>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, int error) {
  throw FileError(path.string(), std::strerror(error));
}

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] int close() { return ::close(std::exchange(fd_, -1)); }

 private:
  int fd_;
};

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new()) {
    require(context_ != nullptr && EVP_DigestInit_ex(context_, EVP_sha256(), nullptr) == 1);
  }
  ~Sha256() { EVP_MD_CTX_free(context_); }
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void add(const char* bytes, std::size_t count) {
    require(EVP_DigestUpdate(context_, bytes, count) == 1);
  }
  [[nodiscard]] std::string hex() {
    unsigned char digest[EVP_MAX_MD_SIZE];
    unsigned int size = 0;
    require(EVP_DigestFinal_ex(context_, digest, &size) == 1);
    std::string text;
    for (unsigned int i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
    return text;
  }

 private:
  static void require(bool done) {
    if (!done) throw std::runtime_error("sha256: libcrypto failed");
  }

  EVP_MD_CTX* context_;
};

constexpr char kTemporaryEnd[] = ".quadtune-tmp";

std::string temporary(const std::string& name) { return "." + name + kTemporaryEnd; }

void sync_directory(const fs::path& path) {
  const Descriptor fd(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() < 0 || ::fsync(fd.get()) != 0) fail(path, errno);
}

// Makes the missing directories of a path; removes them again unless kept.
class MadeDirectories {
 public:
  explicit MadeDirectories(const fs::path& directory) {
    std::vector<fs::path> missing;
    std::error_code ignored;  // open() reports the reason
    for (fs::path p = directory;
         !p.empty() && fs::symlink_status(p, ignored).type() == fs::file_type::not_found;
         p = p.parent_path())
      missing.push_back(p);
    for (auto p = missing.rbegin(); p != missing.rend(); ++p) {
      if (::mkdir(p->c_str(), 0777) == 0) {
        made_.push_back(*p);
      } else if (errno != EEXIST) {
        const int error = errno;
        remove();
        fail(*p, error);
      }
    }
  }
  ~MadeDirectories() {
    if (!kept_) remove();
  }
  MadeDirectories(const MadeDirectories&) = delete;
  MadeDirectories& operator=(const MadeDirectories&) = delete;

  void sync() const {
    for (const fs::path& p : made_) sync_directory(p.has_parent_path() ? p.parent_path() : ".");
  }
  void keep() { kept_ = true; }

 private:
  void remove() {
    for (auto p = made_.rbegin(); p != made_.rend(); ++p) ::rmdir(p->c_str());
    made_.clear();
  }

  std::vector<fs::path> made_;
  bool kept_ = false;
};

// The temporary files and exchanges so far; they are undone unless committed.
class Transaction {
 public:
  Transaction(const fs::path& directory, int fd) : directory_(directory), fd_(fd) {}
  ~Transaction() {
    if (!committed_) undo();
    // After an exchange the temporary name holds the old file.
    for (const std::string& name : temporaries_) ::unlinkat(fd_, name.c_str(), 0);
  }
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  /// @param ask  called between blocks; may throw, which leaves no file behind
  void write_temporary(const FileContent& file, const std::function<void()>& ask) {
    constexpr std::size_t kPiece = std::size_t{1} << 22;
    const std::string name = temporary(file.name);
    ::unlinkat(fd_, name.c_str(), 0);  // left by a crash; under the lock, nobody writes it
    Descriptor out(
        ::openat(fd_, name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
    if (out.get() < 0) fail(directory_ / file.name, errno);
    temporaries_.push_back(name);
    std::size_t done = 0;
    while (done < file.bytes.size()) {
      const std::size_t count = std::min(kPiece, file.bytes.size() - done);
      const ssize_t n = ::write(out.get(), file.bytes.data() + done, count);
      if (n < 0 && errno != EINTR) fail(directory_ / file.name, errno);
      if (n > 0) done += static_cast<std::size_t>(n);
      if (done < file.bytes.size()) ask();
    }
    if (::fsync(out.get()) != 0 || out.close() != 0) fail(directory_ / file.name, errno);
  }

  void put_in_place(const std::string& name) {
    const std::string from = temporary(name);
    if (::renameat2(fd_, from.c_str(), fd_, name.c_str(), RENAME_EXCHANGE) == 0) {
      exchanged_.push_back({name, Step::exchanged});
    } else if (errno == ENOENT &&
               ::renameat2(fd_, from.c_str(), fd_, name.c_str(), RENAME_NOREPLACE) == 0) {
      exchanged_.push_back({name, Step::created});
    } else if (errno == EINVAL || errno == ENOSYS) {
      // A file system without exchange: plain rename() is atomic too, but cannot be undone.
      if (::renameat(fd_, from.c_str(), fd_, name.c_str()) != 0) fail(directory_ / name, errno);
    } else {
      fail(directory_ / name, errno);
    }
  }

  void take_away(const std::string& name) {
    struct stat info {};
    if (::fstatat(fd_, name.c_str(), &info, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISREG(info.st_mode))
      return;  // already deleted, or not a file of ours
    const std::string to = temporary(name);
    if (::renameat(fd_, name.c_str(), fd_, to.c_str()) == 0) {
      exchanged_.push_back({name, Step::taken});
      temporaries_.push_back(to);
    } else if (errno != ENOENT) {
      fail(directory_ / name, errno);
    }
  }

  void commit() {
    if (::fsync(fd_) != 0) fail(directory_, errno);
    committed_ = true;
  }

 private:
  enum class Step { exchanged, created, taken };

  void undo() {
    for (auto step = exchanged_.rbegin(); step != exchanged_.rend(); ++step) {
      const std::string aside = temporary(step->first);
      const char* name = step->first.c_str();
      if (step->second == Step::exchanged)
        ::renameat2(fd_, aside.c_str(), fd_, name, RENAME_EXCHANGE);
      else if (step->second == Step::created)
        ::renameat(fd_, name, fd_, aside.c_str());
      else
        ::renameat(fd_, aside.c_str(), fd_, name);
    }
  }

  fs::path directory_;
  int fd_;
  std::vector<std::string> temporaries_;
  std::vector<std::pair<std::string, Step>> exchanged_;
  bool committed_ = false;
};

// Removes temporary files of killed writers whose names are not in this set. Requires the lock of
// the directory, which ensures that no writer uses them. Failures are ignored, because the new
// files are complete.
void remove_left_temporaries(int fd, const fs::path& directory) {
  std::error_code error;
  std::vector<std::string> left;
  for (fs::directory_iterator entry(directory, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with(".") && name.ends_with(kTemporaryEnd) &&
        name.size() > temporary("").size() &&
        entry->symlink_status(error).type() == fs::file_type::regular)
      left.push_back(name);
  }
  for (const std::string& name : left) ::unlinkat(fd, name.c_str(), 0);
}

void require_plain_names(const std::vector<FileContent>& files) {
  std::set<std::string> seen;
  for (const FileContent& file : files)
    if (file.name.empty() || file.name == "." || file.name == ".." ||
        file.name.find('/') != std::string::npos || !seen.insert(file.name).second)
      throw InvalidInput("write_files", fmt::format("'{}' is not a file name or occurs twice, "
                                                    "expected distinct names without a slash",
                                                    file.name));
}

void require_no_directory(int fd, const fs::path& directory, const std::string& name) {
  struct stat info {};
  if (::fstatat(fd, name.c_str(), &info, AT_SYMLINK_NOFOLLOW) == 0 && S_ISDIR(info.st_mode))
    fail(directory / name, EISDIR);
}

/// Excludes concurrent writers; file systems without locks are not protected. A writer is done in
/// milliseconds, unless the disk is slow.
/// @param poll  called while waiting
/// @return      whether the folder is locked
/// @throws FileError  if another process holds the lock for too long
bool lock(int fd, const fs::path& path, const std::function<void()>& poll) {
  constexpr auto kPatience = std::chrono::seconds(3);
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return false;
    if (std::chrono::steady_clock::now() > until)
      throw FileError(
          path.string(),
          fmt::format("another quadtune process has been writing to it for {} s; repeat "
                      "the command when that process has ended",
                      kPatience.count()));
    poll();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

}  // namespace

void write_files(const fs::path& directory, const std::vector<FileContent>& files,
                 const std::vector<std::string>& stale, const std::function<bool()>& interrupted) {
  require_plain_names(files);
  const auto stop_if_interrupted = [&] {
    if (interrupted && interrupted()) throw Interrupted();
  };
  stop_if_interrupted();
  // "out/" and "out" are the same directory; only the second has a file name.
  const fs::path path = directory.has_filename() ? directory : directory.parent_path();
  MadeDirectories made(path);
  const Descriptor fd(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() < 0 && errno == ENOTDIR)
    throw FileError(path.string(), "is a file, expected a directory to write into");
  if (fd.get() < 0) fail(path, errno);
  const bool locked = lock(fd.get(), path, stop_if_interrupted);

  Transaction transaction(path, fd.get());
  for (const FileContent& file : files) {
    require_no_directory(fd.get(), path, file.name);
    stop_if_interrupted();
    transaction.write_temporary(file, stop_if_interrupted);
  }
  stop_if_interrupted();  // last chance: only a few renames follow
  for (const FileContent& file : files) transaction.put_in_place(file.name);
  for (const std::string& name : stale) transaction.take_away(name);
  made.sync();
  transaction.commit();
  made.keep();
  if (locked) remove_left_temporaries(fd.get(), path);
}

std::string sha256(const std::string& bytes) {
  Sha256 hash;
  hash.add(bytes.data(), bytes.size());
  return hash.hex();
}

std::string sha256_of_file(const fs::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) fail(path, errno);
  Sha256 hash;
  std::vector<char> piece(std::size_t{1} << 20);
  for (;;) {
    const ssize_t count = ::read(file.get(), piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(path, errno);
    if (count == 0) return hash.hex();
    hash.add(piece.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace quadtune
