// SPDX-License-Identifier: Apache-2.0
/// mutations: runs the program with changed inputs of every kind and reports where it does not end
/// as documented. See README.md.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>

#include "run_cases.hpp"
#include "sanitized.hpp"

#ifdef __SANITIZE_ADDRESS__
// The program allocates the size that a file claims. That this fails must be an error of the
// program, as without the sanitizer.
extern "C" const char* __asan_default_options() {
  return "allocator_may_return_null=1:max_allocation_size_mb=2048:detect_leaks=0";
}
#endif

namespace quadtune::mutations {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::uint64_t seed = 1;
  std::uint64_t from = 0;
  std::uint64_t count = 20000;
  std::uint64_t part = 0, parts = 1;
  double seconds = std::numeric_limits<double>::infinity();
  std::string kind = {};
  fs::path findings = "findings";
  bool list = false;
  bool unchanged = false;
};

constexpr char kUsage[] =
    "usage: mutations [--seed N] [--count N | --seconds S] [--case K] [--part I/N] [--kind NAME]\n"
    "                 [--findings FOLDER] [--list] [--unchanged]\n";

std::uint64_t number_of(std::string_view text) {
  std::uint64_t value = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ec != std::errc() || end.ptr != text.data() + text.size())
    throw std::runtime_error(fmt::format("'{}' is no number\n{}", text, kUsage));
  return value;
}

Arguments arguments_of(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string_view option = argv[i];
    if (option == "--list") {
      arguments.list = true;
      continue;
    }
    if (option == "--unchanged") {
      arguments.unchanged = true;
      continue;
    }
    if (i + 1 == argc) throw std::runtime_error(kUsage);
    const std::string_view value = argv[++i];
    if (option == "--seed") {
      arguments.seed = number_of(value);
    } else if (option == "--count") {
      arguments.count = number_of(value);
    } else if (option == "--seconds") {
      arguments.seconds = static_cast<double>(number_of(value));
      arguments.count = std::numeric_limits<std::uint64_t>::max() / 2;
    } else if (option == "--case") {
      arguments.from = number_of(value);
      arguments.count = 1;
      arguments.parts = 1;
    } else if (option == "--part") {
      const std::size_t slash = value.find('/');
      arguments.part = number_of(value.substr(0, slash));
      arguments.parts = number_of(value.substr(slash + 1));
    } else if (option == "--kind") {
      arguments.kind = value;
    } else if (option == "--findings") {
      arguments.findings = value;
    } else {
      throw std::runtime_error(kUsage);
    }
  }
  return arguments;
}

/// The input and the command are kept, to be run again.
void keep(const Finding& finding, const Arguments& arguments) {
  const fs::path folder =
      fs::absolute(arguments.findings) / fmt::format("{}-{}", finding.of.seed, finding.of.number);
  for (const auto& [name, bytes] : finding.of.files) {
    fs::create_directories((folder / name).parent_path());
    std::ofstream(folder / name, std::ios::binary) << bytes;
  }
  const std::string command = typed(finding.command, folder.string());
  fs::create_directories(folder);
  std::ofstream(folder / "finding.txt") << command << "\n" << finding.what << "\n";
  fmt::print("FOUND seed {} case {} ({})\n  {}\n  {}\n", finding.of.seed, finding.of.number,
             finding.of.kind, command, finding.what);
  std::fflush(stdout);
}

int run(const Arguments& arguments) {
  // In memory if possible: the files of a case exist for milliseconds.
  const fs::path memory = "/dev/shm";
  std::error_code ignored;
  const bool roomy = ::access(memory.c_str(), W_OK) == 0 &&
                     fs::space(memory, ignored).available > (std::uintmax_t{512} << 20U);
  const fs::path place = (roomy ? memory : fs::temp_directory_path()) /
                         fmt::format("quadtune-mutations-{}", ::getpid());
  const Cases cases(all_kinds((place / "samples").string()), options_of_commands(), arguments.seed);
  if (arguments.list) {
    for (const Kind& kind : cases.kinds()) fmt::print("{}\n", kind.name);
    fs::remove_all(place);
    return 0;
  }
  const auto begin = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  Run run;
  run.place = place;
  if (testing::kSanitized) run.limits = {20, 100, 600, 0};
  const std::vector<Case> unchanged = arguments.unchanged ? cases.unchanged() : std::vector<Case>{};
  run.make = [&](std::uint64_t number) {
    return arguments.unchanged ? unchanged.at(number) : cases.make(number);
  };
  run.found = [&](const Finding& finding) { keep(finding, arguments); };
  run.enough = [&] { return seconds() > arguments.seconds; };
  const auto& kinds = cases.kinds();
  if (!arguments.kind.empty() && std::none_of(kinds.begin(), kinds.end(), [&](const Kind& kind) {
        return kind.name == arguments.kind;
      }))
    throw std::runtime_error("no kind '" + arguments.kind + "', see --list");
  run.wanted = [&](std::uint64_t number) {
    return number % arguments.parts == arguments.part &&
           (arguments.kind.empty() || arguments.unchanged ||
            cases.kind_of(number).name == arguments.kind);
  };
  const std::uint64_t to =
      arguments.unchanged ? unchanged.size() : arguments.from + arguments.count;
  const Tally tally = run_cases(run, arguments.from, to);
  fmt::print("{} cases of {} kinds, seed {}, {} commands in {:.0f} s; ended with", tally.cases,
             kinds.size(), arguments.seed, tally.commands, seconds());
  for (const auto& [status, count] : tally.statuses) fmt::print(" {}: {}", status, count);
  fmt::print("; interrupted {}; findings {}\n", tally.stopped, tally.findings);
  return tally.findings == 0 ? 0 : 1;
}

}  // namespace
}  // namespace quadtune::mutations

int main(int argc, char** argv) {
  try {
    return quadtune::mutations::run(quadtune::mutations::arguments_of(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mutations: %s\n", error.what());
    return 2;
  }
}
