// SPDX-License-Identifier: Apache-2.0
/// The page of gains that were tuned over missions: as a file, and in a browser.
#include "report/page/gains_page.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "browser_page.hpp"
#include "hostile_texts.hpp"
#include "numbers.hpp"
#include "run_program.hpp"

namespace quadtune::testing {
namespace {

using report::GainsPage;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using testing::kInfinity;
using testing::kNaN;

/// The page that the program writes for gains of the Mambo; of a longer search for the picture of
/// the documentation.
const std::string& example_of_gains() {
  static const std::string page = [] {
    const TemporaryDirectory folder;
    std::vector<std::string> args = {"--mission",     "hover", "--duration",    "12",
                                     "--evaluations", "60",    "--monte-carlo", "2",
                                     "--proof",       "4"};
    if (std::getenv("QUADTUNE_UPDATE_DOCS") != nullptr)
      args = {"--mission", "hover", "--mission", "waypoints", "--evaluations", "600"};
    args.insert(args.begin(), {"tune", "pid", "mambo", "--budget", "600", "--report",
                               (folder.path() / "gains.html").string()});
    const ProgramResult result = run_program(args);
    EXPECT_THAT(result.status, ::testing::AnyOf(0, 1)) << result.err;
    return folder.read("gains.html");
  }();
  return page;
}

GainsPage hostile_gains() {
  std::string text;
  for (const std::string& one : hostile_texts()) text += one + " ";
  GainsPage page;
  page.title = page.counts = page.command = page.version = page.seed = text;
  page.verdict = report::ReportVerdict::fail;
  page.columns = {text, text, text};
  for (const char* id : {"missions", "margins", "gains"}) {
    report::PageComparedTable table{id, text, text, {}};
    for (const std::string& one : hostile_texts()) {
      page.about.emplace_back(one, one);
      page.reasons.push_back(one);
      table.rows.push_back({one,
                            one,
                            one,
                            {kNaN, kInfinity, -1e300},
                            1e-300,
                            true,
                            {true, false, true},
                            true,
                            true});
      table.rows.push_back({text, one, "", {0.0, -0.0, 1}, kNaN, false, {}, false, false});
    }
    page.tables.push_back(table);
  }
  page.search = {{1, 2, 3}, {2, 2, 1}, {kNaN, 1e300, 1}};
  page.flown = {
      {{{}, {{"t", "s", {0, 1, 2}}, {"a", "m", {1, kNaN, kInfinity}}}, {{0.5, text, text}}},
       {text, text, {{text, "a"}}}}};
  return page;
}

TEST(GainsPage, TellsStartFoundAndPublished) {
  const nlohmann::json data = data_of(example_of_gains());
  EXPECT_EQ(data["title"], "mambo over hover");
  EXPECT_THAT(data["counts"].get<std::string>(), HasSubstr("Cost "));
  ASSERT_EQ(data["columns_of"].size(), 3U);
  EXPECT_EQ(data["columns_of"][0], "start");
  EXPECT_EQ(data["columns_of"][2], "published");
  ASSERT_EQ(data["tables"].size(), 4U);
  const nlohmann::json& missions = data["tables"][0]["rows"];
  const auto tracking = std::find_if(missions.begin(), missions.end(), [](const auto& row) {
    return row["label"] == "tracking error, rms";
  });
  ASSERT_NE(tracking, missions.end());
  EXPECT_EQ((*tracking)["of"], "hover");
  EXPECT_LT((*tracking)["values"][1], (*tracking)["values"][2]);  // better than the published gains
  EXPECT_EQ((*tracking)["limit"], 0.05);
  EXPECT_THAT((*tracking)["broken"], ElementsAre(false, false, false));
  // Four margins for each of six loops, and a limit of Ms: that of the start.
  const nlohmann::json& margins = data["tables"][1]["rows"];
  ASSERT_EQ(margins.size(), 24U);
  for (std::size_t i = 0; i < margins.size(); i += 4) {
    EXPECT_EQ(margins[i]["label"], "Ms");
    EXPECT_NEAR(margins[i]["limit"], margins[i]["values"][0], 1e-4);
    EXPECT_LE(margins[i]["values"][1], margins[i]["limit"]);
    EXPECT_THAT(margins[i]["broken"], ElementsAre(false, false, true));
    EXPECT_TRUE(margins[i + 1]["limit"].is_null());
  }
  // The same four margins at each component of the wrench, of the flown loop.
  const nlohmann::json& flown = data["tables"][2]["rows"];
  EXPECT_EQ(data["tables"][2]["title"], "Margins of the flown loop");
  ASSERT_EQ(flown.size(), 16U);
  for (std::size_t i = 0; i < flown.size(); i += 4) {
    EXPECT_EQ(flown[i]["label"], "Ms");
    for (const nlohmann::json& value : flown[i]["values"]) EXPECT_GE(value, 1);
  }
  EXPECT_EQ(data["tables"][3]["rows"].size(), 18U);
  // The minimum cost only decreases, whether the start meets its limits or not.
  const auto evaluation = data["search"]["evaluation"].get<std::vector<double>>();
  EXPECT_TRUE(std::is_sorted(evaluation.begin(), evaluation.end()));
  EXPECT_LE(evaluation.back(), 60 + 540 * (std::getenv("QUADTUNE_UPDATE_DOCS") != nullptr));
  EXPECT_EQ(evaluation.front(), 1);
  ASSERT_GE(data["flown"].size(), 1U);
  EXPECT_EQ(data["flown"][0]["plots"][0]["series"].size(), 3U);
  EXPECT_THAT(data["command"].get<std::string>(), HasSubstr("quadtune tune pid mambo"));
}

TEST(GainsPage, OfWeightsHasNoPublishedOnes) {
  const TemporaryDirectory folder;
  const std::string file = (folder.path() / "weights.html").string();
  const ProgramResult result = run_program(
      {"tune", "lqr", "mambo", "--mission", "step-north", "--sensors", "ideal", "--evaluations",
       "10", "--monte-carlo", "1", "--proof", "2", "--budget", "600", "--report", file});
  EXPECT_THAT(result.status, ::testing::AnyOf(0, 1)) << result.err;
  const nlohmann::json data = data_of(folder.read("weights.html"));
  EXPECT_EQ(data["columns_of"].size(), 2U);
  EXPECT_EQ(data["tables"][3]["title"], "Weights");
  EXPECT_EQ(data["tables"][3]["rows"].size(), 16U);
}

TEST_F(Browser, DrawsTunedGains) {
  const std::string page = opened(example_of_gains());
  EXPECT_EQ(root_data(page, "error"), "(none)");
  EXPECT_EQ(root_data(page, "cells"), "1");
  EXPECT_EQ(root_data(page, "plots"), std::to_string(data_of(example_of_gains())["flown"].size()));
  EXPECT_THAT(page, HasSubstr("Margins of the loops"));
  EXPECT_THAT(page, HasSubstr("published"));
}

TEST_F(Browser, TunedGainsLoadNothing) {
  EXPECT_THAT(asked_for(example_of_gains()), IsEmpty());
  EXPECT_THAT(asked_for(with_script(example_of_gains(), "")), IsEmpty());
}

TEST_F(Browser, HostileTextsOfTunedGainsStayTexts) {
  const std::string page = opened_and_counted(report::html(hostile_gains()));
  EXPECT_EQ(root_data(page, "error"), "(none)");
  EXPECT_EQ(root_data(page, "broken"), "(none)");
  EXPECT_EQ(root_data(page, "cells"), "1");
  EXPECT_EQ(root_data(page, "plots"), "1");
  EXPECT_EQ(root_data(page, "elements"), "0");
}

TEST_F(Browser, ShowsTunedGainsOfNothing) {
  const std::string page = opened(report::html(GainsPage{}));
  EXPECT_EQ(root_data(page, "error"), "(none)");
  EXPECT_EQ(root_data(page, "cells"), "0");
  EXPECT_EQ(root_data(page, "plots"), "0");
}

TEST_F(Browser, TunedGainsFitIntoANarrowWindow) {
  EXPECT_EQ(narrow_width(example_of_gains()), "390");
  EXPECT_EQ(narrow_width(report::html(hostile_gains())), "390");
}

TEST_F(Browser, TakesAPictureOfTunedGains) {
  take_picture_for_docs(example_of_gains(), "gains-report.png", 1600);
}

}  // namespace
}  // namespace quadtune::testing
