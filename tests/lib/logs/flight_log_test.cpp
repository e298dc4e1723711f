// SPDX-License-Identifier: Apache-2.0
#include "quadtune/logs/flight_log.hpp"

#include <gmock/gmock.h>

#include <clocale>
#include <cstring>
#include <tuple>

#include "log_files/sample_logs.hpp"
#include "logs/mat/mat_fields.hpp"
#include "quadtune/errors.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using testing::random_log;
using testing::SameLog;
using testing::small_log;
using ::testing::StartsWith;
using ::testing::StrEq;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;

std::string written_csv() {
  return "# quadtune-log,1\n"
         "# note,units stand in brackets after the names; 1 is a count or a truth value; an empty "
         "field is no value\n"
         "# rows,2\n"
         "# about,vehicle,mambo\n"
         "# about,seed,7\n"
         "# event,0.0025,tilt,\"rolled 1.2 rad, more than 1\"\n"
         "t[s],x.px[m],gps.px[m]\n"
         "0,0.1,\n"
         "0.005,-2,3\n";
}

TEST(LogCsv, IsWhatThePagesSay) { EXPECT_EQ(csv_of(small_log()), written_csv()); }

TEST(LogCsv, ReadsBackWhatAPersonSees) {
  EXPECT_THAT(table_of_csv(written_csv(), "f.csv"), SameLog(small_log()));
}

TEST(Logs, AnyTableReadsBackBitForBit) {
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    const LogTable log = random_log(seed);
    ASSERT_THAT(table_of_csv(csv_of(log), "f.csv"), SameLog(log)) << "seed " << seed;
    ASSERT_THAT(table_of_mat(bytes_of_mat(log), "f.mat"), SameLog(log)) << "seed " << seed;
  }
}

// A MAT file keeps the bits of NaN too.
TEST(Logs, MatKeepsThePayloadOfNaN) {
  const auto odd = std::bit_cast<double>(std::uint64_t{0xfff8000000001234});
  const LogTable log = {{}, {{"t", "s", {odd}}}, {}};
  const LogTable back = table_of_mat(bytes_of_mat(log), "f.mat");
  EXPECT_EQ(std::bit_cast<std::uint64_t>(back.columns.at(0).values.at(0)), 0xfff8000000001234U);
}

TEST(Logs, EmptyTablesReadBack) {
  const LogTable nothing;
  const LogTable no_rows = {{}, {{"t", "s", {}}, {"x.px", "m", {}}}, {}};
  for (const LogTable& log : {nothing, no_rows}) {
    EXPECT_THAT(table_of_csv(csv_of(log), "f.csv"), SameLog(log));
    EXPECT_THAT(table_of_mat(bytes_of_mat(log), "f.mat"), SameLog(log));
  }
}

TEST(Logs, TheSameTableGivesTheSameBytes) {
  for (const char* path : {"f.csv", "f.mat"})
    EXPECT_EQ(log_bytes(random_log(3), path), log_bytes(random_log(3), path)) << path;
}

// Programs that skip comments do so line by line, and at a '#' within a line too.
TEST(LogCsv, HostileTextsStayOnTheirLines) {
  LogTable log = small_log();
  for (const std::string& text : testing::hostile_texts()) {
    log.about.emplace_back(text, text);
    log.events.push_back({1, text, text});
    if (log.find(text) == nullptr) log.columns.push_back({text, text, {1, 2}});
  }
  const std::string csv = csv_of(log);
  std::size_t lines = 0;
  for (std::size_t at = 0; at < csv.size(); ++lines) {
    const std::size_t end = csv.find('\n', at);
    ASSERT_NE(end, std::string::npos);
    const std::size_t hash = csv.find('#', at + 1);
    if (csv[at] != '#') {
      EXPECT_GT(hash, end) << "line " << lines + 1;
    }
    at = end + 1;
  }
  EXPECT_EQ(lines, 4 + log.about.size() + log.events.size() + log.rows());
}

// Many readers pass over empty lines.
TEST(LogCsv, ARowOfOneColumnIsNeverEmpty) {
  const LogTable log = {{}, {{"t", "s", {1, std::nan(""), 2}}}, {}};
  EXPECT_THAT(csv_of(log), HasSubstr("t[s]\n1\nnan\n2\n"));
  EXPECT_THAT(table_of_csv(csv_of(log), "f.csv"), SameLog(log));
}

TEST(LogCsv, TheDecimalSignIsADotInEveryLocale) {
  const std::string old = std::setlocale(LC_ALL, nullptr);
  for (const char* locale : {"de_DE.UTF-8", "fr_FR.UTF-8", "C.UTF-8"})
    if (std::setlocale(LC_ALL, locale) != nullptr) {
      EXPECT_EQ(csv_of(small_log()), written_csv());
      EXPECT_THAT(table_of_csv(written_csv(), "f.csv"), SameLog(small_log()));
    }
  std::setlocale(LC_ALL, old.c_str());
}

TEST(LogCsv, EditorsMayChangeLineEndsAndAddAByteOrderMark) {
  std::string text = "\xef\xbb\xbf";
  for (const char c : written_csv()) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_THAT(table_of_csv(text, "f.csv"), SameLog(small_log()));
}

TEST(LogCsv, ItsCommentsMayBeTakenAwayButForTheFirst) {
  LogTable bare = small_log();
  bare.about.clear();
  bare.events.clear();
  EXPECT_THAT(
      table_of_csv("# quadtune-log,1\nt[s],x.px[m],gps.px[m]\n0,0.1,\n5e-3,-2.0,3\n", "f.csv"),
      SameLog(bare));
}

struct Refusal {
  const char* text;  // below the first line
  const char* message;
};

TEST(LogCsv, RefusesWhatIsNoLogWithFileAndLine) {
  const std::vector<Refusal> refusals = {
      {"t[s]\n0\n1,2\n",
       "f.csv:4: the row has 2 fields, expected 1 because there are as many names"},
      {"t[s],x[m]\n0\n",
       "f.csv:3: the row has 1 field, expected 2 because there are as many names"},
      {"t[s],x[m]\n0,1,\n",
       "f.csv:3: the row has 3 fields, expected 2 because there are as many names"},
      {"t[s],x[m]\n\n", "f.csv:3: the row has 1 field, expected 2 because there are as many names"},
      {"\n0\n", "f.csv:3: the row has 1 field, expected 0 because there are as many names"},
      {"t[s]\n0x1\n",
       "f.csv:3: '0x1' is not a number in the range of a double; expected a number, or an empty "
       "field"},
      {"t[s]\n1e999\n",
       "f.csv:3: '1e999' is not a number in the range of a double; expected a number, or an empty "
       "field"},
      {"t[s],x[m]\n one,2\n",
       "f.csv:3: ' one' is not a number in the range of a double; expected a number, or an empty "
       "field"},
      {"t[s]\n\"1\"\n",
       "f.csv:3: '\"1\"' is not a number in the range of a double; expected a number, or an empty "
       "field"},
      {"t[s]\n1\n# event,1,a,b\n",
       "f.csv:4: '# event' is not a number in the range of a double; expected a number, or an "
       "empty "
       "field"},
      {"t\n",
       "f.csv:2: 't' is not a column title, expected a name and its unit in brackets, such as "
       "x.px[m]"},
      {"t[s]x\n",
       "f.csv:2: 't[s]x' is not a column title, expected a name and its unit in brackets, such as "
       "x.px[m]"},
      {"t[s],\n",
       "f.csv:2: '' is not a column title, expected a name and its unit in brackets, such as "
       "x.px[m]"},
      {"[s]\n", "f.csv: a column has no name; expected one because columns are accessed by name"},
      {"t[s],t[m]\n", "f.csv: column name 't' appears twice, expected distinct names"},
      {"\"t[s]\n", "f.csv:2: a quoted field has no closing quote"},
      {"\"t\"[s]\n", "f.csv:2: unexpected text after a quoted field, expected a comma"},
      {"t\\q[s]\n",
       "f.csv:2: '\\q' is not an escape sequence, expected \\\\, \\n or \\x and two hexadecimal "
       "digits"},
      {"t\\x1[s]\n",
       "f.csv:2: '\\x1' is not an escape sequence, expected \\\\, \\n or \\x and two hexadecimal "
       "digits"},
      {"t\\xff[s]\n", "f.csv: the name 't?' is not valid UTF-8"},
      {"# about,a\nt[s]\n", "f.csv:2: 'about' has 2 fields, expected 3"},
      {"# event,1,a\nt[s]\n", "f.csv:2: 'event' has 3 fields, expected 4"},
      {"# event,,a,b\nt[s]\n",
       "f.csv:2: '' is not a number in the range of a double; expected a number, or an empty "
       "field"},
      {"# evnt,1,a,b\nt[s]\n",
       "f.csv:2: '# evnt' is not known, expected '# about', '# event', "
       "'# note' or '# rows'; did you mean '# event'?"},
      {"#\nt[s]\n",
       "f.csv:2: '#' is not known, expected '# about', '# event', '# note' or '# "
       "rows'"},
      {"# rows,x\nt[s]\n", "f.csv:2: 'x' is not a row count"},
      {"# rows,-1\nt[s]\n", "f.csv:2: '-1' is not a row count"},
      {"# rows,0\n# rows,0\nt[s]\n", "f.csv:3: the row count is given twice, expected once"},
      {"# rows,2\nt[s]\n1\n",
       "f.csv: has 1 row, expected 2 as its header states; is it cut short?"},
      {"t[s]\n1", "f.csv:3: the line does not end, expected a line feed; is the file cut short?"},
      {"", "f.csv: has no line of column names below the comments; is it cut short?"},
  };
  for (const Refusal& refusal : refusals)
    EXPECT_THAT(
        [&] {
          std::ignore = table_of_csv(std::string("# quadtune-log,1\n") + refusal.text, "f.csv");
        },
        ThrowsMessage<InvalidInput>(StrEq(refusal.message)))
        << refusal.text;
}

TEST(LogCsv, RefusesOtherFilesByTheirFirstLine) {
  for (const char* text : {"", "t[s]\n0\n", "# quadtune-log,2\nt[s]\n", "# quadtune-log\nt[s]\n"})
    EXPECT_THAT([&] { std::ignore = table_of_csv(text, "f.csv"); },
                ThrowsMessage<InvalidInput>(StartsWith("f.csv:1: the file begins with '")))
        << text;
}

// A torn file is never taken for a shorter flight.
TEST(Logs, EveryPrefixIsRefused) {
  for (const std::uint64_t seed : {0, 5, 11}) {
    const LogTable log = seed == 0 ? small_log() : random_log(seed);
    const std::string csv = csv_of(log);
    for (std::size_t size = 0; size < csv.size(); ++size)
      EXPECT_THROW(std::ignore = table_of_csv(csv.substr(0, size), "f.csv"), InvalidInput) << size;
    const std::string mat = bytes_of_mat(log);
    for (std::size_t size = 0; size < mat.size(); ++size)
      EXPECT_THROW(std::ignore = table_of_mat(mat.substr(0, size), "f.mat"), InvalidInput) << size;
  }
}

// Damage is refused, or it lies in a number or a text and nowhere else.
TEST(LogMat, DamageIsRefusedOrReadWithoutHarm) {
  const std::string whole = bytes_of_mat(small_log());
  std::mt19937_64 random(1);
  int refused = 0;
  for (int i = 0; i < 5000; ++i) {
    std::string bytes = whole;
    for (std::uint64_t k = 1 + random() % 3; k > 0; --k) {
      const std::size_t at = random() % (bytes.size() - 4);
      const auto word = static_cast<std::uint32_t>(random() % 3 == 0 ? random() : random() % 40);
      std::memcpy(bytes.data() + (at & ~std::size_t{3}), &word, sizeof word);
    }
    try {
      std::ignore = table_of_mat(bytes, "f.mat");
    } catch (const InvalidInput&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 3000);
}

// No reader may return memory that it never filled.
TEST(LogMat, RefusesArraysThatClaimMoreThanTheyHold) {
  std::string bytes = bytes_of_mat(small_log());
  const double first = 0.1;  // of x.px
  const std::size_t data =
      bytes.find(std::string(reinterpret_cast<const char*>(&first), sizeof first));
  ASSERT_NE(data, std::string::npos);
  char& rows = bytes[data - 24];  // before it columns, the tag of the empty name, its own tag
  ASSERT_EQ(rows, 2);
  rows = 3;
  EXPECT_THAT(
      [&] { std::ignore = table_of_mat(bytes, "f.mat"); },
      ThrowsMessage<InvalidInput>(StrEq(
          "f.mat: an array of 3 entries has 16 bytes of type 9 at offset " + std::to_string(data) +
          ", expected a complete MAT v5 file; is it cut short or damaged?")));
  rows = 127;
  EXPECT_THAT([&] { std::ignore = table_of_mat(bytes, "f.mat"); },
              ThrowsMessage<InvalidInput>(HasSubstr("an array claims 127 x 1 entries")));
}

// Each level takes stack.
TEST(LogMat, RefusesArraysThatLieTooDeep) {
  const auto tagged = [](std::uint32_t type, const std::string& data) {
    std::string element(8, '\0');
    const auto size = static_cast<std::uint32_t>(data.size());
    std::memcpy(element.data(), &type, 4);
    std::memcpy(element.data() + 4, &size, 4);
    return element + data;
  };
  const std::string flags = tagged(6, std::string("\1\0\0\0\0\0\0\0", 8));  // of cells
  const std::string size = tagged(5, std::string("\1\0\0\0\1\0\0\0", 8));
  std::string nested;
  const std::string head = flags + size + tagged(1, "");
  for (int i = 0; i < 1000; ++i) nested = tagged(14, std::string(head).append(nested));
  EXPECT_THAT(
      [&] {
        std::ignore = table_of_mat(bytes_of_mat(small_log()).substr(0, 128) + nested, "f.mat");
      },
      ThrowsMessage<InvalidInput>(HasSubstr("an array is nested 33 deep")));
}

// What MATLAB and Octave users type is what the pages say.
TEST(LogMat, NamesBecomeFieldsThatMatlabTakes) {
  internal::FieldNames names;
  EXPECT_EQ(names.add("px"), "px");
  EXPECT_EQ(names.add("px"), "px_2");
  EXPECT_EQ(names.add("px_2"), "px_2_2");
  EXPECT_EQ(names.add("1a"), "x1a");
  EXPECT_EQ(names.add("_a"), "x_a");
  EXPECT_EQ(names.add("end"), "xend");
  EXPECT_EQ(names.add("ende"), "ende");
  EXPECT_EQ(names.add(""), "x");
  EXPECT_EQ(names.add("高-b"), "x__b");
  EXPECT_EQ(names.add(std::string(70, 'a')), std::string(63, 'a'));
  EXPECT_EQ(names.add(std::string(80, 'a')), std::string(61, 'a') + "_2");
  EXPECT_THAT(internal::layout_of(
                  {"t", "x.px", "x.py", "x", "units", "units.a", "a-b.c", "a_b.c", "a.b.c.d.e.f"},
                  {"units"})
                  .paths,
              ::testing::ElementsAre("t", "x.px", "x.py", "x_2", "units_2", "units_3.a", "a_b.c",
                                     "a_b_2.c", "a.b.c.d_e_f"));
}

TEST(LogMat, RefusesOtherFilesAndSaysWhy) {
  const std::string mat = bytes_of_mat(small_log());
  const auto with = [&](std::size_t at, const std::string& bytes) {
    return std::string(mat).replace(at, bytes.size(), bytes);
  };
  const std::string hdf5 = "\x89HDF\r\n\x1a\n";
  std::string v73 = "MATLAB 7.3 MAT-file";
  v73.resize(512, ' ');
  const std::string renamed = with(mat.find("flight"), "fright");
  const std::vector<std::pair<std::string, std::string>> refusals = {
      {v73 + hdf5 + v73,
       "f.mat: is a MAT v7.3 file, which is HDF5, expected MAT v5: save it with "
       "-v6"},
      {hdf5 + v73, "f.mat: is a MAT v7.3 file, which is HDF5, expected MAT v5: save it with -v6"},
      {"", "f.mat: has 0 bytes, expected a MAT v5 file, which has a header of 128"},
      {std::string(200, ' '), "f.mat: is not a MAT v5 file according to its header"},
      {with(126, "MI"),
       "f.mat: was written on a machine with the opposite byte order, expected this machine's"},
      {with(128, "\x0f"),
       "f.mat: is compressed, expected an uncompressed MAT file: save it with -v6"},
      {mat.substr(0, 128), "f.mat: has no variable 'flight', expected a log that quadtune wrote"},
      {renamed, "f.mat: has no variable 'flight', expected a log that quadtune wrote"},
  };
  for (const auto& refusal : refusals)
    EXPECT_THAT([&] { std::ignore = table_of_mat(refusal.first, "f.mat"); },
                ThrowsMessage<InvalidInput>(StrEq(refusal.second)));
}

TEST(Logs, RefuseTablesThatNoFileCouldHold) {
  const LogColumn time = {"t", "s", {0, 1}};
  const std::vector<std::pair<LogTable, std::string>> refusals = {
      {{{}, {time, {"x", "m", {0}}}, {}}, "log: column 'x' has 1 row, expected 2 as 't' has"},
      {{{}, {time, time}, {}}, "log: column name 't' appears twice, expected distinct names"},
      {{{}, {{"", "s", {}}}, {}},
       "log: a column has no name; expected one because columns are accessed by name"},
      {{{}, {{"\xff", "s", {}}}, {}}, "log: the name '?' is not valid UTF-8"},
      {{{}, {{"t", "\xc3", {}}}, {}}, "log: the unit '?' is not valid UTF-8"},
      {{{{"\xc0\x80", ""}}, {}, {}}, "log: the key '?\?' is not valid UTF-8"},
      {{{{"a", "\xed\xa0\x80"}}, {}, {}}, "log: the value '?\?\?' is not valid UTF-8"},
      {{{}, {}, {{0, "\xf5\x80\x80\x80", ""}}}, "log: the event '?\?\?\?' is not valid UTF-8"},
      {{{}, {}, {{0, "", "a\x80"}}}, "log: the detail 'a?' is not valid UTF-8"},
  };
  for (const auto& refusal : refusals)
    for (const char* path : {"f.csv", "f.mat"})
      EXPECT_THAT([&] { std::ignore = log_bytes(refusal.first, path); },
                  ThrowsMessage<InvalidInput>(StrEq(refusal.second)))
          << path;
}

TEST(Logs, TheEndingOfTheNameTellsTheFormat) {
  EXPECT_EQ(log_bytes(small_log(), "out/a.b.csv"), csv_of(small_log()));
  EXPECT_EQ(log_bytes(small_log(), "out/a.b.mat"), bytes_of_mat(small_log()));
  for (const char* path : {"flight", "flight.txt", "flight.CSV", "csv", ".csv", "out.csv/flight"}) {
    const std::string message = std::string("cannot tell the log format from '") + path +
                                "': use a file name that ends in .csv or .mat";
    EXPECT_THAT([&] { require_log_name(path, "--log"); },
                ThrowsMessage<InvalidInput>(StrEq("--log: " + message)));
    EXPECT_THAT([&] { std::ignore = log_bytes(small_log(), path); },
                ThrowsMessage<InvalidInput>(StrEq("log: " + message)));
    EXPECT_THAT([&] { std::ignore = read_log(path); },
                ThrowsMessage<InvalidInput>(StrEq("log: " + message)));
  }
}

TEST(Logs, AreReadFromFiles) {
  const TemporaryDirectory directory;
  for (const char* name : {"f.csv", "f.mat"})
    EXPECT_THAT(read_log(directory.write(name, log_bytes(small_log(), name)).string()),
                SameLog(small_log()))
        << name;
  EXPECT_THROW(std::ignore = read_log((directory.path() / "none.csv").string()), FileError);
}

}  // namespace
}  // namespace quadtune
