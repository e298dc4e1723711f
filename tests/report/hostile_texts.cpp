// SPDX-License-Identifier: Apache-2.0
#include "hostile_texts.hpp"

#include <utility>

#include "numbers.hpp"

namespace quadtune::testing {
namespace {

using testing::kInfinity;
using testing::kNaN;

}  // namespace

const std::vector<std::string>& hostile_texts() {
  static const std::string kBreak = "document.documentElement.dataset.broken=1";
  static const std::vector<std::string> texts = {
      "</script><script>" + kBreak + "</script>",
      "</ScRiPt ><img src=x onerror=\"" + kBreak + "\">",
      "<!--<script>" + kBreak,
      "-->]]></style></title></textarea><svg onload=" + kBreak + ">",
      "\"' onclick=\"" + kBreak + "\" x='",
      "&lt;script&gt;&#60;b&#62; &amp; & &quot;",
      "{{data}} {{script}} ${" + kBreak + "} `",
      "javascript:" + kBreak,
      "\\u003c/script\\u003e \\\" \\\\",
      "line\xE2\x80\xA8separator\xE2\x80\xA9paragraph",                  // U+2028, U+2029
      "right to left \xE2\x80\xAEtxet\xE2\x80\xAC \xE2\x81\xA6isolate",  // U+202E, U+202C, U+2066
      std::string("control \0 \x01 \x08 \x0b \x1b[31m \x7f \r\n\t", 27),
      "no UTF-8: \xff\xfe \xc0\x80 \xed\xa0\x80 \xe2\x82",
      "wide \xF0\x9F\x9A\x81 and combining e\xCC\x81\xCC\x81\xCC\x81\xCC\x81",
      std::string(400, 'W'),
  };
  return texts;
}

report::FlightReport hostile_flight() {
  std::string text;
  for (const std::string& one : hostile_texts()) text += one + " ";
  report::FlightReport report;
  report.title = text;
  report.verdict = report::ReportVerdict::fail;
  report.reasons = hostile_texts();
  report.command = text;
  report.version = text;
  report.seed = text;
  for (const std::string& one : hostile_texts()) {
    report.log.about.emplace_back(one, one);
    report.log.events.push_back({0.5, one, one});
    report.metrics.push_back({one, one, kNaN, one, kInfinity, true, false});
  }
  report.log.events.push_back({kNaN, text, text});
  report.log.events.push_back({1e300, text, text});
  report.log.events.push_back({-kInfinity, text, text});
  for (const double value : {kInfinity, -kInfinity, 1e300, -1e-300, 0.0, -0.0})
    report.metrics.push_back({"m", "", value, "", value, false, true});
  report.log.columns.push_back({text, text, {0, 1, 2, 3, 4}});
  std::vector<std::vector<double>> columns = {
      {1, kNaN, 2, kInfinity, 3},
      {kNaN, kNaN, kNaN, kNaN, kNaN},
      {1e300, -1e300, 1e39, 0, 1},
      {1e-300, 0, -0.0, 5e-324, 1},
      {kInfinity, -kInfinity, kInfinity, -kInfinity, kInfinity},
      {7, 7, 7, 7, 7}};
  const std::vector<std::string>& texts = hostile_texts();
  for (std::size_t i = 0; i < columns.size(); ++i)
    report.log.columns.push_back({texts[i], texts[i], columns[i]});
  for (std::size_t i = 0; i < columns.size(); ++i)
    report.plots.push_back(
        {text,
         text,
         {{text, texts[i], static_cast<report::SeriesStyle>(i % 4)},
          {texts[i], texts[(i + 1) % columns.size()], report::SeriesStyle::value}},
         i == 0 ? kNaN : 1e30});
  report::ReportReplay replay;
  replay.position = {texts[0], texts[3], texts[5]};
  replay.attitude = {texts[0], texts[1], texts[2]};
  replay.reference = {{texts[4], texts[2], texts[1]}};
  replay.estimate = {{texts[5], texts[5], texts[5]}};
  replay.arm = kNaN;
  replay.rotor_radius = -kInfinity;
  replay.rotors = {
      {{kNaN, kInfinity, 0}, 0, texts[4]}, {{0, 0, 0}, 1, ""}, {{1e300, 0, 0}, -1, texts[2]}};
  report.replay = std::move(replay);
  Eigen::MatrixXd values(1, 3);
  values << kNaN, kInfinity, -1e-300;
  report.gains.push_back({text, {text}, {text, "b", "c"}, values});
  report.margins.push_back({text, {{text, text, kNaN}, {"m", "", -kInfinity}}});
  return report;
}

}  // namespace quadtune::testing
