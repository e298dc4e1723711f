// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/toml_reader.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::internal {
namespace {

using quadtune::testing::MatrixNear;
using ::testing::HasSubstr;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

TomlTable parse_toml(const std::string& text) { return TomlTable::parse(text, "file.toml"); }

TomlTable body(const std::string& lines) { return parse_toml("[body]\n" + lines).table("body"); }

const std::vector<TomlKey> kBodyKeys = {{"mass", "kg"}, {"inertia", "kg_m2"}, {"name"}};

TEST(TomlReader, ReadsNumbersListsAndTables) {
  const TomlTable file =
      parse_toml("a = 1\nb = [1, 2.5, -3e-2]\nM = [[1, 2],\n [3, 4]]\n[t]\ns = 'x'\n");
  EXPECT_EQ(file.number("a"), 1);
  EXPECT_THAT(file.vector("b"), MatrixNear(Eigen::Vector3d(1, 2.5, -0.03), 0));
  EXPECT_THAT(file.matrix("M"), MatrixNear((Eigen::Matrix2d() << 1, 2, 3, 4).finished(), 0));
  EXPECT_EQ(file.table("t").text("s"), "x");
  EXPECT_EQ(file.where("M"), "file.toml:3");
  EXPECT_EQ(file.table("t").where("s"), "file.toml:6");
  EXPECT_EQ(file.number_or("absent", 7), 7);
}

// Every refusal names the file and the line, what came and what was expected.
struct TomlRefusal {
  const char* name;
  std::function<void()> act;
  const char* message;
};

class TomlRefusals : public ::testing::TestWithParam<TomlRefusal> {};

TEST_P(TomlRefusals, AreOneLineWithPlaceAndReason) {
  EXPECT_THAT(GetParam().act, ThrowsMessage<InvalidInput>(StrEq(GetParam().message)));
}

INSTANTIATE_TEST_SUITE_P(
    All, TomlRefusals,
    ::testing::Values(
        TomlRefusal{
            "WrongUnit", [] { body("\nmass_g = 63").allow(kBodyKeys); },
            "file.toml:3: key 'mass_g' in [body] is not known, expected 'mass_kg' (the unit is "
            "part of the key)"},
        TomlRefusal{
            "NoUnit", [] { body("mass = 63").allow(kBodyKeys); },
            "file.toml:2: key 'mass' in [body] is not known, expected 'mass_kg' (the unit is "
            "part of the key)"},
        TomlRefusal{"Misspelt", [] { body("mas_kg = 63").allow(kBodyKeys); },
                    "file.toml:2: key 'mas_kg' in [body] is not known, expected one of mass_kg, "
                    "inertia_kg_m2, name; did you mean 'mass_kg'?"},
        TomlRefusal{"FirstUnknownInTheFile",
                    [] {
                      body("zz = 1\naa = 2").allow({{"mass", "kg"}});
                    },
                    "file.toml:2: key 'zz' in [body] is not known, expected one of mass_kg"},
        TomlRefusal{"Missing", [] { (void)body("").number("mass_kg"); },
                    "file.toml:1: [body] has no key 'mass_kg', which is required"},
        TomlRefusal{"StringForNumber", [] { (void)body("mass_kg = '63 g'").number("mass_kg"); },
                    "file.toml:2: mass_kg in [body] is the string '63 g', expected a number"},
        TomlRefusal{"NumberForString", [] { (void)body("name = 4").text("name"); },
                    "file.toml:2: name in [body] is 4, expected a string"},
        TomlRefusal{"NumberForTable", [] { (void)parse_toml("body = 4").table("body"); },
                    "file.toml:1: body is 4, expected one table, [body]"},
        TomlRefusal{"Date", [] { (void)body("mass_kg = 1979-05-27").number("mass_kg"); },
                    "file.toml:2: mass_kg in [body] is a date or time, expected a number"},
        TomlRefusal{"NotANumber", [] { (void)body("mass_kg = nan").number("mass_kg"); },
                    "file.toml:2: mass_kg in [body] is nan, expected a finite number"},
        TomlRefusal{"Infinity", [] { (void)body("mass_kg = -inf").number("mass_kg"); },
                    "file.toml:2: mass_kg in [body] is -inf, expected a finite number"},
        TomlRefusal{"OutOfRange",
                    [] { (void)body("mass_kg = -0.063").number("mass_kg", Range::positive()); },
                    "file.toml:2: mass_kg in [body] is -0.063, expected more than 0"},
        TomlRefusal{"LongList", [] { (void)body("x = [1,\n2, 3, 4]").vector3("x"); },
                    "file.toml:2: x in [body] has 4 entries, expected 3 (x, y, z)"},
        TomlRefusal{"WordInList", [] { (void)body("x = [1,\n2, 'a']").vector3("x"); },
                    "file.toml:3: entry 3 of x in [body] is the string 'a', expected a number"},
        TomlRefusal{"RaggedMatrix", [] { (void)body("x = [[1, 2],\n[3]]").matrix("x"); },
                    "file.toml:3: row 2 of x in [body] has 1 number, expected 2 as in row 1"},
        TomlRefusal{"Fraction", [] { (void)body("n = 2.5").integer("n", 1, 9); },
                    "file.toml:2: n in [body] is 2.5, expected a whole number from 1 to 9, written "
                    "without a point or an exponent"},
        TomlRefusal{"WholeWithExponent", [] { (void)body("n = 3e0").integer("n", 1, 9); },
                    "file.toml:2: n in [body] is 3.0, expected a whole number from 1 to 9, written "
                    "without a point or an exponent"},
        TomlRefusal{
            "TwoLines", [] { (void)body("name = 'a\\nb'\nb = \"a\\nb\"").text("b"); },
            "file.toml:3: b in [body] has a line break or another control character, expected "
            "one line of text"},
        TomlRefusal{
            "NameForAFile", [] { (void)body("name = '../x'").word("name"); },
            "file.toml:2: name in [body] is '../x', expected 1 to 64 letters, digits, '.', '_' "
            "or '-' because it is used in file names"},
        TomlRefusal{"DuplicateKey", [] { parse_toml("a = 1\nb = 2\na = 3"); },
                    "file.toml:3: key 'a' is defined twice, expected once"},
        TomlRefusal{
            "DuplicateTable", [] { parse_toml("[a]\n[a]"); },
            "file.toml:2: table [a] is defined twice, expected once, or [[a]] above each entry if "
            "it is a list of tables"},
        TomlRefusal{
            "ListAndTable", [] { parse_toml("[[a]]\n[a]"); },
            "file.toml:2: table [a] is defined twice, expected once, or [[a]] above each entry if "
            "it is a list of tables"},
        TomlRefusal{"ListForATable", [] { (void)parse_toml("[[a]]").table("a"); },
                    "file.toml:1: a is a list of 1 table, expected one table, [a]"},
        TomlRefusal{"TableForAList", [] { (void)parse_toml("[a]").tables("a"); },
                    "file.toml:1: a is a table, expected a list of tables, each under [[a]]"},
        TomlRefusal{
            "UnitAfterANumber", [] { parse_toml("a = 63 g"); },
            "file.toml:1: not TOML: 'g' after a value, expected the end of the line, because "
            "the unit is part of the key"},
        TomlRefusal{"TextWithoutQuotes", [] { parse_toml("a = mambo"); },
                    "file.toml:1: not TOML: the value has no recognizable type, expected a number, "
                    "a text in "
                    "quotes, true, false, [a list] or {a table}"},
        TomlRefusal{"DecimalComma", [] { parse_toml("a = 0,5"); },
                    "file.toml:1: not TOML: ',' after a value, expected a decimal point, or the "
                    "end of the line"},
        TomlRefusal{"TooLarge", [] { parse_toml(std::string((1 << 20) + 1, '\n')); },
                    "file.toml: is larger than 1 MiB (1048576 bytes), expected at most 1 MiB"},
        TomlRefusal{"Binary", [] { parse_toml(std::string("a = 1\n\0", 7)); },
                    "file.toml: has a zero byte at offset 6, expected text; is it a binary file?"},
        TomlRefusal{
            "LongLine", [] { parse_toml("\n# " + std::string(9000, 'x')); },
            "file.toml:2: line has 9002 bytes, expected at most 8192; lists may span lines"}),
    [](const auto& test) { return std::string(test.param.name); });

// toml++ 3.3 frees dotted keys recursively, and so would our own tree.
TEST(TomlReader, RefusesDeepNestingWithoutExhaustingTheStack) {
  std::string key;
  for (int i = 0; i < 4000; ++i) key += "a.";
  EXPECT_THAT([&] { parse_toml("[" + key + "a]\n" + key + "a = 1"); },
              ThrowsMessage<InvalidInput>(HasSubstr("nest more than 8 levels deep")));
  EXPECT_THAT([] { parse_toml("a = " + std::string(8000, '[')); },
              ::testing::Throws<InvalidInput>());
}

TEST(TomlReader, MakesOneLineOfWhateverTheParserSays) {
  for (const char* text : {"\x01 = 1", "a = \"\x7f\"", "\xff\xfe", "[", "a = \"\\q\"", "= 1"}) {
    try {
      parse_toml(text);
      ADD_FAILURE() << "accepted " << text;
    } catch (const InvalidInput& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      EXPECT_EQ(error.where(), "file.toml:1");
    }
  }
}

TEST(TextFile, RefusesWhatCannotBeRead) {
  EXPECT_THAT([] { (void)read_text_file("/no/such/file", 10); },
              ThrowsMessage<FileError>(StrEq("/no/such/file: No such file or directory")));
  EXPECT_THAT([] { (void)read_text_file("/", 10); },
              ThrowsMessage<FileError>(StrEq("/: Is a directory, expected a file")));
  EXPECT_THAT([] { (void)read_text_file("/dev/zero", 1 << 20); },
              ThrowsMessage<InvalidInput>(HasSubstr("/dev/zero: is larger than 1 MiB")));
}

}  // namespace
}  // namespace quadtune::internal
