// SPDX-License-Identifier: Apache-2.0
#include "logs/foreign_formats.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace quadtune::internal {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::string_view kArduPilot =
    "is a text log of ArduPilot, whose rows are of many kinds, expected one table: write the rows "
    "of one kind as CSV, as with mavlogdump.py --format csv --types IMU";
constexpr std::string_view kPacked = "is compressed, expected a log: unpack it first";

constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kBeginnings = {
    {{"\xa3\x95"sv,
      "is a binary log of ArduPilot (DataFlash), expected one table: write the rows of one kind as "
      "CSV, as with mavlogdump.py --format csv --types IMU"sv},
     {"H Product:Blackbox"sv,
      "is a blackbox log of Betaflight or its kin, expected a table: blackbox_decode writes it as "
      "CSV"sv},
     {"#ROSBAG V"sv,
      "is a bag of ROS, expected a table: rostopic echo -b FILE -p TOPIC writes a topic as CSV"sv},
     {"\x89MCAP0\r\n"sv,
      "is a bag of ROS 2 (MCAP), expected a table: write a topic of it as CSV"sv},
     {"SQLite format 3\0"sv,
      "is an SQLite database, as bags of ROS 2 are, expected a table: write one as CSV"sv},
     {"\x1f\x8b"sv, kPacked},
     {"PK\x03\x04"sv, kPacked},
     {"BZh"sv, kPacked},
     {"\xfd"
      "7zXZ\0"sv,
      kPacked},
     {"\x28\xb5\x2f\xfd"sv, kPacked}}};

// The first row that is not a banner says how the rows of that kind are made up.
bool is_ardupilot(std::string_view bytes) {
  constexpr std::string_view kFormat = "FMT,";
  while (true) {
    if (bytes.starts_with(kFormat)) return true;
    const std::size_t feed = bytes.find('\n');
    if (feed == std::string_view::npos) return false;
    bytes.remove_prefix(feed + 1);
  }
}

}  // namespace

std::string_view foreign_format(std::string_view bytes) {
  const auto* const found =
      std::find_if(kBeginnings.begin(), kBeginnings.end(),
                   [&](const auto& one) { return bytes.starts_with(one.first); });
  if (found != kBeginnings.end()) return found->second;
  return is_ardupilot(bytes) ? kArduPilot : "";
}

}  // namespace quadtune::internal
