// SPDX-License-Identifier: Apache-2.0
/// The flight report as a file; browser_test.cpp opens it.
#include "report/page/flight_report.hpp"

#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>
#include <regex>
#include <set>

#include "hostile_texts.hpp"
#include "quadtune/errors.hpp"
#include "report/page/page_text.hpp"
#include "sample_flight.hpp"

namespace quadtune {
namespace {

using nlohmann::json;
using report::FlightReport;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::hostile_flight;
using testing::sample_flight;
using ::testing::SizeIs;
using testing::still_flight;

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

/// The text between two texts, starting at the first occurrence of the first one.
std::string between(const std::string& text, const std::string& open, const std::string& close) {
  const std::size_t start = text.find(open) + open.size();
  return text.substr(start, text.find(close, start) - start);
}

std::string data_text(const std::string& page) {
  return between(page, "<script type=\"application/json\" id=\"data\">", "</script>");
}

json data_of(const std::string& page) { return json::parse(data_text(page)); }

std::vector<unsigned char> from_base64(const std::string& text) {
  static const std::string kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned char> bytes;
  std::uint32_t bits = 0;
  int have = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(kDigits.find(c));
    have += 6;
    if (have >= 8) bytes.push_back(static_cast<unsigned char>(bits >> (have -= 8)));
  }
  return bytes;
}

template <typename Number>
std::vector<double> numbers(const json& text) {
  const std::vector<unsigned char> bytes = from_base64(text.get<std::string>());
  std::vector<double> values;
  for (std::size_t i = 0; i + sizeof(Number) <= bytes.size(); i += sizeof(Number)) {
    Number value;
    std::memcpy(&value, &bytes[i], sizeof value);
    values.push_back(static_cast<double>(value));
  }
  return values;
}

TEST(FlightReport, HasAllThatItIsGiven) {
  const FlightReport report = sample_flight(4);
  const json data = data_of(report::html(report));
  EXPECT_EQ(data["title"], report.title);
  EXPECT_EQ(data["verdict"], "fail");
  EXPECT_EQ(data["reasons"], json(report.reasons));
  EXPECT_EQ(data["command"], report.command);
  EXPECT_EQ(data["version"], "0.1.0");
  EXPECT_EQ(data["seed"], "42");
  EXPECT_EQ(data["about"][1][0], "mission");
  ASSERT_THAT(data["metrics"], SizeIs(report.metrics.size()));
  EXPECT_EQ(data["metrics"][5]["value"], 8.3);
  EXPECT_EQ(data["metrics"][5]["text"], "8.3");
  EXPECT_EQ(data["metrics"][5]["limit"], 10.0);
  EXPECT_EQ(data["metrics"][5]["limit_is_least"], true);
  EXPECT_EQ(data["metrics"][5]["ok"], false);
  EXPECT_FALSE(data["metrics"][7].contains("limit"));
  EXPECT_EQ(data["events"][2]["name"], "gust");
  EXPECT_EQ(data["gains"][0]["values"][0][2], -0.001508);
  EXPECT_EQ(data["margins"][3]["values"][0]["text"], "infinite");
  EXPECT_EQ(data["replay"]["rotors"][1]["spin"], -1);
}

TEST(FlightReport, NumbersReadBack) {
  const FlightReport report = sample_flight(4);
  const json data = data_of(report::html(report));
  EXPECT_EQ(numbers<double>(data["time"]), report.log.columns.front().values);
  const auto near = [](const std::vector<double>& read, const std::vector<double>& written) {
    ASSERT_EQ(read.size(), written.size());
    for (std::size_t i = 0; i < read.size(); ++i)
      if (std::isnan(written[i]))
        EXPECT_TRUE(std::isnan(read[i]));
      else
        EXPECT_EQ(read[i], static_cast<double>(static_cast<float>(written[i])));
  };
  for (std::size_t i = 0; i < report.plots.size(); ++i)
    for (std::size_t k = 0; k < report.plots[i].series.size(); ++k) {
      const json& index = data["plots"][i]["series"][k]["column"];
      near(numbers<float>(data["columns"][index.get<std::size_t>()]),
           report.log.find(report.plots[i].series[k].column)->values);
    }
  near(numbers<float>(data["replay"]["position"][2]), report.log.find("x.pz")->values);
  near(numbers<float>(data["replay"]["reference"][0]), report.log.find("ref.px")->values);
  near(numbers<float>(data["replay"]["rotors"][3]["speed"]), report.log.find("rotor.4")->values);
}

// A column that several plots show is stored once.
TEST(FlightReport, HoldsEachColumnOnce) {
  FlightReport report = sample_flight(4);
  const json one = data_of(report::html(report));
  report.plots.push_back(report.plots.front());
  const json two = data_of(report::html(report));
  EXPECT_EQ(one["columns"].size(), two["columns"].size());
  EXPECT_EQ(two["plots"].size(), one["plots"].size() + 1);
}

// Yaw by 90 degrees and roll by 90 degrees: (w, x, y, z) = (1, 0, 0, 1)/sqrt(2) (1, 1, 0,
// 0)/sqrt(2) = (1, 1, 1, 1)/2 by Hamilton's product.
TEST(FlightReport, TurnsAnglesIntoQuaternions) {
  const double quarter = std::acos(0.0);
  const json q = data_of(report::html(still_flight(quarter, 0, quarter)))["replay"]["quaternion"];
  for (const json& component : q) EXPECT_NEAR(numbers<float>(component)[0], 0.5, 1e-7);
  const json p = data_of(report::html(still_flight(0, 0.2, 0)))["replay"]["quaternion"];
  EXPECT_NEAR(numbers<float>(p[0])[0], std::cos(0.1), 1e-7);
  EXPECT_NEAR(numbers<float>(p[2])[0], std::sin(0.1), 1e-7);
}

TEST(FlightReport, TakesQuaternionsOfAnyLength) {
  FlightReport report = still_flight(0, 0, 0);
  for (const auto& [name, value] : {std::pair("qw", 3.0), {"qx", 0.0}, {"qy", 4.0}, {"qz", 0.0}})
    report.log.columns.push_back({name, "1", {value, 0}});
  report.replay->attitude = {"qw", "qx", "qy", "qz"};
  const json q = data_of(report::html(report))["replay"]["quaternion"];
  EXPECT_NEAR(numbers<float>(q[0])[0], 0.6, 1e-7);
  EXPECT_NEAR(numbers<float>(q[2])[0], 0.8, 1e-7);
  EXPECT_TRUE(std::isnan(numbers<float>(q[0])[1]));  // a zero quaternion
}

// 100 s at 200 Hz with 80 columns of noise, which cannot be compressed.
TEST(FlightReport, StaysBelowThreeMegabytes) {
  FlightReport report = sample_flight(100);
  std::mt19937 random(3);
  std::normal_distribution<double> noise;
  report.plots.clear();
  for (int i = 0; i < 80; ++i) {
    LogColumn column{"noise." + std::to_string(i), "m", {}};
    for (std::size_t row = 0; row < report.log.rows(); ++row)
      column.values.push_back(noise(random));
    report.log.columns.push_back(column);
    if (i % 4 == 0) report.plots.push_back({"noise", "m", {}});
    report.plots.back().series.push_back({column.name, column.name});
  }
  ASSERT_GE(report.log.rows(), 20'000U);
  const std::string page = report::html(report);
  EXPECT_LT(page.size(), 3'000'000U);
  EXPECT_EQ(data_of(page)["kept"], 4000);
  EXPECT_EQ(data_of(page)["rows"], report.log.rows());

  // And with any number of columns, by fewer rows of each.
  const std::vector<report::ReportPlot> plots = report.plots;
  for (int copy = 0; copy < 4; ++copy)
    for (int i = 0; i < 80; ++i) {
      LogColumn column = report.log.columns[report.log.columns.size() - 80];
      column.name += "'";
      report.plots.front().series.push_back({column.name, column.name});
      report.log.columns.push_back(std::move(column));
    }
  EXPECT_LT(report::html(report).size(), 3'000'000U);
}

TEST(FlightReport, KeepsPeaks) {
  FlightReport report = sample_flight(100);
  for (LogColumn& column : report.log.columns)
    if (column.name == "error.position") column.values[12'345] = 77;
  const json data = data_of(report::html(report));
  const json& index = data["plots"][3]["series"][0]["column"];
  const std::vector<double> shown = numbers<float>(data["columns"][index.get<std::size_t>()]);
  EXPECT_EQ(*std::ranges::max_element(shown), 77);
}

// The policy allows exactly the scripts and the style in the file.
TEST(FlightReport, PolicyAllowsItsOwnScriptsAlone) {
  const std::string page = report::html(sample_flight(4));
  const std::string policy =
      between(page, "http-equiv=\"Content-Security-Policy\" content=\"", "\"");
  std::string expected = "default-src 'none'; script-src";
  std::size_t scripts = 0;
  for (std::size_t at = page.find("<script>"); at != std::string::npos;
       at = page.find("<script>", at + 1), ++scripts)
    expected += " " + report::policy_hash(between(page.substr(at), "<script>", "</script>"));
  EXPECT_EQ(scripts, 3U);
  expected += "; style-src " + report::policy_hash(between(page, "<style>", "</style>"));
  expected += "; img-src data:; base-uri 'none'; form-action 'none'";
  EXPECT_EQ(policy, expected);
  EXPECT_LT(page.find("Content-Security-Policy"), page.find("<style>"));
}

// Hostile texts do not change the tags of the file: it has those of a harmless report, in the same
// order.
TEST(FlightReport, HostileTextsAddNoMarkup) {
  const auto without_data = [](std::string page) {
    page.erase(page.find(data_text(page)), data_text(page).size());
    const std::string title = between(page, "<title>", "</title>");
    EXPECT_EQ(title.find_first_of("<>\"'"), std::string::npos);
    page.erase(page.find("<title>") + 7, title.size());
    return page;
  };
  const std::string hostile = report::html(hostile_flight());
  EXPECT_EQ(without_data(hostile), without_data(report::html(FlightReport{})));
  EXPECT_EQ(data_text(hostile).find_first_of("<>&"), std::string::npos);
  EXPECT_TRUE(json::accept(data_text(hostile)));
  // No text is lost.
  const json data = data_of(hostile);
  for (std::size_t i = 0; i < testing::hostile_texts().size(); ++i) {
    const std::string& text = testing::hostile_texts()[i];
    if (text.find("no UTF-8") == std::string::npos) {
      EXPECT_EQ(data["reasons"][i], text);
    }
  }
}

TEST(FlightReport, SaysWhatIsNoNumber) {
  FlightReport report;
  const double nan = std::nan(""), inf = HUGE_VAL;
  report.metrics = {{"a", "", nan, "m", inf}, {"b", "", -inf}};
  const json metrics = data_of(report::html(report))["metrics"];
  EXPECT_EQ(metrics[0]["text"], "not a number");
  EXPECT_EQ(metrics[0]["value"], nullptr);
  EXPECT_EQ(metrics[0]["limit_text"], "infinite");
  EXPECT_EQ(metrics[1]["text"], "minus infinite");
}

// Addresses occur in comments and as names of XML namespaces; nothing is loaded from them.
TEST(FlightReport, NamesNoAddressToLoad) {
  const std::string page = report::html(sample_flight(4));
  const std::regex loads(
      R"((src|href|action|srcset)\s*=\s*["']?\s*(https?:)?//|@import|url\(\s*["']?http)");
  EXPECT_FALSE(std::regex_search(page, loads));
  const std::regex address(R"((https?|wss?)://[^\s"'`)]*)");
  std::set<std::string> addresses;
  for (std::sregex_iterator it(page.begin(), page.end(), address), end; it != end; ++it)
    addresses.insert(it->str());
  EXPECT_THAT(addresses, ElementsAre("http://www.w3.org/1999/xhtml", "http://www.w3.org/2000/svg",
                                     "https://github.com/leeoniya/uPlot"));
  EXPECT_EQ(count(page, "<link"), 1U);
  EXPECT_EQ(count(page, "<link rel=\"icon\" href=\"data:,\">"), 1U);
}

TEST(FlightReport, CarriesTheLicencesOfWhatItContains) {
  const std::string page = report::html(FlightReport{});
  EXPECT_THAT(page, HasSubstr("2022 Leon Sorokin"));
  EXPECT_THAT(page, HasSubstr("three.js authors"));
}

TEST(FlightReport, IsTheSameForTheSameFlight) {
  EXPECT_EQ(report::html(sample_flight(4)), report::html(sample_flight(4)));
}

std::string refusal(const FlightReport& report) {
  try {
    (void)report::html(report);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(FlightReport, RefusesWhatDoesNotFit) {
  const FlightReport good = still_flight(0, 0, 0);
  EXPECT_EQ(refusal(good), "");
  FlightReport report = good;
  report.plots = {{"a", "m", {{"a", "nowhere"}}}};
  EXPECT_EQ(refusal(report),
            "report: unknown column 'nowhere', expected one of the 7 columns of the log");
  report = good;
  report.log.columns[3].values.pop_back();
  EXPECT_EQ(refusal(report), "report: column 'd' has 1 rows, expected 2 like the time");
  report = good;
  report.log.columns[0].values = {1, 1};
  EXPECT_EQ(refusal(report),
            "report: the time is 1 in row 1, expected finite and increasing times");
  report = good;
  report.replay->attitude.pop_back();
  EXPECT_EQ(refusal(report),
            "flight report: the attitude has 2 columns, expected 3 angles or a quaternion of 4");
  report = good;
  report.gains = {{"K", {"a"}, {"b", "c"}, Eigen::MatrixXd::Zero(2, 2)}};
  EXPECT_EQ(refusal(report), "flight report: table 'K' is 2x2, expected 1x2 to match its names");
}

}  // namespace
}  // namespace quadtune
