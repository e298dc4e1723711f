// SPDX-License-Identifier: Apache-2.0
/// The page of a campaign: as a file, and in a browser.
#include "report/page/campaign_page.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "browser_page.hpp"
#include "hostile_texts.hpp"
#include "numbers.hpp"
#include "run_program.hpp"
#include "sample_flight.hpp"
#include "source_folder.hpp"

namespace quadtune::testing {
namespace {

using report::CampaignPage;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using testing::kInfinity;
using testing::kNaN;

/// The page that the program writes for campaigns/mambo-hover.toml; with fewer flights, except for
/// the picture of the documentation.
const std::string& example() {
  static const std::string page = [] {
    const TemporaryDirectory folder;
    std::ifstream file(testing::source_folder() + "/campaigns/mambo-hover.toml");
    std::string text(std::istreambuf_iterator<char>(file), {});
    if (std::getenv("QUADTUNE_UPDATE_DOCS") == nullptr)
      text.replace(text.find("flights = 200"), 13, "flights = 60");
    const std::string campaign = folder.write("campaign.toml", text).string();
    const ProgramResult result =
        run_program({"campaign", "run", campaign, (folder.path() / "out").string()});
    EXPECT_EQ(result.status, 0) << result.err;
    return folder.read("out/report.html");
  }();
  return page;
}

CampaignPage hostile_page() {
  std::string text;
  for (const std::string& one : hostile_texts()) text += one + " ";
  CampaignPage page;
  page.title = page.version = page.seed = text;
  for (const std::string& one : hostile_texts()) {
    page.about.emplace_back(one, one);
    report::PageCase of;
    of.design = of.mission = of.law = one;
    of.flights = 3;
    of.passed = 1;
    of.rate = 1.0 / 3;
    of.high = kNaN;
    of.ends = {{one, 2}, {text, 1}};
    of.metrics = {{one, one, kNaN, kInfinity, -kInfinity, 1e300, kNaN},
                  {"m", "", 0, -0.0, 1e-300, 1, 2}};
    of.trends = {{one, text}, {one, text}, {{1, kNaN}, {-1, 0}}};
    of.worst = {{one, one}, {text, text}};
    page.cases.push_back(of);
    page.distributions.push_back({one, one, one, kNaN, {{one, {0, 1, 2}, 1}, {text, {1, 1}, 0.2}}});
    page.comparisons.push_back(
        {one, one, {{one, one, kNaN, -kInfinity, kInfinity}, {"m", "", 1, 0, 2}}});
  }
  page.comparisons.push_back({text, text, {}});
  return page;
}

TEST(CampaignPage, TellsWhatWasFlown) {
  const nlohmann::json data = data_of(example());
  EXPECT_THAT(data["title"].get<std::string>(), HasSubstr("mambo-hover: "));
  EXPECT_EQ(data["about"].size(), 8U);
  ASSERT_EQ(data["cases"].size(), 2U);
  const nlohmann::json& designed = data["cases"][0];
  EXPECT_EQ(designed["design"], "designed");
  EXPECT_GE(designed["flights"], 60);
  EXPECT_LT(designed["low"], designed["rate"]);
  EXPECT_GE(designed["high"], designed["rate"]);
  EXPECT_EQ(designed["worst"].size(), 5U);
  EXPECT_THAT(designed["worst"][0]["command"].get<std::string>(), HasSubstr("campaign replay"));
  // Each chart has both designs, and each curve increases.
  ASSERT_FALSE(data["distributions"].empty());
  for (const nlohmann::json& chart : data["distributions"])
    for (const nlohmann::json& curve : chart["curves"]) {
      const auto x = curve["x"].get<std::vector<double>>();
      EXPECT_TRUE(std::is_sorted(x.begin(), x.end())) << chart["label"];
    }
  ASSERT_EQ(data["comparisons"].size(), 1U);
  for (const nlohmann::json& difference : data["comparisons"][0]["differences"]) {
    EXPECT_GT(difference["draws"], 0);
    EXPECT_LE(difference["draws"], designed["flights"]);
  }
  EXPECT_EQ(data["comparisons"][0]["title"], "published minus designed in hover");
}

TEST_F(Browser, DrawsACampaign) {
  const std::string page = opened(example());
  EXPECT_EQ(root_data(page, "error"), "(none)");
  EXPECT_EQ(root_data(page, "cells"), std::to_string(data_of(example())["distributions"].size()));
  EXPECT_THAT(page, HasSubstr("designed in hover"));
  EXPECT_THAT(page, HasSubstr("published minus designed in hover"));
}

// The styles of campaign pages do not change the legend of a flight's plots: a line in the dashes
// of its series, and nothing before it.
TEST_F(Browser, AFlightsKeysAreNotThoseOfACampaign) {
  const std::string page = opened(with_script(
      report::html(sample_flight(4)),
      "const key = document.querySelector('.key');"
      "document.documentElement.dataset.before = getComputedStyle(key, '::before').content;"
      "document.documentElement.dataset.margin = getComputedStyle(key).marginLeft"));
  EXPECT_EQ(root_data(page, "before"), "none");
  EXPECT_EQ(root_data(page, "margin"), "0px");
}

TEST_F(Browser, ACampaignLoadsNothing) {
  EXPECT_THAT(asked_for(example()), IsEmpty());
  EXPECT_THAT(asked_for(with_script(example(), "")), IsEmpty());
}

TEST_F(Browser, HostileTextsOfACampaignStayTexts) {
  const std::string page = opened_and_counted(report::html(hostile_page()));
  EXPECT_EQ(root_data(page, "error"), "(none)");
  EXPECT_EQ(root_data(page, "broken"), "(none)");
  EXPECT_EQ(root_data(page, "cells"), std::to_string(hostile_texts().size()));
  EXPECT_EQ(root_data(page, "elements"), "0");
}

TEST_F(Browser, ShowsACampaignOfNothing) {
  const std::string page = opened(report::html(CampaignPage{}));
  EXPECT_EQ(root_data(page, "error"), "(none)");
  EXPECT_EQ(root_data(page, "cells"), "0");
}

TEST_F(Browser, ACampaignFitsIntoANarrowWindow) {
  EXPECT_EQ(narrow_width(example()), "390");
  EXPECT_EQ(narrow_width(report::html(hostile_page())), "390");
}

TEST_F(Browser, TakesAPictureOfACampaign) {
  take_picture_for_docs(example(), "campaign-report.png", 1600);
}

}  // namespace
}  // namespace quadtune::testing
