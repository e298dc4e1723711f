// SPDX-License-Identifier: Apache-2.0
/// The page of a filter's tuning: as a file, and in a browser.
#include "report/page/tuning_page.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "browser_page.hpp"
#include "hostile_texts.hpp"
#include "numbers.hpp"
#include "run_program.hpp"
#include "source_folder.hpp"

namespace quadtune::testing {
namespace {

using report::TuningPage;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using testing::kNaN;

/// The page that the program writes for a log.
std::string page_of_log(const std::string& log, const std::vector<std::string>& more = {}) {
  const TemporaryDirectory folder;
  const std::string file = (folder.path() / "page.html").string();
  std::vector<std::string> args = {"tune",  "kalman", "--model",  "altitude",
                                   "--log", log,      "--report", file};
  args.insert(args.end(), more.begin(), more.end());
  const ProgramResult result = run_program(args);
  EXPECT_LE(result.status, 1) << result.err;
  return folder.read("page.html");
}

std::string example_of_tuning() {
  // Run from the root, as in the documentation: the page contains the name of the log.
  static const std::string page = [] {
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(testing::source_folder());
    std::string result = page_of_log("docs/examples/bobbing.csv");
    std::filesystem::current_path(before);
    return result;
  }();
  return page;
}

/// A vehicle that moves up and down, with a sonar whose echoes were filtered on board.
std::string smoothed_log(int rows) {
  std::string text = "t_s,az[m/s^2],height[m]\n";
  double z = -1, vz = 0, kept = 1;
  unsigned state = 1;
  const auto noise = [&] {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += ((state = state * 1664525U + 1013904223U) >> 8) * 0x1p-24;
    return sum;
  };
  for (int k = 0; k < rows; ++k) {
    const double a = 2 * std::sin(0.06 * k);
    kept = 0.9 * kept + 0.1 * (-z + 0.02 * noise());
    text += fmt::format("{:.2f},{:.4f},{:.4f}\n", 0.02 * k, a + 0.7 * noise(), kept);
    z += 0.02 * vz;
    vz += 0.02 * a;
  }
  return text;
}

TuningPage hostile_tuning() {
  std::string text;
  for (const std::string& one : hostile_texts()) text += one + " ";
  TuningPage page;
  page.title = page.command = page.version = page.seed = text;
  page.verdict = report::ReportVerdict::fail;
  page.reasons = page.unseen = page.remarks = hostile_texts();
  for (const std::string& one : hostile_texts()) {
    page.about.emplace_back(one, one);
    page.parameters.push_back({one, one, 1, kNaN, 0, kNaN, one, true});
    page.checks.push_back({one, 3, kNaN, 1, 0, 0.5, kNaN, 0, {one, one}});
    page.correlations.push_back({one, 0.1, {0.5, kNaN}, {kNaN, 0.2}});
    page.profiles.push_back({one, one, true, {1, 2, 100}, {-3, 0, kNaN}, 2, 1, kNaN, 0, 1.92});
    page.log.events.push_back({1, one, one});
  }
  page.log.columns = {{text, text, {0, 1, 2}},
                      {"a", text, {1, kNaN, -1}},
                      {"b", text, {0, -1, -2}},
                      {"c", text, {2, 1, kNaN}}};
  page.plots = {{text,
                 text,
                 {{text, "a", report::SeriesStyle::measurement},
                  {text, "b", report::SeriesStyle::band, "c"},
                  {text, "b", report::SeriesStyle::band, "c", false}}},
                {text, text, {{text, "a"}}, 1, true}};
  return page;
}

TEST(TuningPage, TellsWhatTheFitFound) {
  const nlohmann::json data = data_of(example_of_tuning());
  EXPECT_EQ(data["verdict"], "pass");
  EXPECT_THAT(data["reasons"], IsEmpty());
  ASSERT_EQ(data["parameters"].size(), 2U);
  EXPECT_EQ(data["parameters"][0]["name"], "Q.az");
  EXPECT_EQ(data["parameters"][0]["before"], 0.1);
  EXPECT_LT(data["parameters"][0]["low"], 0.01);
  EXPECT_GT(data["parameters"][0]["high"], 0.01);
  ASSERT_EQ(data["checks"].size(), 1U);
  EXPECT_EQ(data["checks"][0]["output"], "sonar: height");
  EXPECT_EQ(data["correlations"][0]["after"].size(), 20U);
  ASSERT_EQ(data["profiles"].size(), 2U);
  EXPECT_GE(data["profiles"][1]["x"].size(), 24U);
  EXPECT_EQ(data["plots"].size(), 4U);  // innovation, its size, two states
  EXPECT_EQ(data["plots"][1]["logarithmic"], true);
  EXPECT_EQ(data["events"][1]["name"], "held out");
  EXPECT_THAT(example_of_tuning(), ::testing::Not(HasSubstr("three")));
}

TEST(TuningPage, SaysWhyItFails) {
  const TemporaryDirectory folder;
  const std::string log = folder.write("smoothed.csv", smoothed_log(20000)).string();
  const std::string page = page_of_log(log);
  EXPECT_LT(page.size(), 3'000'000U);
  const nlohmann::json data = data_of(page);
  EXPECT_EQ(data["verdict"], "fail");
  EXPECT_THAT(data["reasons"][0].get<std::string>(), HasSubstr("innovations are not white"));
  EXPECT_EQ(data["checks"][0]["failed"][0], "whiteness");
  EXPECT_EQ(data["kept"], 4000);
}

TEST(TuningPage, LogsFollowOneAnother) {
  const std::string log = testing::source_folder() + "/docs/examples/bobbing.csv";
  // The same log again, with other bytes: identical logs are rejected.
  std::ifstream file(log);
  std::ostringstream text;
  text << file.rdbuf() << "\n";
  const TemporaryDirectory folder;
  const std::string again = folder.write("again.csv", text.str()).string();
  const nlohmann::json data = data_of(page_of_log(log, {"--log", again}));
  EXPECT_EQ(data["events"].size(), 4U);
  EXPECT_NEAR(data["events"][2]["time"].get<double>(), 40.98, 1e-9);
  EXPECT_THAT(data["remarks"][0].get<std::string>(), HasSubstr("follow one another"));
}

TEST_F(Browser, DrawsATuning) {
  const std::string page = opened(example_of_tuning());
  EXPECT_EQ(root_data(page, "error"), "(none)");
  EXPECT_EQ(root_data(page, "plots"), "4");
  EXPECT_EQ(root_data(page, "cells"), "3");
  EXPECT_THAT(page, HasSubstr("sonar: height"));
}

TEST_F(Browser, ATuningLoadsNothing) {
  EXPECT_THAT(asked_for(example_of_tuning()), IsEmpty());
  EXPECT_THAT(asked_for(with_script(example_of_tuning(), "")), IsEmpty());
}

TEST_F(Browser, HostileTextsOfATuningStayTexts) {
  const std::string page = opened_and_counted(report::html(hostile_tuning()));
  EXPECT_EQ(root_data(page, "error"), "(none)");
  EXPECT_EQ(root_data(page, "broken"), "(none)");
  EXPECT_EQ(root_data(page, "plots"), "2");
  EXPECT_EQ(root_data(page, "cells"), std::to_string(2 * hostile_texts().size()));
  EXPECT_EQ(root_data(page, "elements"), "0");
}

TEST_F(Browser, ShowsATuningOfNothing) {
  const std::string page = opened(report::html(TuningPage{}));
  EXPECT_EQ(root_data(page, "error"), "(none)");
  EXPECT_EQ(root_data(page, "plots"), "0");
  EXPECT_THAT(page, HasSubstr("Too short for a verdict"));
}

TEST_F(Browser, ATuningFitsIntoANarrowWindow) {
  EXPECT_EQ(narrow_width(example_of_tuning()), "390");
  EXPECT_EQ(narrow_width(report::html(hostile_tuning())), "390");
}

// Keys of the legend show and hide series, printing uses the light theme, and hidden series can be
// shown.
TEST_F(Browser, KeysOfATuningShowAndHide) {
  const std::string script = R"(
    const root = document.documentElement;
    const keys = [...document.querySelectorAll('.key')];
    root.dataset.hidden = keys.filter((k) => k.getAttribute('aria-pressed') === 'false').length;
    for (const key of keys) key.click();
    root.dataset.shown = keys.filter((k) => k.getAttribute('aria-pressed') === 'false').length;
    window.dispatchEvent(new Event('beforeprint'));
    root.dataset.paper = root.dataset.theme;
    window.dispatchEvent(new Event('afterprint'));
  )";
  const std::string page = opened(with_script(example_of_tuning(), script));
  EXPECT_EQ(root_data(page, "error"), "(none)");
  EXPECT_EQ(root_data(page, "hidden"), "4");  // innovations and bands before
  EXPECT_EQ(root_data(page, "shown"), "11");
  EXPECT_EQ(root_data(page, "paper"), "light");
}

TEST_F(Browser, TakesAPictureOfATuning) {
  take_picture_for_docs(example_of_tuning(), "tuning-report.png", 1510);
}

}  // namespace
}  // namespace quadtune::testing
