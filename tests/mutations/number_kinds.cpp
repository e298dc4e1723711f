// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "kinds.hpp"
#include "log_files/hostile_samples.hpp"
#include "random.hpp"

namespace quadtune::mutations {
namespace {

Kind matrices() {
  Kind kind{"matrix text"};
  const Files files = {{"A", "0 1 0\n-2 -0.5 1\n0 0 -3\n"},
                       {"B", "0 0\n1 0\n0 2\n"},
                       {"C", "1 0 0\n0 0 1\n"},
                       {"D", "0 0\n0 0\n"},
                       {"G", "0 0\n1 0\n0 1\n"},
                       {"Q", "2 0.5 0\n0.5 1 0\n0 0 1\n"},
                       {"R", "1 0.1\n0.1 2\n"},
                       {"N", "0.1 0\n0 0.1\n0 0\n"},
                       {"W", "1 0\n0 0.5\n"},
                       {"Ad", "0.9 0.1 0\n-0.1 0.8 0.1\n0 0 0.5\n"},
                       {"K", "1 0.5 0.1\n0 0.2 1\n"}};
  const std::vector<Command> lqr = {
      {"lqr", "--A", "@/A", "--B", "@/B", "--Q", "@/Q", "--R", "@/R"},
      {"lqr", "--A", "@/A", "--B", "@/B", "--Q", "@/Q", "--R", "@/R", "--N", "@/N"},
      {"lqr", "--A", "@/A", "--B", "@/B", "--Q", "@/Q", "--R", "@/R", "--discrete"},
      {"lqr", "--A", "@/A", "--B", "@/B", "--Q", "@/Q", "--R", "@/R", "--sampled", "0.1"}};
  const std::vector<Command> kalman = {
      {"kalman", "--A", "@/Ad", "--C", "@/C", "--Q", "@/Q", "--R", "@/R", "--discrete"},
      {"kalman", "--A", "@/A", "--C", "@/C", "--Q", "@/Q", "--R", "@/R", "--continuous"},
      {"kalman", "--A", "@/A", "--G", "@/G", "--C", "@/C", "--Q", "@/W", "--R", "@/R", "--sampled",
       "0.05"}};
  std::vector<Command> sampling;
  for (const char* method :
       {"zoh", "foh", "impulse", "euler", "backward-euler", "tustin", "matched"})
    sampling.push_back({"discretize", "--A", "@/A", "--B", "@/B", "--C", "@/C", "--D", "@/D",
                        "--dt", "0.1", "--method", method});
  sampling.push_back(
      {"discretize", "--A", "@/A", "--B", "@/B", "--dt", "0.1", "--input-delay", "0.03,0.1"});
  sampling.push_back({"discretize", "--A", "@/Ad", "--B", "@/B", "--dt", "0.1", "--inverse"});
  const std::vector<Command> margins = {
      {"margins", "--A", "@/A", "--B", "@/B", "--K", "@/K"},
      {"margins", "--A", "@/Ad", "--B", "@/B", "--K", "@/K", "--dt", "0.1"},
      {"margins", "--A", "@/A", "--B", "@/B", "--K", "@/K", "--cut", "states", "--delay", "0.01"}};
  const auto add = [&](const char* target, std::vector<std::vector<Command>> lists) {
    Sample sample{files, target, Format::numbers, {}};
    // Only the commands that read it.
    for (const auto& list : lists)
      for (const Command& command : list)
        for (const std::string& word : command)
          if (word == std::string("@/") + target) {
            sample.commands.push_back(command);
            break;
          }
    kind.samples.push_back(std::move(sample));
  };
  for (const char* target : {"A", "B", "Q", "R", "N", "Ad", "C", "G", "W", "K", "D"})
    add(target, {lqr, kalman, sampling, margins});
  return kind;
}

std::vector<Command> log_commands(const std::string& format, const std::string& channel,
                                  const std::string& column) {
  return {{"log", "@/f"},
          {"log", "@/f", "--format", format},
          {"log", "@/f", "--rate", "50"},
          {"tune", "kalman", "--model", "local-level", "--log", "@/f", "--format", format, "--map",
           "y=" + channel, "--starts", "1"},
          {"allan", "--log", "@/f", "--format", format, "--column", column}};
}

Kind log_kind(const std::string& name, const std::string& format, Format structure,
              const std::vector<std::string>& texts, const std::string& channel) {
  Kind kind{name};
  for (const std::string& text : texts)
    kind.samples.push_back({{{"f", text}}, "f", structure, log_commands(format, channel, channel)});
  return kind;
}

/// A sensor that rests on the faces and the edges of a cube.
std::string poses() {
  Random random(12);
  std::string text = "t_s,ax,ay,az\n";
  int row = 0;
  for (int pose = 0; pose < 27; ++pose) {
    const int x = pose % 3 - 1, y = pose / 3 % 3 - 1, z = pose / 9 - 1;
    const int length = x * x + y * y + z * z;
    if (length != 1 && length != 2) continue;
    const double g = 9.8 / std::sqrt(length);
    for (int i = 0; i < 120; ++i, ++row)
      text += fmt::format("{:.2f},{:.4f},{:.4f},{:.4f}\n", 0.02 * row,
                          g * x + 0.01 * random.noise() + 0.1, 0.99 * g * y + 0.01 * random.noise(),
                          1.01 * g * z + 0.01 * random.noise() - 0.2);
  }
  return text;
}

Kind text_logs() {
  const std::string own =
      "# quadtune-log,1\n# rows,4\n# about,vehicle,mambo\n# event,0.0025,tilt,\"rolled 1.2 rad, "
      "more\"\nt[s],y[m],gps.px[m]\n0,0.1,\n0.005,-2,3\n0.01,0.2,3\n0.015,0.4,2\n";
  Kind kind = log_kind("log as text", "text", Format::numbers, {small_log_text(), own}, "y");
  for (const testing::LogSample& sample : testing::log_samples())
    if (sample.format == "text")
      kind.samples.push_back(
          {{{"f", sample.bytes}}, "f", Format::numbers, log_commands("text", "1", "2")});
  kind.samples[0].commands.push_back({"log", "@/f", "--columns", "t_s:1, height[m]:4, *"});
  kind.samples[0].commands.push_back({"tune", "kalman", "--model", "altitude", "--log", "@/f",
                                      "--starts", "1", "--truth", "z=y", "--report",
                                      "@/report.html"});
  kind.samples.push_back(
      {{{"f", poses()}},
       "f",
       Format::numbers,
       {{"calibrate", "imu", "--log", "@/f"}, {"allan", "--log", "@/f", "--column", "ax"}}});
  return kind;
}

Kind binary_logs(const char* name, const char* format, Format structure,
                 const std::vector<testing::LogSample>& samples, const std::string& channel) {
  Kind kind{name};
  for (const testing::LogSample& sample : samples)
    if (sample.format == format)
      kind.samples.push_back(
          {{{"f", sample.bytes}}, "f", structure, log_commands(format, channel, channel)});
  return kind;
}

}  // namespace

std::string small_log_text() {
  Random random(7);
  std::string text = "t_s,y[m],az[m/s^2],height[m]\n";
  for (int k = 0; k < 60; ++k) {
    const double t = 0.02 * k;
    text += fmt::format("{:.2f},{:.4f},{:.4f},{:.4f}\n", t, std::sin(3 * t) + 0.1 * random.noise(),
                        9 * std::sin(3 * t) + 0.5 * random.noise(),
                        1 + std::sin(3 * t) + 0.02 * random.noise());
  }
  return text;
}

std::vector<Kind> number_kinds() {
  const std::vector<testing::LogSample> samples = testing::log_samples();
  return {matrices(),
          text_logs(),
          binary_logs("PX4 replay", "replay", Format::numbers, samples, "baro.pressure"),
          binary_logs("ULog", "ulog", Format::ulog, samples, "sensor.gyro[0].x"),
          binary_logs("MAT file", "mat", Format::mat, testing::mat_samples(), "z[1]"),
          binary_logs("frames of the uquad", "uquad-frames", Format::numbers, samples, "3"),
          binary_logs("log of the uquad", "uquad-log", Format::numbers, samples, "4")};
}

}  // namespace quadtune::mutations
