// SPDX-License-Identifier: Apache-2.0
/// Documents that a test generates: compared with the file in the tree, rewritten only on request.
#pragma once

#include <gtest/gtest.h>

#include <string>

namespace quadtune::testing {

/// Compares `text` with the file `name` of the source tree (e.g. "docs/uquad-gains.md"). With
/// QUADTUNE_UPDATE_DOCS=1 in the environment, the file is rewritten instead.
[[nodiscard]] ::testing::AssertionResult matches_document(const std::string& name,
                                                          const std::string& text);

}  // namespace quadtune::testing
