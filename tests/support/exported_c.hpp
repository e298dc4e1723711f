// SPDX-License-Identifier: Apache-2.0
/// Building exported C as a user would.
#pragma once

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

namespace quadtune::testing {

inline bool has_compiler() {
  static const bool has = std::system("cc --version > /dev/null 2>&1") == 0;
  return has;
}

/// Builds the exported program with warnings as errors; the output of the compiler goes to the file
/// `log` in its folder.
inline int make_test(const std::filesystem::path& folder, const std::string& compiler = "cc") {
  return std::system(
      fmt::format("make -s -C '{}' CC={} CFLAGS='-O2 -Wconversion -Wdouble-promotion "
                  "-Wshadow -Werror' test > '{}/log' 2>&1",
                  folder.string(), compiler, folder.string())
          .c_str());
}

/// The loops of C code without a constant bound: a number, a constant in capitals, or the counter
/// of the enclosing loop.
inline std::vector<std::string> loops_without_bound(const std::string& code) {
  static const std::regex loop(R"(\b(?:for|while|do|goto)\b *[({;][^{]*|\bgoto .*)");
  static const std::regex bounded(
      R"(for \(int (\w+) = [^;]+; )"
      R"(\(?\1 (?:<|<=|>=) (?:i|[A-Z0-9_]+|\([A-Z0-9_ *+-]+\))(?:\) && [^;]+)?; )"
      R"((?:\+\+|--)\1\) )");
  static const std::regex comment(R"(/\*[^*]*(?:\*(?!/)[^*]*)*\*/)");
  const std::string bare = std::regex_replace(code, comment, "");
  std::vector<std::string> found;
  for (std::sregex_iterator at(bare.begin(), bare.end(), loop), end; at != end; ++at)
    if (!std::regex_match(at->str(), bounded)) found.push_back(at->str());
  return found;
}

}  // namespace quadtune::testing
