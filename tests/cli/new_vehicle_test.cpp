// SPDX-License-Identifier: Apache-2.0
// A vehicle of one's own from a scale and a ruler to exported gains.
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "quadtune/internal/text_file.hpp"
#include "run_program.hpp"
#include "sanitized.hpp"
#include "temporary_directory.hpp"

namespace quadtune::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using SortedJson = nlohmann::json;

const std::vector<std::string> kMeasured = {"vehicle", "new",   "own",         "--mass", "1240g",
                                            "--arm",   "225mm", "--propeller", "9.4in"};

std::vector<std::string> and_also(std::vector<std::string> words,
                                  const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST(VehicleNew, WritesAFileThatChecks) {
  const TemporaryDirectory folder;
  const std::string file = (folder.path() / "own.toml").string();
  const ProgramResult made = run_program(and_also(kMeasured, {"-o", file}));
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.err, AllOf(HasSubstr("vehicle: note: moment of inertia about body x "),
                              HasSubstr("is an estimate within 30 %, from a sphere")));
  const ProgramResult check = run_program({"vehicle", "check", file});
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_THAT(check.out, Not(HasSubstr("warning")));
  const ProgramResult shown = run_program({"vehicle", "show", file});
  EXPECT_THAT(shown.out,
              HasSubstr("spread      mass 2 %, inertia 30 %, thrust 25 %, motor_lag 40 %"));
  const SortedJson json = SortedJson::parse(run_program(and_also(kMeasured, {"--json"})).out);
  EXPECT_EQ(json["file"], internal::read_text_file(file, 1 << 20));
  EXPECT_EQ(json["spread"]["inertia"], 0.3);
  EXPECT_EQ(json["estimates"].size(), 4U);
}

TEST(VehicleNew, Asks) {
  const std::string answers = "1240g\n225mm\n9.4 in\n5200rpm\n\n";
  const ProgramResult asked = run_program({"vehicle", "new", "own", "--ask"}, answers);
  ASSERT_EQ(asked.status, 0) << asked.err;
  EXPECT_THAT(asked.err, HasSubstr("Optional: rotor speed in hover (e.g. 5200rpm): "));
  EXPECT_EQ(asked.out, run_program(and_also(kMeasured, {"--hover-speed", "5200rpm"})).out);
  // What is given is not asked for, and an input that ends leaves what is required missing.
  const ProgramResult ended =
      run_program({"vehicle", "new", "own", "--ask", "--mass", "1240g"}, "225mm\n");
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, AllOf(Not(HasSubstr("Mass, ready to fly")),
                               HasSubstr("the answer for --propeller was empty, expected a number "
                                         "with its unit, such as 9.4in")));
}

TEST(VehicleNew, RefusesInOneLine) {
  const auto refused = [](const std::vector<std::string>& words) {
    const ProgramResult result = run_program(words);
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    return result.err;
  };
  EXPECT_THAT(refused({"vehicle", "new", "own"}),
              HasSubstr("quadtune vehicle: new needs --mass, such as --mass 1240g; --ask asks"));
  EXPECT_THAT(refused({"vehicle", "new"}), HasSubstr("new needs a name"));
  EXPECT_THAT(refused({"vehicle", "new", "uquad", "--mass", "1kg"}),
              HasSubstr("'uquad' is the name of a built-in vehicle; choose another"));
  EXPECT_THAT(refused(and_also(kMeasured, {"--lag", "40"})),
              HasSubstr("--lag is '40', expected a number greater than 0 with a unit: ms or s"));
  EXPECT_THAT(refused(and_also(kMeasured, {"--inertia", "0.01kgm2"})),
              HasSubstr("--inertia has 1 entry, expected 3"));
  EXPECT_THAT(refused(and_also(kMeasured, {"--inertia", "0.01kgm2,0.01kgm2,0.03kgm2"})),
              HasSubstr("inertia"));
  EXPECT_THAT(refused(and_also(kMeasured, {"--layout", "h"})),
              HasSubstr("--layout is 'h', expected x or plus"));
  EXPECT_THAT(refused(and_also(kMeasured, {"--max-thrust", "3N"})),
              HasSubstr("one rotor's share of the weight of 1.24 kg"));
  EXPECT_THAT(refused({"vehicle", "show", "mambo", "--mass", "1kg"}),
              HasSubstr("--mass belongs to vehicle new"));
  EXPECT_THAT(refused({"vehicle", "new", "my quad", "--mass", "1240g", "--arm", "225mm",
                       "--propeller", "9.4in"}),
              HasSubstr("name"));
}

// From four numbers to verified exports: the design of a vehicle without a design file.
TEST(VehicleNew, IsDesignedFlownAndExported) {
  const TemporaryDirectory folder;
  const std::string file = (folder.path() / "own.toml").string();
  const std::string out = (folder.path() / "out").string();
  ASSERT_EQ(run_program(and_also(kMeasured, {"-o", file})).status, 0);
  const ProgramResult designed = run_program({"design", file, "--seeds", "1", "-o", out, "--json"});
  ASSERT_EQ(designed.status, 0) << designed.err << designed.out;
  const SortedJson json = SortedJson::parse(designed.out);
  EXPECT_EQ(json["missions"].size(), 9U);  // three, and each with a gust and with a load
  for (const char* kind : {"/json", "/c"}) {
    const ProgramResult verified = run_program({"verify", out + kind, "--vehicle", file});
    EXPECT_EQ(verified.status, 0) << verified.err << verified.out;
  }
}

// Vehicles of other sizes and layouts pass as well: none of them was used to choose a number.
TEST(VehicleNew, OtherVehiclesFlyTheirDefaultDesign) {
  if (kSanitized) GTEST_SKIP() << "flights of minutes";
  const TemporaryDirectory folder;
  const std::vector<std::vector<std::string>> vehicles = {
      {"hexa", "--mass", "2.6kg", "--arm", "300mm", "--propeller", "11in", "--rotors", "6",
       "--hover-speed", "4300rpm", "--thrust-to-weight", "2.1"},
      {"racer", "--mass", "640g", "--arm", "110mm", "--propeller", "5.1in", "--blades", "3",
       "--max-thrust", "900gf", "--sensors", "flow"},
      {"plus", "--mass", "3.9lb", "--arm", "14in", "--propeller", "13in", "--layout", "plus",
       "--spin", "ccw"},
      {"octo", "--mass", "5.2kg", "--arm", "420mm", "--propeller", "12in", "--rotors", "8"},
      {"toy", "--mass", "38g", "--arm", "46mm", "--propeller", "46mm", "--brushed", "--sensors",
       "flow"}};
  for (const std::vector<std::string>& words : vehicles) {
    const std::string file = (folder.path() / (words[0] + ".toml")).string();
    ASSERT_EQ(run_program(and_also(and_also({"vehicle", "new"}, words), {"-o", file})).status, 0);
    const ProgramResult designed = run_program({"design", file, "--seeds", "2"});
    EXPECT_EQ(designed.status, 0) << words[0] << designed.err << designed.out;
  }
}

TEST(VehicleNew, DoesNotReplaceAFile) {
  const TemporaryDirectory folder;
  const std::string file = folder.write("own.toml", "edited\n").string();
  const ProgramResult again = run_program(and_also(kMeasured, {"-o", file}));
  EXPECT_EQ(again.status, 5);
  EXPECT_THAT(again.err,
              HasSubstr("own.toml: exists, and may have been edited; expected the name"));
  std::ifstream kept(file);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(kept), {}), "edited\n");
  EXPECT_EQ(run_program(and_also(kMeasured, {"-o", file, "--force"})).status, 0);
  EXPECT_EQ(run_program({"vehicle", "check", file}).status, 0);
}

// What is not known of the vehicle is in the box and in the campaign.
TEST(VehicleNew, ItsSpreadIsInTheCampaign) {
  const TemporaryDirectory folder;
  ASSERT_EQ(run_program(and_also(kMeasured, {"-o", (folder.path() / "own.toml").string()})).status,
            0);
  const std::string file =
      folder
          .write("c.toml",
                 "name = \"own\"\nvehicle = \"own.toml\"\nflights = 2\n"
                 "[[mission]]\nmission = \"hover\"\nduration_s = 2\n"
                 "[[vary]]\nquantity = \"mass\"\nuniform = { low = 0.9, high = "
                 "1.1 }\n")
          .string();
  const std::string out = (folder.path() / "campaign").string();
  const ProgramResult made = run_program({"campaign", "init", file, out});
  ASSERT_EQ(made.status, 0) << made.err;
  const SortedJson plan = SortedJson::parse(internal::read_text_file(out + "/plan.json", 1 << 24));
  std::vector<std::string> varied;
  for (const SortedJson& number : plan["uncertainty"]["numbers"])
    varied.push_back(number["quantity"]);
  EXPECT_THAT(varied, ::testing::ElementsAre("mass", "inertia_x", "inertia_y", "inertia_z",
                                             "thrust", "motor_lag"));
}

}  // namespace
}  // namespace quadtune::testing
