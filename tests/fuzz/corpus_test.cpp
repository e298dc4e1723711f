// SPDX-License-Identifier: Apache-2.0
/// The stored inputs of the fuzz targets, in the ordinary build: each is read or rejected.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include "fuzz_targets.hpp"
#include "source_folder.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

// A violated contract ends the program, so the name of the input is printed before it is read.
void expect_all_read_or_refused(const fuzz::Target& target, const fs::path& folder) {
  const std::vector<fs::path> files = files_in(folder);
  EXPECT_FALSE(files.empty()) << folder;
  for (const fs::path& file : files) {
    std::cout << target.name << " reads " << file.filename() << std::endl;
    std::ifstream stream(file, std::ios::binary);
    ASSERT_TRUE(stream) << file;
    const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
    target.feed(bytes);
  }
}

TEST(FuzzCorpus, IsReadOrRefused) {
  const fs::path corpus = fs::path(testing::source_folder()) / "tests/fuzz/corpus";
  for (const fuzz::Target& target : fuzz::kTargets)
    expect_all_read_or_refused(target, corpus / target.name);
}

// Every folder belongs to a target.
TEST(FuzzCorpus, HasAFolderForEachTarget) {
  const fs::path corpus = fs::path(testing::source_folder()) / "tests/fuzz/corpus";
  for (const fs::path& folder : files_in(corpus))
    EXPECT_TRUE(
        std::any_of(fuzz::kTargets.begin(), fuzz::kTargets.end(),
                    [&](const fuzz::Target& target) { return target.name == folder.filename(); }))
        << folder;
}

}  // namespace
}  // namespace quadtune
