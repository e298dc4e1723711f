// SPDX-License-Identifier: Apache-2.0
/// The program's JSON output as an object.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace quadtune::testing {

/// Runs a command with --json and --quiet, which must end with status 0.
inline nlohmann::json run_json(std::vector<std::string> args) {
  args.insert(args.end(), {"--json", "--quiet"});
  const ProgramResult result = run_program(args);
  EXPECT_EQ(result.status, 0) << result.err;
  return nlohmann::json::parse(result.out);
}

}  // namespace quadtune::testing
