// SPDX-License-Identifier: Apache-2.0
/// Where the private reference data lie, for tests that skip without them.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

namespace quadtune::testing {

/// The folder of reference data: $QUADTUNE_DATA, or ../shared/data beside the source tree.
/// Empty when there is none.
[[nodiscard]] std::filesystem::path shared_data();

}  // namespace quadtune::testing

/// Skips the test, saying why, when the reference data are absent.
#define QUADTUNE_REQUIRE_DATA(variable)                                      \
  const std::filesystem::path variable = ::quadtune::testing::shared_data(); \
  if (variable.empty()) GTEST_SKIP() << "no reference data (set QUADTUNE_DATA to their folder)"
