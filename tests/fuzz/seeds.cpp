// SPDX-License-Identifier: Apache-2.0
/// Writes the first inputs of the fuzz targets: fuzz_seeds DIR makes DIR/text/csv, ….
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "log_files/hostile_samples.hpp"
#include "log_files/ulog_writer.hpp"

namespace {

void write(const std::filesystem::path& folder, const std::string& name, const std::string& bytes) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder / name, std::ios::binary) << bytes;
}

// The target that reads a format.
std::string target_of(const std::string& format) {
  return format.substr(0, format.find('-'));  // both of the uquad's are read by one
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: fuzz_seeds DIR\n", stderr);
    return 2;
  }
  const std::filesystem::path root = argv[1];
  for (const quadtune::testing::LogSample& sample : quadtune::testing::log_samples())
    write(root / target_of(sample.format), sample.name, sample.bytes);
  for (const quadtune::testing::LogSample& sample : quadtune::testing::mat_samples())
    write(root / "mat", sample.name, sample.bytes);
  quadtune::testing::UlogWriter again = quadtune::testing::sample_ulog();
  again.format("status:float armed;").subscribe(0, 3, "status");
  write(root / "ulog", "again", again.data(3, quadtune::testing::packed(1.5F)).bytes());
  write(root / "columns", "parts", "t_s:1, t_us:2, height[m]:3, rest\n1 500000 3 4\n2 0 5 6\n");
  write(root / "columns", "others", "t_ms:stamp, *\nstamp,a[m],b\n1500,2,3\n");
}
