// SPDX-License-Identifier: Apache-2.0
/// Writes the first inputs of the fuzz targets: fuzz_seeds DIR makes DIR/text/csv, …. Those in
/// tests/fuzz/corpus were written by it.
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
  return format.substr(0, format.find('-'));  // one reader reads both formats of the uquad
}

// Texts with unexpected ends, separators or spellings.
void write_crafted_texts(const std::filesystem::path& root) {
  using std::string_literals::operator""s;
  const std::filesystem::path text = root / "text";
  write(text, "empty", "");
  write(text, "byte-order-mark", "\xef\xbb\xbft_s,x\n0,1\n1,2\n");
  write(text, "utf-16", "\xff\xfet\0,\0x\0\n\0000\0,\0001\0\n\0"s);
  write(text, "not-utf-8", "t_s,\xc3\x28[\xb0]\n0,1\n1,2\n");
  write(text, "no-last-end", "t_s,x\n0,1\n1,2");
  write(text, "carriage-returns", "t_s,x\r0,1\r1,2\r");
  write(text, "zero-bytes", "t_s,x\n0,1\n\0\0\0\0,\0\n2,3\n"s);
  write(text, "open-quote", "\"t_s,x\n0,1\n1,2\n");
  write(text, "same-names", "t_s,x,x,,x\n0,1,2,3,4\n1,2,3,4,5\n");
  write(text, "numbers-beyond-double", "t_s,x\n0,1e999\n1,-1e-999\n2,0x1p3\n3,1e308\n4,--1\n");
  write(text, "clock-goes-back", "t_s,x\n5,1\n4,2\nnan,3\ninf,4\n5,5\n");
  write(text, "long-line", "t_s,x\n0," + std::string(8192, '1') + "\n1,2\n");
  write(text, "many-columns", "0" + fmt::format("{:,>3000}", "") + "\n1,2\n");
  write(root / "replay", "many-values", "1,imu" + fmt::format("{:,>300}", "") + "\n2,imu,1\n");
  write(root / "replay", "no-values", "1,imu\n,,\nimu,1\n1\n18446744073709551616,baro,1\n");
  write(root / "replay", "clock-goes-back", "20,baro,1\n10,baro,2\n-5,baro,3\n");
  write(root / "columns", "empty-list", "\n1 2\n");
  write(root / "columns", "column-zero", "a:0\n1 2\n");
  write(root / "columns", "column-far-away", "a:99999999999\n1 2\n");
  write(root / "columns", "same-twice", "t_s:1, x:2, x:2\n1 2\n2 3\n");
  write(root / "columns", "open-unit", "x[m:1, *, *\n1 2\n");
  write(root / "uquad", "cut-frame", "A\t10000\t1\t0\t208\nA\t10000\tA\tZ\nZ\n");
  write(root / "uquad", "number-too-large",
        "A\t99999999999999999999\t1\t0\t208\t-30\t-27\t-4\t124\t-33\t151\t288\t100947\tZ\n");
  write(root / "uquad", "clock-goes-back",
        "5 10 1 2 3 4 5 6 7 8 9 288 100947\n4 10 1 2 3 4 5 6 7 8 9 288 100947\n");
}

// Contradictory definitions, wrong sizes.
void write_crafted_ulogs(const std::filesystem::path& folder) {
  using quadtune::testing::packed;
  using quadtune::testing::UlogWriter;
  const auto with_topic = [](const char* format) {
    UlogWriter log;
    log.flags().format(format).subscribe(0, 3, "a");
    return log.data(3, packed(std::uint64_t{1}, 1.5F)).sync();
  };
  write(folder, "header-only", UlogWriter().bytes());
  write(folder, "other-magic", "ULoG" + UlogWriter().bytes().substr(4));
  write(folder, "of-itself", with_topic("a:uint64_t timestamp;a x;").bytes());
  write(folder, "of-each-other",
        with_topic("a:uint64_t timestamp;b x;").format("b:a y;").subscribe(1, 4, "b").bytes());
  write(folder, "huge-array", with_topic("a:uint64_t timestamp;float[4294967295] x;").bytes());
  write(folder, "negative-array", with_topic("a:uint64_t timestamp;float[-1] x;").bytes());
  write(folder, "padding-only", with_topic("a:uint8_t[12] _padding0;").bytes());
  write(folder, "empty-messages",
        with_topic("a:uint64_t timestamp;float x;").message('D', "").message('A', "").bytes());
  write(folder, "size-beyond-end",
        with_topic("a:uint64_t timestamp;float x;")
            .raw("\xff\xff"
                 "D")
            .bytes());
  UlogWriter far;
  far.flags().append_here();
  std::string bytes = far.bytes();
  bytes.replace(bytes.size() - 8, 8, 8, '\xff');
  write(folder, "appended-far-away", bytes);
}

// MAT files whose headers contradict their contents.
void write_crafted_mats(const std::filesystem::path& folder) {
  using quadtune::testing::MatWriter;
  write(folder, "empty", "");
  write(folder, "header-only", MatWriter(false).bytes());
  write(folder, "huge-dimensions", MatWriter(false).matrix("z", {1 << 30, 1 << 30}, {1}).bytes());
  write(folder, "negative-dimension", MatWriter(false).matrix("z", {-1, 4}, {1, 2, 3, 4}).bytes());
  write(folder, "no-dimensions", MatWriter(false).matrix("z", {}, {1, 2}).bytes());
  write(folder, "too-few-numbers", MatWriter(false).matrix("z", {4, 4}, {1, 2}).bytes());
  std::string damaged = MatWriter(true).matrix("z", {2, 2}, {1, 2, 3, 4}).bytes();
  damaged[damaged.size() / 2 + 60] ^= 0x55;
  write(folder, "damaged-stream", damaged);
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
  write_crafted_texts(root);
  write_crafted_ulogs(root / "ulog");
  write_crafted_mats(root / "mat");
}
