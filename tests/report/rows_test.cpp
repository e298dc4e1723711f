// SPDX-License-Identifier: Apache-2.0
#include "report/text/rows.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "quadtune/internal/json.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

TEST(Rows, StandInColumnsAsWideAsTheirWidestCell) {
  EXPECT_EQ(aligned({{"loop", "Ms", "note"}, {"yaw", "1.25"}, {"altitude", "10", "far"}}, "<><"),
            "loop        Ms  note\n"
            "yaw       1.25\n"
            "altitude    10  far");
  EXPECT_EQ(aligned({{"", ""}, {"", "1"}}), "\n  1");
}

TEST(Rows, ShowMembersOfJson) {
  const double inf = std::numeric_limits<double>::infinity();
  const Json rows = Json::array(
      {{{"name", "roll"}, {"delay_s", 0.0123}, {"w", 0}, {"disk", {{"a", 1.5}}}, {"ok", true}},
       {{"name", "y"}, {"delay_s", inf}, {"w", 2.5}, {"disk", nullptr}, {"ok", false}}});
  EXPECT_EQ(table(rows, {{"name", "loop"},
                         {"delay_s", "delay", "[ms]", ".1f", 1e3},
                         {"w", "at", "[rad/s]", ".3g", 1, "-"},
                         {"disk/a", "disk", "", ".2f"},
                         {.key = "ok", .no = "UNSTABLE"}}),
            "      delay       at\n"
            "loop   [ms]  [rad/s]  disk\n"
            "roll   12.3        -  1.50\n"
            "y         -      2.5     -  UNSTABLE");
  EXPECT_EQ(table(rows, {{"name", "loop"}, {"w"}}), "loop\nroll    0\ny     2.5");
}

TEST(Rows, FiguresAreShortWhateverTheirSize) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(figure(2.345, ".2f"), "2.35");
  EXPECT_EQ(figure(12345.678, ".2f"), "12346");
  EXPECT_EQ(figure(12345.678, ".1f"), "12345.7");
  EXPECT_EQ(figure(2e7, ".1f"), "2e+07");
  EXPECT_EQ(figure(0.000012345, ".3g"), "1.23e-05");
  EXPECT_EQ(figure(inf, ".3g"), "-");
  EXPECT_EQ(reached(inf, ".3g"), "never");
  EXPECT_EQ(reached(std::nan(""), ".3g"), "-");
}

}  // namespace
}  // namespace quadtune::report
