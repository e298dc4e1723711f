// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/file_set.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>
#include <map>

#include "quadtune/errors.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;

using Contents = std::map<std::string, std::string>;

const std::vector<FileContent> old_export = {{"K.txt", "1 2 3\n"}, {"manifest.json", "old\n"}};
const std::vector<FileContent> new_export = {
    {"K.txt", std::string(100000, '7')}, {"K_int.txt", "4\n"}, {"manifest.json", "new\n"}};

// All files of a directory, including hidden ones.
Contents contents(const TemporaryDirectory& directory, const fs::path& below = "") {
  Contents result;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory.path() / below))
    result[entry.path().filename()] =
        entry.is_directory() ? "(directory)" : directory.read(below / entry.path().filename());
  return result;
}

Contents contents(const std::vector<FileContent>& files) {
  Contents result;
  for (const FileContent& file : files) result[file.name] = file.bytes;
  return result;
}

// Runs `work` in a child process, to which its limits and its user are confined. Returns the
// exception's text.
std::string in_child(const std::function<void()>& work) {
  int ends[2];
  EXPECT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    std::string message = "nothing thrown";
    try {
      work();
    } catch (const FileError& error) {
      message = error.what();
    } catch (const std::exception& error) {
      message = std::string("another exception: ") + error.what();
    }
    const ssize_t written = ::write(ends[1], message.data(), message.size());
    ::_exit(written < 0);
  }
  ::close(ends[1]);
  std::string message(1000, '\0');
  message.resize(static_cast<std::size_t>(::read(ends[0], message.data(), message.size())));
  ::close(ends[0]);
  ::waitpid(child, nullptr, 0);
  return message;
}

TEST(WriteFiles, WritesAndReplacesAndTakesAwayStaleFiles) {
  const TemporaryDirectory directory;
  write_files(directory.path() / "a/b", new_export);
  EXPECT_EQ(contents(directory, "a/b"), contents(new_export));
  write_files(directory.path() / "a/b/", old_export, {"K_int.txt", "never_there.txt"});
  EXPECT_EQ(contents(directory, "a/b"), contents(old_export));
}

TEST(WriteFiles, LeavesTheOldExportWhenTheDiskIsFull) {
  const TemporaryDirectory directory;
  write_files(directory.path(), old_export);
  const std::string message = in_child([&] {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit = {50000, 50000};  // K.txt fails in its middle
    ::setrlimit(RLIMIT_FSIZE, &limit);
    write_files(directory.path(), new_export);
  });
  EXPECT_THAT(message, HasSubstr("K.txt: File too large"));
  EXPECT_EQ(contents(directory), contents(old_export));
}

TEST(WriteFiles, LeavesAReadOnlyDirectoryAlone) {
  const TemporaryDirectory directory;
  write_files(directory.path(), old_export);
  ::chmod(directory.path().c_str(), 0555);
  const std::string message = in_child([&] {
    if (::geteuid() == 0 && ::setuid(65534) != 0) return;  // root may write anywhere
    write_files(directory.path(), new_export);
  });
  ::chmod(directory.path().c_str(), 0755);
  EXPECT_THAT(message, HasSubstr("K.txt: Permission denied"));
  EXPECT_EQ(contents(directory), contents(old_export));
}

TEST(WriteFiles, StopsBetweenAnyTwoStepsWhenInterrupted) {
  const TemporaryDirectory directory;
  write_files(directory.path(), old_export);
  for (int steps = 0;; ++steps) {
    int asked = 0;
    const auto interrupted = [&] { return asked++ == steps; };
    try {
      write_files(directory.path(), new_export, {}, interrupted);
      EXPECT_EQ(steps, 5);  // at the start, before each of three files, before the renames
      break;
    } catch (const Interrupted&) {
      EXPECT_EQ(contents(directory), contents(old_export)) << "after " << steps;
    }
  }
  EXPECT_EQ(contents(directory), contents(new_export));
}

TEST(WriteFiles, RemovesTheDirectoriesThatItMade) {
  const TemporaryDirectory directory;
  const auto interrupted = [asked = 0]() mutable { return ++asked == 3; };
  EXPECT_THROW(write_files(directory.path() / "a/b", new_export, {}, interrupted), Interrupted);
  EXPECT_EQ(contents(directory), Contents{});
}

TEST(WriteFiles, RefusesATargetThatIsADirectory) {
  const TemporaryDirectory directory;
  write_files(directory.path(), {old_export[0]});
  fs::create_directory(directory.path() / "manifest.json");
  EXPECT_THAT([&] { write_files(directory.path(), new_export); },
              ThrowsMessage<FileError>(HasSubstr("manifest.json: Is a directory")));
  EXPECT_EQ(contents(directory),
            (Contents{{"K.txt", "1 2 3\n"}, {"manifest.json", "(directory)"}}));
}

TEST(WriteFiles, UndoesTheExchangesThatWereMade) {
  const TemporaryDirectory directory;
  write_files(directory.path(), old_export);
  // At the last call all temporary files exist; if one is deleted, its rename fails after K.txt and
  // K_int.txt were exchanged.
  const auto saboteur = [&, asked = 0]() mutable {
    if (++asked == 5) fs::remove(directory.path() / ".manifest.json.quadtune-tmp");
    return false;
  };
  EXPECT_THAT([&] { write_files(directory.path(), new_export, {}, saboteur); },
              ThrowsMessage<FileError>(HasSubstr("manifest.json: No such file")));
  EXPECT_EQ(contents(directory), contents(old_export));
}

TEST(WriteFiles, RefusesAPathThatIsAFile) {
  const TemporaryDirectory directory;
  directory.write("out", "precious");
  EXPECT_THAT([&] { write_files(directory.path() / "out", new_export); },
              ThrowsMessage<FileError>(HasSubstr("out: is a file, expected a directory")));
  EXPECT_THAT([&] { write_files(directory.path() / "out/below", new_export); },
              ThrowsMessage<FileError>(HasSubstr("Not a directory")));
  EXPECT_EQ(contents(directory), (Contents{{"out", "precious"}}));
}

TEST(WriteFiles, RefusesToWriteBesideAnotherWriter) {
  const TemporaryDirectory directory;
  const int other = ::open(directory.path().c_str(), O_RDONLY | O_DIRECTORY);
  ASSERT_EQ(::flock(other, LOCK_EX), 0);
  EXPECT_THAT(
      [&] { write_files(directory.path(), new_export); },
      ThrowsMessage<FileError>(HasSubstr("another quadtune process has been writing to it")));
  ::close(other);
  write_files(directory.path(), new_export);
}

TEST(WriteFiles, WaitsForAnotherWriterThatEnds) {
  const TemporaryDirectory directory;
  int other = ::open(directory.path().c_str(), O_RDONLY | O_DIRECTORY);
  ASSERT_EQ(::flock(other, LOCK_EX), 0);
  int polls = 0;
  const auto interrupted = [&] {
    if (++polls == 3 && other >= 0) {  // once before the lock, then while waiting
      ::close(other);
      other = -1;
    }
    return false;
  };
  write_files(directory.path(), new_export, {}, interrupted);
  EXPECT_EQ(other, -1);
  EXPECT_GE(contents(directory).size(), new_export.size());
}

TEST(WriteFiles, ReplacesTemporariesThatACrashLeft) {
  const TemporaryDirectory directory;
  directory.write(".K.txt.quadtune-tmp", "half");
  write_files(directory.path(), old_export);
  EXPECT_EQ(contents(directory), contents(old_export));
}

// Also those of another set, but only plain files that match our pattern.
TEST(WriteFiles, RemovesTheTemporariesOfAKilledWriter) {
  const TemporaryDirectory directory;
  directory.write(".K_full.txt.quadtune-tmp", "half");
  Contents kept = {{".quadtune-tmp", "no name"}, {"K.quadtune-tmp", "no dot"}, {".K.txt", "other"}};
  for (const auto& [name, bytes] : kept) directory.write(name, bytes);
  fs::create_directory(directory.path() / ".a.quadtune-tmp");
  fs::create_symlink("K.txt", directory.path() / ".b.quadtune-tmp");
  EXPECT_THROW(write_files(directory.path(), old_export, {}, [] { return true; }), Interrupted);
  EXPECT_TRUE(fs::exists(directory.path() / ".K_full.txt.quadtune-tmp"));  // only a success clears
  write_files(directory.path(), old_export);
  kept.merge(contents(old_export));
  kept[".a.quadtune-tmp"] = "(directory)";
  kept[".b.quadtune-tmp"] = "1 2 3\n";  // through the link
  EXPECT_EQ(contents(directory), kept);
}

TEST(WriteFiles, RefusesNamesThatLeaveTheDirectory) {
  const TemporaryDirectory directory;
  for (const char* name : {"../K.txt", "", ".", "a/b"})
    EXPECT_THROW(write_files(directory.path(), {{name, ""}}), InvalidInput) << name;
  EXPECT_THROW(write_files(directory.path(), {{"K.txt", ""}, {"K.txt", ""}}), InvalidInput);
}

// FIPS 180-2, appendix B.1.
TEST(Sha256, HashesThePublishedExample) {
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Sha256, OfAFileIsThatOfItsBytes) {
  const TemporaryDirectory directory;
  for (const std::size_t size : {0U, 3U, 1U << 20, (5U << 20) + 7U}) {
    std::string bytes(size, '\0');
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * 7 + i / 251);
    EXPECT_EQ(sha256_of_file(directory.write("file", bytes)), sha256(bytes)) << size;
  }
  EXPECT_THROW((void)sha256_of_file(directory.path() / "none"), FileError);
}

}  // namespace
}  // namespace quadtune
