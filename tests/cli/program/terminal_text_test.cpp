// SPDX-License-Identifier: Apache-2.0
/// Output on a terminal: errors of one short line, no escapes, tables that fit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "program/completion.hpp"
#include "program/program.hpp"
#include "program/standard_streams.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/utf8.hpp"
#include "report/text/error_line.hpp"
#include "report/text/fold_text.hpp"
#include "run_program.hpp"
#include "sanitized.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune::cli {
namespace {

using quadtune::testing::ProgramResult;
using quadtune::testing::run_program;
using quadtune::testing::TemporaryDirectory;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

TEST(ErrorLine, KeepsThePlaceAndTheExpectation) {
  const std::string line =
      error_line("x.toml:3: '" + std::string(200000, 'a') + "' is invalid; expected a number");
  EXPECT_LE(line.size(), kMaxError);
  EXPECT_THAT(line, StartsWith("x.toml:3: 'aaaa"));
  EXPECT_THAT(line, HasSubstr(" ... "));
  EXPECT_THAT(line, EndsWith("aaaa' is invalid; expected a number"));
  EXPECT_EQ(error_line("a\nb\x1b[1m"), "a b\\x1b[1m");
  // Characters of two bytes are not cut.
  std::string wide;
  for (int i = 0; i < 1000; ++i) wide += "\xc3\xb6";
  EXPECT_EQ(internal::valid_utf8(error_line("a" + wide)), error_line("a" + wide));
}

// Regression test: an argument of 200 kB gave an error of 200 kB.
TEST(ErrorLine, IsShortWhateverComes) {
  const std::string huge(200000, 'x');
  for (const std::vector<std::string>& args :
       std::vector<std::vector<std::string>>{{huge},
                                             {"--" + huge},
                                             {"lqr", huge},
                                             {"lqr", "--" + huge},
                                             {"lqr", "--A", huge},
                                             {"lqr", "mambo", "--Q", huge},
                                             {"fly", huge},
                                             {"fly", "mambo", "--mission", huge},
                                             {"fly", "mambo", "--wind", huge},
                                             {"fly", "mambo", "--gains", huge},
                                             {"fly", "mambo", "--sensors", huge},
                                             {"fly", "mambo", "--controller", huge},
                                             {"design", huge},
                                             {"verify", huge},
                                             {"help", huge},
                                             {"log", huge},
                                             {"campaign", huge},
                                             {"pid", "mambo", "--bandwidth", huge}}) {
    std::vector<std::string> with_json = args;
    with_json.emplace_back("--json");
    const ProgramResult result = run_program(with_json);
    EXPECT_NE(result.status, 0);
    EXPECT_LE(result.err.size(), kMaxError + 1) << args[0].substr(0, 20);
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
    EXPECT_LE(result.out.size(), 2 * kMaxError + 100);
  }
}

TEST(VisibleText, ShowsWhatComesInPieces) {
  const std::string text = "a\xe2\x80\xae b\x1b[2J \xc3\xb6 \xff";
  for (std::size_t piece = 1; piece <= text.size(); ++piece) {
    std::ostringstream to;
    VisibleText visible(to, 0);
    std::ostream stream(&visible);
    for (std::size_t i = 0; i < text.size(); i += piece) stream << text.substr(i, piece);
    stream.flush();
    EXPECT_EQ(to.str(), "a\\u202e b\\x1b[2J \xc3\xb6 \\xff");
  }
}

// Names of columns, files and vehicles.
TEST(VisibleText, NamesObeyNoTerminal) {
  const TemporaryDirectory directory;
  const std::string name = "g\x1b[31m\xe2\x80\xae\xc2\x9b";
  const std::string log =
      directory.write("l" + name + ".csv", "t_s," + name + "[rad/s]\n0,1\n0.1,2\n0.2,3\n").string();
  for (const std::vector<std::string>& args :
       std::vector<std::vector<std::string>>{{"log", log},
                                             {"log", log, "--json"},
                                             {"log", log + "x"},
                                             {"vehicle", "show", name},
                                             {"fly", "mambo", "--gains", log},
                                             {"design", directory.path().string() + "/" + name}}) {
    const ProgramResult result = run_program(args);
    EXPECT_EQ(internal::visible_text(result.out), result.out);
    EXPECT_EQ(internal::visible_text(result.err), result.err);
  }
  EXPECT_THAT(run_program({"log", log}).out, HasSubstr("g\\x1b"));
}

TEST(Folded, LeavesWhatFitsAlone) {
  const std::string text = "a  b\n\n1  2\n";
  EXPECT_EQ(folded(text, 10), text);
  EXPECT_EQ(folded(text, 0), text);
  EXPECT_EQ(folded("no line feed", 80), "no line feed");
}

TEST(Folded, MakesOneTableSeveral) {
  EXPECT_EQ(folded("gain K           w1     w2     w3\n"
                   "            z   1.5    2.5    3.5\n"
                   "            x  -1.5  -2.25   -3.5\n"
                   "next        word\n",
                   28),
            "gain K           w1     w2\n"
            "            z   1.5    2.5\n"
            "            x  -1.5  -2.25\n"
            "\n"
            "                 w3\n"
            "            z   3.5\n"
            "            x  -3.5\n"
            "next        word\n");
}

TEST(Folded, WrapsBelowTheTextOfAHeading) {
  EXPECT_EQ(folded("poles       one two three four\n", 26),
            "poles       one two three\n"
            "            four\n");
  EXPECT_EQ(folded("one two three four", 10), "one two\n  three\n  four");
  EXPECT_EQ(folded(std::string(30, 'x') + " y\n", 10), std::string(30, 'x') + "\n  y\n");
}

// Every command that prints a table, in a terminal of the smallest common width.
TEST(Folded, EveryTableFitsAtEightyColumns) {
  if (quadtune::testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  for (const std::vector<std::string>& args : std::vector<std::vector<std::string>>{
           {"lqr", "mambo"},
           {"lqr", "uquad", "--convention", "uquad", "--method", "discrete", "--dt", "0.01"},
           {"linearize", "mambo"},
           {"pid", "mambo"},
           {"fly", "mambo", "--gains", "published", "--duration", "2"},
           {"vehicle", "list"},
           {"vehicle", "show", "uquad"},
           {"discretize", "mambo", "--compare", "--dt", "0.01"},
           {"fly", "mambo", "--duration", "2"},
           {"design", testing::source_folder() + "/designs/uquad-hover.toml"},
           {"help"},
           {"help", "lqr"},
           {"help", "fly"}}) {
    const std::string wide = run_program(args).out;
    EXPECT_NE(wide, "") << args[0];
    const std::string narrow = folded(wide, 80);
    std::istringstream lines(narrow);
    for (std::string line; std::getline(lines, line);) {
      if (line.find('/') != std::string::npos) continue;  // a path may be longer
      const auto characters = std::count_if(line.begin(), line.end(), [](char c) {
        return (static_cast<unsigned char>(c) & 0xc0U) != 0x80;
      });
      EXPECT_LE(characters, 80) << line;
    }
    // Nothing is lost: every word occurs as often as before or, for names of rows, more often.
    std::istringstream words(wide);
    for (std::string word; words >> word;) EXPECT_THAT(narrow, HasSubstr(word)) << args[0];
  }
}

TEST(Folded, JsonIsNot) {
  std::istringstream in;
  std::ostringstream wide, narrow, err;
  (void)run({"lqr", "mambo", "--json"}, in, wide, err);
  (void)run({"lqr", "mambo", "--json"}, in, narrow, err, 40);
  EXPECT_EQ(wide.str(), narrow.str());
  std::ostringstream text;
  (void)run({"lqr", "mambo"}, in, text, err, 80);
  EXPECT_EQ(text.str(), folded(run_program({"lqr", "mambo"}).out, 80));
}

TEST(Completion, ReadsTheWordsOfADescription) {
  EXPECT_THAT(listed_words("uquad, mambo or json"), ElementsAre("uquad", "mambo", "json"));
  EXPECT_THAT(listed_words("optical flow: full (default), simplified or off"),
              ElementsAre("full", "simplified", "off"));
  EXPECT_THAT(listed_words("ideal, or real (default): the sensors of the vehicle file"),
              ElementsAre("ideal", "real"));
  EXPECT_THAT(listed_words("calm (default), light, or a list: north=3,gust_east=2"),
              ElementsAre("calm", "light"));
  EXPECT_THAT(listed_words("designed (default), published, a design file, an export"),
              ElementsAre("designed", "published"));
  EXPECT_THAT(listed_words("dynamics (nx x nx)"), Not(::testing::Contains("nx")));
}

TEST(Completion, OffersWhatIsBuiltInAndTheValuesOfOptions) {
  const std::string text = run_program({"help", "--completion"}).out;
  const std::size_t begin = text.find("    fly) ");
  const std::string fly = text.substr(begin, text.find('\n', begin) - begin);
  EXPECT_THAT(fly, AllOf(HasSubstr("values=\"mambo rolling-spider uquad crazyflie\""),
                         HasSubstr("--mission) values=\"hover "), HasSubstr(" lemniscate "),
                         HasSubstr("--controller) values=\"cascaded-pid state-feedback firmware\""),
                         HasSubstr("--gains) values=\"designed published\""),
                         HasSubstr("--sensors) values=\"ideal real\"")));
  EXPECT_THAT(fly, HasSubstr("--wind) values=\"calm light moderate severe\""));
}

// The script run by bash itself.
TEST(Completion, WorksInBash) {
  const TemporaryDirectory folder;
  folder.write("my quad.toml", "");
  const std::string script =
      folder.write("completion", run_program({"help", "--completion"}).out).string();
  const auto offered = [&](const std::string& words) {
    const std::string call =
        "COMP_WORDS=(quadtune " + words + "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _quadtune";
    const std::string command = "cd '" + folder.path().string() + "' && bash -c '. " + script +
                                "; " + call + "; printf \"%s;\" \"${COMPREPLY[@]}\"'";
    FILE* const bash = ::popen(command.c_str(), "r");
    std::string text;
    for (int c = std::fgetc(bash); c != EOF; c = std::fgetc(bash)) text += static_cast<char>(c);
    EXPECT_EQ(::pclose(bash), 0) << command;
    return text;
  };
  EXPECT_EQ(offered("fl"), "fly;");
  EXPECT_EQ(offered("fly m"), "mambo;my quad.toml;");
  EXPECT_EQ(offered("fly --json mam"), "mambo;");
  EXPECT_EQ(offered("fly mambo --wind mo"), "moderate;");
  EXPECT_EQ(offered("fly mambo --seed m"), "my quad.toml;");
  EXPECT_EQ(offered("tune ka"), "kalman;");
  EXPECT_EQ(offered("fly --estim"), "--estimator;");
}

}  // namespace
}  // namespace quadtune::cli
