// SPDX-License-Identifier: Apache-2.0
/// quadtune analyze: poles, zeros, gain at rest and norms of a linear system.
#include "arguments/loop_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/systems/system_report.hpp"
#include "report/loops/matrix_loops.hpp"

namespace quadtune::cli {
namespace {

void run_analyze(const SystemArguments& arguments, Context& context) {
  const SystemReport report = system_report(system_of(arguments, context.in));
  context.print([&] { return to_json(report); }, [&] { return to_text(report); });
}

}  // namespace

Verb analyze_verb() {
  return {"analyze", "--A FILE --B FILE [--C FILE --D FILE] | --num LIST --den LIST, [--dt T]",
          "poles, zeros, gain at rest, H-infinity and H2 norm of a linear system",
          "quadtune analyze --num 1,2 --den 1,0.4,4",
          with_options(add_system_options, run_analyze)};
}

}  // namespace quadtune::cli
