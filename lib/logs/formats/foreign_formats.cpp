// SPDX-License-Identifier: Apache-2.0
#include "logs/formats/foreign_formats.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace quadtune::internal {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::string_view kArduPilot =
    "is an ArduPilot text log with several kinds of rows, expected one table: export the rows "
    "of one kind as CSV, e.g. with mavlogdump.py --format csv --types IMU";
constexpr std::string_view kPacked = "is compressed, expected a log: decompress it first";

constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kBeginnings = {
    {{"\xa3\x95"sv,
      "is a binary ArduPilot log (DataFlash), expected one table: export the rows of one kind as "
      "CSV, e.g. with mavlogdump.py --format csv --types IMU"sv},
     {"H Product:Blackbox"sv,
      "is a blackbox log of Betaflight or a fork, expected a table: use blackbox_decode to write "
      "it as "
      "CSV"sv},
     {"#ROSBAG V"sv,
      "is a ROS bag, expected a table: rostopic echo -b FILE -p TOPIC writes a topic as CSV"sv},
     {"\x89MCAP0\r\n"sv,
      "is a ROS 2 bag (MCAP), expected a table: export one of its topics as CSV"sv},
     {"SQLite format 3\0"sv,
      "is an SQLite database, possibly a ROS 2 bag, expected a table: export one as CSV"sv},
     {"\x1f\x8b"sv, kPacked},
     {"PK\x03\x04"sv, kPacked},
     {"BZh"sv, kPacked},
     {"\xfd"
      "7zXZ\0"sv,
      kPacked},
     {"\x28\xb5\x2f\xfd"sv, kPacked}}};

// The first row that is not a banner defines the fields of its kind of rows.
bool is_ardupilot(std::string_view bytes) {
  constexpr std::string_view kFormat = "FMT,";
  while (true) {
    if (bytes.starts_with(kFormat)) return true;
    const std::size_t feed = bytes.find('\n');
    if (feed == std::string_view::npos) return false;
    bytes.remove_prefix(feed + 1);
  }
}

/// Whether a line is "[section]" or "name = value".
bool is_setting(std::string_view line) {
  if (const std::size_t name = line.find_first_not_of('['); name != 0)
    return name != std::string_view::npos && line.find(']') != std::string_view::npos &&
           std::isalpha(static_cast<unsigned char>(line[name])) != 0;
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos || equals == 0) return false;
  const std::string_view name = line.substr(0, line.find_last_not_of(" \t", equals - 1) + 1);
  return !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
  });
}

/// Whether the first few lines that are not comments are settings, as in TOML and INI.
bool is_settings(std::string_view bytes) {
  constexpr int kEnough = 6;
  int seen = 0;
  while (seen < kEnough && !bytes.empty()) {
    const std::string_view line = bytes.substr(0, bytes.find('\n'));
    bytes.remove_prefix(std::min(bytes.size(), line.size() + 1));
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string_view::npos || line[first] == '#' || line[first] == ';') continue;
    if (!is_setting(line.substr(first))) return false;
    ++seen;
  }
  return seen > 1;
}

}  // namespace

std::string_view foreign_format(std::string_view bytes) {
  const auto* const found =
      std::find_if(kBeginnings.begin(), kBeginnings.end(),
                   [&](const auto& one) { return bytes.starts_with(one.first); });
  if (found != kBeginnings.end()) return found->second;
  if (is_ardupilot(bytes)) return kArduPilot;
  if (is_settings(bytes))
    return "is a settings file (name = value), expected a table; --format text reads it as one";
  if (const std::size_t name = bytes.find_first_not_of("{ \t\r\n");
      bytes.starts_with('{') && name != std::string_view::npos && bytes[name] == '"')
    return "is JSON, expected a table";
  return bytes.starts_with("<") ? "is a page or XML, expected a table" : "";
}

}  // namespace quadtune::internal
