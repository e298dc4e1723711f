// SPDX-License-Identifier: Apache-2.0
// Loads logs in Octave and compares what it holds afterwards, bit for bit.
#include <gmock/gmock.h>

#include <cstdlib>
#include <sstream>

#include "log_files/sample_logs.hpp"
#include "quadtune/logs/flight_log.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using testing::TemporaryDirectory;

// Numbers as the hexadecimal digits of their bytes, texts as those of their UTF-8, a line each.
const char* const dump_script = R"(
function put(what, value)
  if ischar(value)
    value = uint8(value);
  end
  bytes = sprintf("%02x", typecast(value(:)', "uint8"));
  printf("%s %s\n", what, bytes);
end
load flight.mat
put("format", flight.format);
for i = 1:numel(flight.about_keys)
  put("key", flight.about_keys{i});
  put("about", flight.about.(fieldnames(flight.about){i}));
end
for i = 1:numel(flight.columns)
  column = flight.columns(i);
  path = strsplit(column.field, ".");
  put("name", column.name);
  put("unit", column.unit);
  put("unit", getfield(flight.units, path{:}));
  put("values", getfield(flight, path{:}));
end
for i = 1:numel(flight.events)
  put("time", flight.events(i).time);
  put("event", flight.events(i).name);
  put("detail", flight.events(i).detail);
end
% The recipe of docs/formats.md.
lines = strsplit(fileread("flight.csv"), "\n");
comments = sum(strncmp(lines, "#", 1));
data = dlmread("flight.csv", ",", comments + 1, 0, "emptyvalue", NaN);
for i = 1:columns(data)
  put("csv", data(:, i));
end
% The names of docs/formats.md.
put("x.px", [flight.x.px]);
put("units.x.px", flight.units.x.px);
put("vehicle", flight.about.vehicle);
)";

std::string hex(const void* data, std::size_t size) {
  std::string digits;
  for (std::size_t i = 0; i < size; ++i) {
    constexpr const char* kDigits = "0123456789abcdef";
    const auto byte = static_cast<const unsigned char*>(data)[i];
    digits += {kDigits[byte >> 4U], kDigits[byte & 0xfU]};
  }
  return digits;
}
std::string line(const std::string& what, const std::string& text) {
  return what + " " + hex(text.data(), text.size());
}
std::string line(const std::string& what, const std::vector<double>& values) {
  return what + " " + hex(values.data(), values.size() * sizeof(double));
}

// A flight with everything that a text or a number can be.
LogTable hostile_log() {
  LogTable log = testing::small_log();
  std::mt19937_64 random(4);
  for (const std::string& text : testing::hostile_texts()) {
    log.about.emplace_back(text, text);
    log.events.push_back({testing::any_double(random), text, text});
    if (log.find(text) == nullptr)
      log.columns.push_back(
          {text, text, {testing::any_double(random), testing::any_double(random)}});
  }
  // dlmread drops columns without any value at the end.
  log.columns.push_back({"last", "1", {1, 0}});
  return log;
}

std::vector<std::string> expected_lines(const LogTable& log) {
  std::vector<std::string> lines = {line("format", "quadtune-log")};
  for (const auto& [key, value] : log.about) {
    lines.push_back(line("key", key));
    lines.push_back(line("about", value));
  }
  for (const LogColumn& column : log.columns) {
    lines.push_back(line("name", column.name));
    lines.push_back(line("unit", column.unit));
    lines.push_back(line("unit", column.unit));
    lines.push_back(line("values", column.values));
  }
  for (const LogEvent& event : log.events) {
    lines.push_back(line("time", std::vector{event.time}));
    lines.push_back(line("event", event.name));
    lines.push_back(line("detail", event.detail));
  }
  for (const LogColumn& column : log.columns) lines.push_back(line("csv", column.values));
  lines.push_back(line("x.px", log.find("x.px")->values));
  lines.push_back(line("units.x.px", "m"));
  lines.push_back(line("vehicle", "mambo"));
  return lines;
}

TEST(LogOctave, LoadsEveryNumberAndTextAsItWas) {
  if (std::system("octave-cli --version > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "Octave is not installed";
  const LogTable log = hostile_log();
  const TemporaryDirectory directory;
  directory.write("flight.mat", bytes_of_mat(log));
  directory.write("flight.csv", csv_of(log));
  directory.write("quadtune_dump.m", std::string("1;\n") + dump_script);
  const std::string command =
      "cd " + directory.path().string() +
      " && octave-cli --no-init-file quadtune_dump.m > out.txt 2> errors.txt";
  ASSERT_EQ(std::system(command.c_str()), 0) << directory.read("errors.txt");
  std::istringstream out(directory.read("out.txt"));
  std::vector<std::string> lines;
  for (std::string each; std::getline(out, each);) lines.push_back(each);
  const std::vector<std::string> expected = expected_lines(log);
  ASSERT_EQ(lines.size(), expected.size());
  for (std::size_t i = 0; i < lines.size(); ++i) EXPECT_EQ(lines[i], expected[i]) << "line " << i;
}

}  // namespace
}  // namespace quadtune
