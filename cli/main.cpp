// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <string>
#include <vector>

#include "program.hpp"

int main(int argc, char** argv) {
  std::ios::sync_with_stdio(false);
  quadtune::cli::install_signal_handlers();
  return quadtune::cli::run({argv + 1, argv + argc}, std::cin, std::cout, std::cerr);
}
