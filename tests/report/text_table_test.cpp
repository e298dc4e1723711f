// SPDX-License-Identifier: Apache-2.0
#include "report/text/text_table.hpp"

#include <gtest/gtest.h>

namespace quadtune::report {
namespace {

TEST(TextTable, PadsCellsAndLeavesOutBlanksAtTheEnd) {
  TextTable table({{"loop", 8, TextColumn::Side::left}, {"Ms", 6}, {"  unit", 0}});
  table.row({"yaw", "1.25", "  1"});
  table.row({"altitude and more", "10"});
  EXPECT_EQ(table.text(),
            "loop        Ms  unit\n"
            "yaw       1.25  1\n"
            "altitude and more    10");
  EXPECT_EQ(TextTable({{"a", 3}, {"b", 3}}).text(), "  a  b");
}

}  // namespace
}  // namespace quadtune::report
