// SPDX-License-Identifier: Apache-2.0
/// The location of the private reference data, for tests that skip without them.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

namespace quadtune::testing {

/// The folder of reference data: $QUADTUNE_DATA, or ../shared/data next to the source tree. Empty
/// if there is none.
[[nodiscard]] std::filesystem::path shared_data();

}  // namespace quadtune::testing

/// Skips the test with a reason if the reference data are absent.
#define QUADTUNE_REQUIRE_DATA(variable)                                      \
  const std::filesystem::path variable = ::quadtune::testing::shared_data(); \
  if (variable.empty()) GTEST_SKIP() << "no reference data (set QUADTUNE_DATA to their folder)"
