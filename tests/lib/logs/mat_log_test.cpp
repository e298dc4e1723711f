// SPDX-License-Identifier: Apache-2.0
/// MAT files of other programs, and hostile ones.
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "log_files/mat_writer.hpp"
#include "log_files/read_logs.hpp"
#include "log_files/sample_logs.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/logs/flight_log.hpp"

namespace quadtune {
namespace {

using ::testing::DoubleEq;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::MatWriter;
using testing::read_bytes;
using ::testing::ThrowsMessage;
using testing::WholeLog;

TEST(MatLog, VectorsOfOneLengthShareTheClock) {
  for (const bool compressed : {false, true}) {
    MatWriter mat(compressed);
    mat.matrix("z", {3, 1}, {1, 2, 3}).matrix("t_ms", {1, 3}, {0, 5, 10});
    mat.matrix("M", {3, 2}, {1, 2, 3, 4, 5, 6}).matrix("other", {2, 1}, {8, 9});
    mat.matrix("g", {1, 1}, {9.81});
    const WholeLog log = read_bytes(mat.bytes());
    EXPECT_EQ(log.format, "mat");
    ASSERT_EQ(log.groups.size(), 2U);
    EXPECT_THAT(log.group("rows3").names(), ElementsAre("z", "M[1]", "M[2]"));
    EXPECT_THAT(log.group("rows3").time, ElementsAre(0, DoubleEq(0.005), DoubleEq(0.01)));
    EXPECT_THAT(log.group("rows3").rows[2], ElementsAre(3, 3, 6));
    EXPECT_FALSE(log.group("rows2").group.timed);
    EXPECT_THAT(log.condition.notes, ElementsAre("single numbers are ignored: g"));
  }
}

TEST(MatLog, ReadsWhatSimulinkWrites) {
  for (const bool inner_names : {false, true}) {  // generated code names what fields hold once more
    MatWriter mat(false, inner_names);
    mat.simulink("rt_yout", {0, 0.5}, {{"motors", {2, 2}, {1, 2, 3, 4}}, {"flag", {2, 1}, {0, 1}}});
    mat.simulink("cube", {0, 0.5}, {{"", {1, 2, 2}, {1, 2, 3, 4}}});
    const WholeLog log = read_bytes(mat.bytes());
    EXPECT_THAT(log.group("rt_yout").names(), ElementsAre("motors[1]", "motors[2]", "flag"));
    EXPECT_THAT(log.group("rt_yout").time, ElementsAre(0, 0.5));
    EXPECT_THAT(log.group("rt_yout").rows[1], ElementsAre(2, 4, 1));
    EXPECT_THAT(log.group("cube").rows[1], ElementsAre(3, 4));  // the last dimension is the time
    EXPECT_TRUE(log.condition.whole()) << log.condition.first_skipped;
  }
}

TEST(MatLog, ReadsTheProjectsOwnLogsLikeTheirCsv) {
  const LogTable table = testing::small_log();
  const WholeLog mat = read_bytes(bytes_of_mat(table));
  const WholeLog csv = read_bytes(csv_of(table));
  ASSERT_EQ(mat.groups.size(), 1U);
  EXPECT_EQ(mat.groups[0].group.name, csv.groups[0].group.name);
  EXPECT_EQ(mat.groups[0].names(), csv.groups[0].names());
  EXPECT_EQ(mat.groups[0].units(), csv.groups[0].units());
  EXPECT_EQ(mat.groups[0].time, csv.groups[0].time);
}

TEST(MatLog, TellsWhatWasTorn) {
  MatWriter mat(false);
  mat.matrix("a", {2, 1}, {1, 2});
  const std::size_t first = mat.bytes().size();
  mat.matrix("b", {2, 1}, {3, 4});
  const WholeLog log = read_bytes(mat.bytes().substr(0, mat.bytes().size() - 1));
  EXPECT_THAT(log.group("").names(), ElementsAre("a"));
  EXPECT_EQ(log.condition.torn,
            "f.log: the file ends within a variable at offset " + std::to_string(first));
}

TEST(MatLog, AWideMatrixIsNoLog) {
  MatWriter mat(true);
  mat.matrix("wide", {2, 10001}, std::vector<double>(20002)).matrix("z", {2, 1}, {3, 4});
  const WholeLog log = read_bytes(mat.bytes());
  EXPECT_THAT(log.group("").names(), ElementsAre("z"));
  EXPECT_THAT(log.condition.notes, ElementsAre(HasSubstr("'wide' has 10001 columns")));
}

// The checksum of a compressed variable is compared, so that no damaged number comes through.
TEST(MatLog, DamagedVariablesArePassedOver) {
  MatWriter mat(true);
  mat.matrix("a", {2, 1}, {1, 2}).matrix("b", {2, 1}, {3, 4});
  std::string bytes = mat.bytes();
  bytes[bytes.size() - 2] = static_cast<char>(bytes[bytes.size() - 2] ^ 1);
  const WholeLog log = read_bytes(bytes);
  EXPECT_THAT(log.group("").names(), ElementsAre("a"));
  EXPECT_EQ(log.condition.skipped, 1U);
  EXPECT_THAT(log.condition.first_skipped, HasSubstr("is damaged or too large"));
}

TEST(MatLog, JudgesAClockWithoutUnitByItsValues) {
  const auto log_of = [](double first, double step) {
    MatWriter mat(false);
    mat.matrix("time", {3, 1}, {first, first + step, first + 2 * step});
    mat.matrix("z", {3, 1}, {1, 2, 3});
    return read_bytes(mat.bytes());
  };
  const WholeLog us = log_of(1700000000e6, 5000);
  EXPECT_EQ(us.epoch_s, 1700000000);
  EXPECT_THAT(us.group("").time[1], ::testing::DoubleNear(0.005, 1e-6));
  EXPECT_THAT(us.condition.notes,
              ElementsAre(HasSubstr("the clock 'time' states no unit and is taken as microseconds "
                                    "since 1970")));
  EXPECT_THAT(log_of(3, 0.5).condition.notes, ::testing::IsEmpty());
  const WholeLog ambiguous = log_of(0, 4000);
  EXPECT_FALSE(ambiguous.group("").group.timed);
  EXPECT_THAT(ambiguous.group("").names(), ElementsAre("time", "z"));
  EXPECT_THAT(ambiguous.condition.notes,
              ElementsAre("'time' states no unit and is not used as a clock because in seconds its "
                          "samples would be 4000 s apart; they may be milliseconds, microseconds "
                          "or nanoseconds: rename it time_us"));
}

TEST(MatLog, LeavesOutRowsWhoseTimeWasNeverSet) {
  MatWriter mat(false);
  mat.matrix("t_s", {4, 1}, {0, 1700000000.0, 1700000000.5, 1700000001.0});
  mat.matrix("z", {4, 1}, {7, 1, 2, 3});
  const WholeLog log = read_bytes(mat.bytes());
  EXPECT_EQ(log.epoch_s, 1700000000);
  EXPECT_THAT(log.group("").time, ElementsAre(0, 0.5, 1));
  EXPECT_THAT(log.group("").column("z"), ElementsAre(1, 2, 3));
  EXPECT_THAT(log.condition.notes, ElementsAre(HasSubstr("1 of 4 rows of '' is at time 0")));
}

TEST(MatLog, RefusesOtherKindsWithTheWayOut) {
  std::string hdf5 = "MATLAB 7.3 MAT-file";
  hdf5.resize(512, ' ');
  hdf5 += "\x89HDF\r\n\x1a\n";
  EXPECT_THAT([&] { (void)read_bytes(hdf5); },
              ThrowsMessage<InvalidInput>("f.log: is a MAT v7.3 file, which is HDF5, expected MAT "
                                          "v5: save it with -v6"));
  EXPECT_THAT([] { (void)read_bytes("MATLAB 5.0"); },
              ThrowsMessage<InvalidInput>(HasSubstr("f.log: has 10 bytes")));
}

TEST(MatLog, NeedsNoMoreMemoryThanItMay) {
  MatWriter mat(true);
  mat.matrix("zeros", {1000000, 10}, std::vector<double>(10000000));
  LogOptions options;
  options.memory_limit = std::size_t{64} << 20U;
  EXPECT_THAT([&] { (void)read_bytes(mat.bytes(), options); },
              ThrowsMessage<InvalidInput>(HasSubstr("needs more than 64 MiB of memory")));
}

// One array of numbers, named z, that are stored otherwise than its class says.
template <typename Number>
std::vector<double> numbers_stored_as(std::uint32_t kind, std::uint32_t type,
                                      const std::vector<Number>& numbers) {
  MatWriter mat(false);
  mat.add(MatWriter::element(
      14, MatWriter::head(kind, {static_cast<std::int32_t>(numbers.size()), 1}, "z") +
              MatWriter::element(type, MatWriter::raw(numbers))));
  return read_bytes(mat.bytes()).group("").column("z");
}

// MATLAB stores whole numbers of any class in the smallest type that holds them.
TEST(MatLog, ReadsEveryTypeOfNumbers) {
  constexpr std::uint32_t kDouble = 6;
  EXPECT_THAT(numbers_stored_as<std::int8_t>(kDouble, 1, {-1, 2}), ElementsAre(-1, 2));
  EXPECT_THAT(numbers_stored_as<std::uint8_t>(kDouble, 2, {255, 2}), ElementsAre(255, 2));
  EXPECT_THAT(numbers_stored_as<std::int16_t>(10, 3, {-300, 2}), ElementsAre(-300, 2));
  EXPECT_THAT(numbers_stored_as<std::uint16_t>(11, 4, {65535, 2}), ElementsAre(65535, 2));
  EXPECT_THAT(numbers_stored_as<std::int32_t>(12, 5, {-70000, 2}), ElementsAre(-70000, 2));
  EXPECT_THAT(numbers_stored_as<std::uint32_t>(13, 6, {4000000000U, 2}),
              ElementsAre(4000000000.0, 2));
  EXPECT_THAT(numbers_stored_as<float>(7, 7, {0.5F, 2}), ElementsAre(0.5, 2));
  EXPECT_THAT(numbers_stored_as<std::int64_t>(14, 12, {-5000000000, 2}),
              ElementsAre(-5000000000.0, 2));
  EXPECT_THAT(numbers_stored_as<std::uint64_t>(15, 13, {5000000000U, 2}),
              ElementsAre(5000000000.0, 2));
}

TEST(MatLog, NamesWhatItPassesOver) {
  const auto of_kind = [](std::uint32_t kind, const std::string& name) {
    return MatWriter::element(14, MatWriter::head(kind, {0, 0}, name));
  };
  MatWriter mat(false);
  mat.matrix("z", {2, 1}, {1, 2}).add(of_kind(1, "c")).add(of_kind(3, "o")).add(of_kind(5, "s"));
  mat.add(of_kind(16, "f")).add(of_kind(6 | 0x800, "i"));
  EXPECT_THAT(read_bytes(mat.bytes()).condition.notes,
              ElementsAre("'c' is a cell array and is ignored",
                          "'o' is an object: save a timeseries as a struct and is ignored",
                          "'s' is a sparse matrix and is ignored",
                          "'f' is not a vector or matrix of numbers and is ignored",
                          "'i' is complex and is ignored"));
}

// A struct of `count` fields called `name` that states `rows` of them.
std::string struct_of(std::int32_t rows, const std::string& name, std::size_t count,
                      const std::string& values) {
  std::string names;
  for (std::size_t i = 0; i < count; ++i) names += name + '\0';
  return MatWriter::element(
      14, MatWriter::head(2, {rows, 1}, "s") +
              MatWriter::element(5, MatWriter::raw(std::vector<std::size_t>{name.size() + 1})
                                        .substr(0, sizeof(std::int32_t))) +
              MatWriter::element(1, names) + values);
}

TEST(MatLog, RefusesStructsThatClaimWhatTheyDoNotHold) {
  const std::string number = MatWriter::element(14, "");
  const auto why = [&](const std::string& variable) {
    MatWriter mat(false);
    mat.matrix("z", {2, 1}, {1, 2}).add(variable);
    return read_bytes(mat.bytes()).condition.first_skipped;
  };
  EXPECT_EQ(why(struct_of(1, "a", 1, number)), "");
  EXPECT_THAT(why(struct_of(2, "a", 1, number)), HasSubstr("a struct holds 1 arrays instead of 2"));
  EXPECT_THAT(why(struct_of(1, "a", 3, number)), HasSubstr("a struct holds 1 arrays instead of 3"));
  EXPECT_THAT(why(struct_of(100000, "a", 1, number)), HasSubstr("claims 100000 x 1 entries"));
  EXPECT_THAT(why(MatWriter::element(14, MatWriter::head(1, {2, 1}, "c") + number)),
              HasSubstr("a cell holds 1 arrays instead of 2"));
  EXPECT_THAT(why(MatWriter::element(14, MatWriter::head(2, {1, 1}, "s") + number)),
              HasSubstr("a struct does not state the length of its names"));
}

std::string refusal_within(std::size_t memory_limit, const std::string& bytes) {
  LogOptions options;
  options.memory_limit = memory_limit;
  try {
    (void)read_bytes(bytes, options);
  } catch (const InvalidInput& refusal) {
    return refusal.what();
  }
  return "";
}

constexpr std::size_t kSmallLimit = std::size_t{16} << 20U;
constexpr const char* kTooMuch = "f.log: needs more than 16 MiB of memory to be read";

// What the process has used at most [bytes].
std::size_t peak_memory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

// A file of a megabyte that inflates to a gigabyte.
TEST(HostileMat, InflatesNoMoreThanTheLimit) {
  std::string packed(std::size_t{2} << 20U, '\0');
  z_stream z{};
  ASSERT_EQ(deflateInit(&z, 9), Z_OK);
  std::string zeros(std::size_t{1} << 20U, '\0');
  z.next_out = reinterpret_cast<Bytef*>(packed.data());
  z.avail_out = static_cast<uInt>(packed.size());
  for (int i = 0; i < 1024; ++i) {
    z.next_in = reinterpret_cast<Bytef*>(zeros.data());
    z.avail_in = static_cast<uInt>(zeros.size());
    ASSERT_EQ(deflate(&z, i == 1023 ? Z_FINISH : Z_NO_FLUSH), i == 1023 ? Z_STREAM_END : Z_OK);
  }
  packed.resize(z.total_out);
  deflateEnd(&z);
  std::string bytes = MatWriter(true).bytes();
  bytes +=
      MatWriter::raw(std::vector<std::uint32_t>{15, static_cast<std::uint32_t>(packed.size())});
  const std::size_t before = peak_memory();
  EXPECT_EQ(refusal_within(kSmallLimit, bytes + packed), kTooMuch);
  EXPECT_LT(peak_memory() - before, 6 * kSmallLimit);
}

// Streams that inflate far and turn out to be damaged cost time, so together they have one limit.
TEST(HostileMat, DamagedStreamsShareTheLimit) {
  MatWriter mat(true);
  const std::size_t header = mat.bytes().size();
  mat.matrix("zeros", {1000000, 1}, std::vector<double>(1000000));
  std::string stream = mat.bytes().substr(header);
  stream.back() = static_cast<char>(stream.back() ^ 1);  // of the checksum
  std::string bytes = mat.bytes().substr(0, header) + stream;
  EXPECT_THAT(refusal_within(kSmallLimit, bytes), HasSubstr("no variable can be read"));
  for (int i = 0; i < 1000; ++i) bytes += stream;
  EXPECT_EQ(refusal_within(kSmallLimit, bytes), kTooMuch);
}

// Eight bytes in the file are an array of a hundred in memory.
TEST(HostileMat, CountsEmptyArrays) {
  MatWriter mat(true);
  std::string cells;
  for (int i = 0; i < 1000000; ++i) cells += std::string("\x0e\0\0\0\0\0\0\0", 8);
  mat.add(MatWriter::element(14, MatWriter::head(1, {1000000, 1}, "c") + cells));
  EXPECT_EQ(refusal_within(kSmallLimit, mat.bytes()), kTooMuch);
}

// A column of bytes becomes one of doubles.
TEST(HostileMat, CountsTheTablesToo) {
  MatWriter mat(true);
  mat.add(MatWriter::element(14, MatWriter::head(9, {4000000, 1}, "z") +
                                     MatWriter::element(2, std::string(4000000, '\1'))));
  EXPECT_EQ(refusal_within(kSmallLimit, mat.bytes()), kTooMuch);
}

// The name of a struct stands before those of all its fields.
TEST(HostileMat, CountsLongNames) {
  MatWriter mat(true);
  std::string values;
  const std::string two =
      MatWriter::element(14, MatWriter::head(9, {2, 1}, "") + MatWriter::element(2, "\1\2"));
  for (int i = 0; i < 1000; ++i) values += two;
  mat.add(struct_of(1, std::string(100000, 'n'), 1, struct_of(1, "f", 1000, values)));
  EXPECT_EQ(refusal_within(kSmallLimit, mat.bytes()), kTooMuch);
}

}  // namespace
}  // namespace quadtune
