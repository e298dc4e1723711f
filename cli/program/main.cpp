// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <iostream>
#include <string>
#include <vector>

#include "program/program.hpp"
#include "program/standard_streams.hpp"

int main(int argc, char** argv) {
  using namespace quadtune::cli;
  install_signal_handlers();
  install_last_handler();
  StandardInput input;
  StandardOutput output;
  std::istream in(&input);
  std::ostream out(&output);
  std::cerr.tie(&out);  // an error follows the output that it concerns
  const int status =
      run({argv + 1, argv + argc}, in, out, std::cerr, terminal_width(STDOUT_FILENO));
  std::cerr.tie(nullptr);
  return status;
}
