// SPDX-License-Identifier: Apache-2.0
/// quadtune verify: an export, read back as the flight program would.
#include "report/gains/verify_report.hpp"

#include <memory>
#include <ostream>

#include "arguments/flight_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/verify/verify_directory.hpp"

namespace quadtune::cli {

Verb verify_verb() {
  struct Options {
    std::string directory, vehicle, design;
  };
  return {"verify", "DIR [--vehicle V] [--design FILE]",
          "re-read an export as the flight program would and check everything",
          "quadtune verify out/uquad-hover", [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            line.add_option("DIR", options->directory, "an export's directory");
            line.add_option("--vehicle", options->vehicle,
                            "the vehicle, where the manifest's is not built in")
                ->type_name("V");
            line.add_option("--design", options->design,
                            "the design file that the export was made from, to compare its hash")
                ->type_name("FILE");
            return [options](Context& context) {
              if (options->directory.empty())
                throw UsageError("quadtune verify: expected an export's directory", "DIR");
              const VerifyReport report = option_of_command("verify", [&] {
                return verify_directory(options->directory, options->vehicle, options->design);
              });
              if (context.json)
                context.out << internal::readable(to_json(report)) << "\n";
              else
                context.out << to_text(report) << "\n"
                            << "verdict: " << (report.ok() ? "pass" : "fail") << "\n";
              if (!report.ok()) throw AnswerIsNo("verify: " + options->directory + " failed");
            };
          }};
}

}  // namespace quadtune::cli
