// SPDX-License-Identifier: Apache-2.0
/// Runs the program in this process, with the arguments of a command line.
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "program/program.hpp"

namespace quadtune::testing {

struct ProgramResult {
  int status = 0;
  std::string out;
  std::string err;
};

inline ProgramResult run_program(const std::vector<std::string>& args,
                                 const std::string& input = "") {
  std::istringstream in(input);
  std::ostringstream out;
  std::ostringstream err;
  ProgramResult result;
  result.status = cli::run(args, in, out, err);
  result.out = out.str();
  result.err = err.str();
  return result;
}

}  // namespace quadtune::testing
