// SPDX-License-Identifier: Apache-2.0
/// Tests of the mutations: every failure is found, and the same number gives the same case.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <set>
#include <stdexcept>

#include "program/program.hpp"
#include "run_cases.hpp"
#include "sanitized.hpp"
#include "temporary_directory.hpp"
#include "tree.hpp"

namespace quadtune::mutations {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ProgramResult;
using testing::TemporaryDirectory;

/// The result of ten cases of a program that misbehaves in case 3.
struct Outcome {
  std::vector<std::string> found;
  Tally tally;
};

Outcome outcome(const std::function<ProgramResult()>& misbehave, const Command& words = {"lqr"}) {
  const TemporaryDirectory directory;
  Outcome result;
  Run run;
  run.limits = {0.2, 0.3, 600, testing::kSanitized ? 0 : std::size_t{1} << 30U};
  run.place = directory.path() / "place";
  run.make = [&](std::uint64_t number) {
    return Case{1, number, "any", {{"f", std::to_string(number)}}, {words}};
  };
  run.program = [&](const Command&, const std::string& folder) {
    std::ifstream file(folder + "/f");
    std::uint64_t number = 0;
    file >> number;
    return number == 3 ? misbehave() : ProgramResult{};
  };
  run.found = [&](const Finding& finding) {
    EXPECT_EQ(finding.of.number, 3U);
    EXPECT_EQ(finding.command, words);
    result.found.push_back(finding.what);
  };
  result.tally = run_cases(run, 0, 10);
  return result;
}

ProgramResult stop(int signal) {
  ::signal(signal, SIG_DFL);
  ::raise(signal);
  return {};
}

[[noreturn]] void run_for_ever() {
  volatile bool on = true;
  while (on) {
  }
  std::abort();
}

TEST(RunCases, FindsNothingWhereAllIsWell) {
  const Outcome good = outcome([] { return ProgramResult{3, "", "v.toml: mass is 0\n"}; });
  EXPECT_THAT(good.found, IsEmpty());
  EXPECT_EQ(good.tally.cases, 10U);
  EXPECT_THAT(good.tally.statuses, ElementsAre(std::pair(0, 9U), std::pair(3, 1U)));
}

TEST(RunCases, FindsTheEndOfTheProcessAndGoesOn) {
  const Outcome killed = outcome([] { return stop(SIGSEGV); });
  EXPECT_THAT(killed.found, ElementsAre(HasSubstr("is ended by signal 11")));
  EXPECT_EQ(killed.tally.cases, 9U);
  const Outcome aborted = outcome([]() -> ProgramResult {
    std::cerr << "what(): gamma" << std::endl;
    std::abort();
  });
  EXPECT_THAT(aborted.found, ElementsAre(HasSubstr("is ended by signal 6: what(): gamma")));
  const Outcome left = outcome([]() -> ProgramResult { ::_exit(0); });
  EXPECT_THAT(left.found, ElementsAre(HasSubstr("ends the process with 0")));
}

TEST(RunCases, FindsExceptionsAndWhatIsNotDocumented) {
  EXPECT_THAT(outcome([]() -> ProgramResult { throw std::out_of_range("map::at"); }).found,
              ElementsAre(HasSubstr("an exception leaves it: St12out_of_range: map::at")));
  EXPECT_THAT(outcome([] {
                return ProgramResult{6, "", "why\n"};
              }).found,
              ElementsAre(HasSubstr("ends with 6, expected 0 to 5")));
  EXPECT_THAT(outcome([] {
                return ProgramResult{130, "", "interrupted\n"};
              }).found,
              ElementsAre(HasSubstr("as if interrupted")));
  EXPECT_THAT(outcome([] {
                return ProgramResult{3, "", ""};
              }).found,
              ElementsAre(HasSubstr("does not say why")));
  EXPECT_THAT(outcome([] {
                std::cout << "library: warning" << std::endl;
                return ProgramResult{};
              }).found,
              ElementsAre(HasSubstr("writes past its streams: library: warning")));
}

TEST(RunCases, TellsWhatTakesTooLongToStop) {
  const Outcome deaf = outcome([]() -> ProgramResult {
    ::signal(SIGALRM, SIG_IGN);  // so that the program does not end itself
    run_for_ever();
  });
  EXPECT_THAT(deaf.found, ElementsAre(HasSubstr("goes on for 0.3 s")));
  const Outcome obedient = outcome([] {
    while (!cli::interrupted()) {
    }
    return ProgramResult{130, "", "interrupted\n"};
  });
  EXPECT_THAT(obedient.found, IsEmpty());
  EXPECT_EQ(obedient.tally.stopped, 1U);
  EXPECT_EQ(obedient.tally.cases, 10U);
}

TEST(RunCases, LimitsMemory) {
  if (testing::kSanitized) GTEST_SKIP() << "a sanitizer needs all addresses";
  const Outcome greedy = outcome([] {
    try {
      const std::vector<char> much(std::size_t{2} << 30U);
      return ProgramResult{0, std::string(much.data()), ""};
    } catch (const std::bad_alloc&) {
      return ProgramResult{3, "", "not enough memory\n"};
    }
  });
  EXPECT_THAT(greedy.tally.statuses, Contains(std::pair(3, 1U)));
}

TEST(Complaint, LooksAtWhatIsPrinted) {
  const auto of = [](const Command& command, int status, const std::string& out,
                     const std::string& err = "") {
    return complaint(command, {status, out, err}, false);
  };
  const Command json = {"lqr", "--json", "--quiet"}, text = {"lqr", "--quiet"};
  EXPECT_EQ(of(json, 0, "{\"K\": [[1, 2]], \"margins\": {\"gain\": null}}\n"), "");
  EXPECT_THAT(of(json, 0, "{\"K\": [[1, null]]}\n"), HasSubstr("has null in K"));
  EXPECT_THAT(of(json, 0, "{\"a\": {\"poles\": [[null, 0]]}}\n"), HasSubstr("null in poles"));
  EXPECT_THAT(of(text, 0, "K  nan 1\n"), HasSubstr("prints nan"));
  EXPECT_EQ(complaint(text, {0, "note  nan\n", ""}, false, {{"d.toml", "note = \"nan\""}}), "");
  EXPECT_THAT(of(json, 0, "{\"K\": [[nan]]}\n"), HasSubstr("no JSON"));
  EXPECT_THAT(of(json, 0, "{} {}\n"), HasSubstr("no JSON"));
  EXPECT_THAT(of(json, 0, ""), HasSubstr("no JSON"));
  EXPECT_EQ(of(json, 3, R"({"error": {"code": 3, "message": "m", "where": "w"}})", "m\n"), "");
  EXPECT_THAT(of(json, 3, R"({"error": {"code": 2}})", "m\n"), HasSubstr("another code"));
  EXPECT_THAT(of(json, 3, "{}", "m\n"), HasSubstr("without its error"));
  EXPECT_THAT(of(json, 0, R"({"error": {"code": 2}})"), HasSubstr("as if there were none"));
  EXPECT_THAT(of(text, 3, "", "m\nmore\n"), HasSubstr("in 2 lines"));
  EXPECT_THAT(of(text, 0, "poles -nan 1\n"), HasSubstr("prints nan"));
  EXPECT_THAT(of(text, 0, "", "note\n"), HasSubstr("not quiet"));
  EXPECT_EQ(of({"lqr"}, 0, "nanometre\n", "note\n"), "");
}

TEST(Random, IsTheSameEverywhere) {
  // The first numbers of the reference implementation for the seed 1234567.
  Random random(1234567);
  EXPECT_EQ(random.next(), 6457827717110365317U);
  EXPECT_EQ(random.next(), 3203168211198807973U);
}

TEST(Cases, ANumberMakesOneCaseAndAnotherAnother) {
  const TemporaryDirectory directory;
  const Cases cases(all_kinds((directory.path() / "samples").string()), options_of_commands(), 5);
  EXPECT_GE(cases.kinds().size(), 21U);
  std::set<std::string> texts;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const Case one = cases.make(i), again = cases.make(i);
    EXPECT_EQ(one.files, again.files);
    EXPECT_EQ(one.commands, again.commands);
    std::string text;
    for (const auto& [name, bytes] : one.files) text += bytes;
    for (const Command& command : one.commands) text += typed(command, "");
    texts.insert(text);
  }
  EXPECT_GT(texts.size(), 190U);
  // Every kind must be documented.
  std::string readme = project_file("tests/mutations/README.md");
  for (const Kind& kind : cases.kinds())
    EXPECT_THAT(readme, HasSubstr("| " + kind.name + " |")) << "tests/mutations/README.md";
}

// Every sample is valid: its first command accepts it.
TEST(Cases, TheSamplesAreValid) {
  const TemporaryDirectory directory;
  const Cases cases(all_kinds((directory.path() / "samples").string()), options_of_commands(), 5);
  for (const Case& one : cases.unchanged()) {
    const TemporaryDirectory folder;
    for (const auto& [name, bytes] : one.files) folder.write(name, bytes);
    const ProgramResult result = run_command(one.commands.front(), folder.path().string());
    EXPECT_LE(result.status, 1) << one.kind << ": " << typed(one.commands.front(), "@") << "\n"
                                << result.err;
  }
}

TEST(Tree, WritesWhatItRead) {
  const std::string toml = "a = 1\nb = [1.5, \"x\"]\n[c]\nd = { e = true }\n[[f]]\ng = -3\n[[f]]\n";
  EXPECT_EQ(
      json_of(tree_of_toml(toml)),
      json_of(tree_of_json(R"({"a":1,"b":[1.5,"x"],"c":{"d":{"e":true}},"f":[{"g":-3},{}]})")));
  EXPECT_EQ(json_of(tree_of_toml(toml_of(tree_of_toml(toml)))), json_of(tree_of_toml(toml)));
}

}  // namespace
}  // namespace quadtune::mutations
