// SPDX-License-Identifier: Apache-2.0
/// quadtune diff: compares two sets of gains entry by entry.
#include <fmt/format.h>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/design/gains_difference.hpp"
#include "quadtune/workbench/verify/changed_export.hpp"
#include "report/gains/gains.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string a, b;
};

void add_options(CommandLine& line, Options& options) {
  line.add_option("A", options.a, "an export's directory, a file of gains or a design file");
  line.add_option("B", options.b,
                  "an export's directory, a file of gains or a design file to compare with");
}

void run_diff(Options& options, Context& context) {
  if (options.b.empty())
    refuse(options.a.empty() ? "A" : "B", "expected two sets of gains, directories or files");
  const LawsDifference difference = diff_laws(options.a, options.b);
  for (const std::string& source : {options.a, options.b})
    if (const std::string changed = changed_export(source); !changed.empty())
      context.note("note: " + changed);
  if (!difference.left_out.empty())
    context.note(fmt::format("note: only one of the two contains a {}, which is not compared",
                             difference.left_out));
  context.print([&] { return to_json(difference.entries); },
                [&] { return to_text(difference.entries); });
}

}  // namespace

Verb diff_verb() {
  return {"diff", "A B", "compare two sets of gains entry by entry, across conventions",
          "quadtune diff out/uquad-hover out/uquad-hover", with_options(add_options, run_diff)};
}

}  // namespace quadtune::cli
