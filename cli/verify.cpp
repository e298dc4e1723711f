// SPDX-License-Identifier: Apache-2.0
/// quadtune verify: reads an export back as the flight program would.
#include <fmt/format.h>

#include <algorithm>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/verify/verify_directory.hpp"
#include "report/gains/gains.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string directory, vehicle, design;
  bool arm = false;
};

void add_options(CommandLine& line, Options& options) {
  line.add_option("DIR", options.directory, "an export's directory");
  line.add_option(
      "--vehicle V", options.vehicle,
      "the vehicle, if that of the manifest is neither built in nor found near the export "
      "or in the working folder");
  line.add_option("--design FILE", options.design,
                  "design file of the export, to solve it again and compare");
  line.add_flag("--arm", options.arm, "also compile flight code for ARM and run it under qemu-arm");
}

void run_verify(Options& options, Context& context) {
  if (options.directory.empty()) refuse("DIR", "expected an export's directory");
  const VerifyReport report =
      verify_directory(options.directory, options.vehicle, options.design, options.arm);
  context.print([&] { return to_json(report); },
                [&] {
                  return fmt::format("{}\nverdict: {}\n", to_text(report),
                                     report.ok() ? "pass" : "fail");
                });
  if (report.ok()) return;
  const auto wrong = [](const VerifyCheck& check) { return !check.ok; };
  const auto first = std::find_if(report.checks.begin(), report.checks.end(), wrong);
  const auto count = std::count_if(report.checks.begin(), report.checks.end(), wrong);
  throw AnswerIsNo(fmt::format("{}: {} of {} checks failed, the first is \"{}\"", options.directory,
                               count, report.checks.size(),
                               first == report.checks.end() ? "" : first->name));
}

}  // namespace

Verb verify_verb() {
  return {"verify", "DIR [--vehicle V] [--design FILE] [--arm]",
          "re-read an export as the flight program would and check everything",
          "quadtune verify out/uquad-hover", with_options(add_options, run_verify)};
}

}  // namespace quadtune::cli
