// SPDX-License-Identifier: Apache-2.0
#include "quadtune/text_matrix.hpp"

#include <gmock/gmock.h>

#include <clocale>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <random>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "shared_data.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

Eigen::MatrixXd parse_matrix(const std::string& text) { return parse_text_matrix(text, "file"); }

TEST(TextMatrix, ReadsBlanksCommasCommentsAndEmptyLines) {
  const Eigen::MatrixXd expected = (Eigen::MatrixXd(2, 3) << 1, -2.5, 3e-4, 4, 5, 6).finished();
  for (const char* text :
       {"1 -2.5 3e-4\n4 5 6\n", "1,-2.5,3e-4\n4,5,6", "1, -2.5, 3E-4\r\n4,\t5 ,6\r\n",
        "# head\n\n  1\t-2.50 0.0003 # tail\n\n+4 5. 6\n\n"})
    EXPECT_THAT(parse_matrix(text), MatrixNear(expected, 0)) << text;
  EXPECT_THAT(parse_matrix("7"), MatrixNear(Eigen::MatrixXd::Constant(1, 1, 7), 0));
}

// Seventeen digits name a double, and the parser finds it, denormals included.
TEST(TextMatrix, ReadsBackTheSameDouble) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t bits = random();
    double value = 0;
    static_assert(sizeof bits == sizeof value);
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;
    char text[40];
    std::snprintf(text, sizeof text, "%.16e", value);
    ASSERT_EQ(parse_matrix(text)(0, 0), value) << text;
  }
  EXPECT_EQ(parse_matrix("5e-324")(0, 0), 5e-324);
}

TEST(TextMatrix, DoesNotDependOnTheLocale) {
  const std::string before = std::setlocale(LC_NUMERIC, nullptr);
  for (const char* name : {"de_DE.UTF-8", "es_UY.UTF-8", "fr_FR.UTF-8"})
    if (std::setlocale(LC_NUMERIC, name) != nullptr) break;
  EXPECT_EQ(parse_matrix("0.5")(0, 0), 0.5);
  std::setlocale(LC_NUMERIC, before.c_str());
}

struct MatrixRefusal {
  const char* name;
  std::string text;
  const char* message;
};

class TextMatrixRefusals : public ::testing::TestWithParam<MatrixRefusal> {};

TEST_P(TextMatrixRefusals, AreOneLineWithPlaceAndReason) {
  EXPECT_THAT([] { (void)parse_matrix(GetParam().text); },
              ThrowsMessage<InvalidInput>(HasSubstr(GetParam().message)));
}

INSTANTIATE_TEST_SUITE_P(
    All, TextMatrixRefusals,
    ::testing::Values(
        MatrixRefusal{"Ragged", "1 2 3 4\n\n1 2 3\n",
                      "file:3: row has 3 numbers, expected 4 as in row 1"},
        MatrixRefusal{"Empty", "", "file: has no numbers, expected a row of numbers on each line"},
        MatrixRefusal{"OnlyComments", "# nothing\n\n", "file: has no numbers"},
        MatrixRefusal{"DecimalComma", "1 2\n0,5 1,5\n",
                      "file:2: '0,5 1,5' has commas within numbers and blanks between them, "
                      "expected a dot as the "
                      "decimal sign"},
        MatrixRefusal{"DecimalCommaAndSeparator", "1,5, 2,5", "expected a dot as the decimal sign"},
        MatrixRefusal{"Word", "1 two", "file:1: 'two' is not a number"},
        MatrixRefusal{"TrailingLetters", "1 2.5m", "file:1: '2.5m' is not a number"},
        MatrixRefusal{"TwoDots", "1.2.3", "'1.2.3' is not a number"},
        MatrixRefusal{"Hexadecimal", "0x10", "'0x10' is not a number"},
        MatrixRefusal{"TwoSigns", "+-1", "'+-1' is not a number"},
        MatrixRefusal{"Semicolon", "1 2; 3 4", "'2;' is not a number"},
        MatrixRefusal{"NotANumber", "1 nan",
                      "file:1: 'nan' is not finite, expected finite numbers"},
        MatrixRefusal{"Infinity", "-inf 1", "file:1: '-inf' is not finite"},
        MatrixRefusal{"Overflow", "1e999", "file:1: '1e999' is beyond the range of a double"},
        MatrixRefusal{"Underflow", "1e-999", "file:1: '1e-999' is beyond the range of a double"},
        MatrixRefusal{"TwoCommas", "1,,2", "file:1: no number before or after a comma"},
        MatrixRefusal{"LeadingComma", ",1", "no number before or after a comma"},
        MatrixRefusal{"TrailingComma", "1,2,", "no number before or after a comma"},
        MatrixRefusal{"ByteOrderMark",
                      "\xef\xbb\xbf"
                      "1 2",
                      "file:1: '???1' is not a number"},
        MatrixRefusal{"Binary", std::string("1 2\0", 4), "file: has a zero byte at offset 3"}),
    [](const auto& test) { return std::string(test.param.name); });

// Not among the cases above: those are made whenever the program starts.
TEST(TextMatrix, RefusesWhatIsTooLarge) {
  EXPECT_THAT([] { (void)parse_matrix(std::string((16 << 20) + 1, ' ')); },
              ThrowsMessage<InvalidInput>(HasSubstr("file: is larger than 16 MiB")));
}

TEST(TextMatrix, ReadsThePublishedGains) {
  QUADTUNE_REQUIRE_DATA(path);
  const Eigen::MatrixXd K = read_text_matrix((path / "uquad" / "K_prop_full.txt").string());
  EXPECT_EQ(K.rows(), 4);
  EXPECT_EQ(K.cols(), 12);
  EXPECT_EQ(K(0, 0), -2.1352434e+01);
}

TEST(TextMatrix, RefusesAMissingFile) {
  EXPECT_THAT([] { (void)read_text_matrix("/no/such/file"); },
              ThrowsMessage<FileError>(StrEq("/no/such/file: No such file or directory")));
}

}  // namespace
}  // namespace quadtune
