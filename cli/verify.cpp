// SPDX-License-Identifier: Apache-2.0
/// quadtune verify: an export, read back as the flight program would.
#include "quadtune/exports/verify.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <ostream>

#include "design_flow.hpp"
#include "print.hpp"
#include "program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/manifest.hpp"
#include "quadtune/internal/json.hpp"
#include "verify_report.hpp"

namespace quadtune::cli {
namespace {

namespace fs = std::filesystem;

/// The model that the manifest's gains are for; none if it holds no sampled gains.
std::optional<VerifyModel> model_for(const Manifest& manifest, const std::string& vehicle_name) {
  if (!manifest.gains || !(manifest.gains->dt > 0)) return std::nullopt;
  Vehicle vehicle;
  try {
    vehicle = load_vehicle(vehicle_name.empty() ? manifest.gains->vehicle : vehicle_name);
  } catch (const std::exception& error) {
    if (!vehicle_name.empty()) throw;
    throw InvalidInput("verify",
                       fmt::format("the manifest's vehicle '{}' is not built in, expected "
                                   "its file by --vehicle FILE",
                                   manifest.gains->vehicle));
  }
  return model_of(vehicle, *manifest.gains);
}

/// Names of the folders in a directory that are exports, such as those of a design with several.
std::vector<std::string> exports_below(const fs::path& directory) {
  std::vector<std::string> found;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, error))
    if (fs::exists(entry.path() / kManifestName, error)) found.push_back(entry.path().string());
  std::sort(found.begin(), found.end());
  return found;
}

/// A directory of exports is none itself: the message names those that are.
void require_export(const std::string& directory) {
  std::error_code error;
  if (fs::exists(fs::path(directory) / kManifestName, error)) return;
  const std::vector<std::string> below = exports_below(directory);
  if (!below.empty())
    throw FileError(directory, fmt::format("has no {}, expected one export of those in it: {}",
                                           kManifestName, fmt::join(below, ", ")));
}

}  // namespace

VerifyReport verify_directory(const std::string& directory, const std::string& vehicle_name) {
  require_export(directory);
  const Manifest manifest = read_manifest(directory);
  try {
    return verify_export(directory, model_for(manifest, vehicle_name));
  } catch (const NoSolution& error) {
    // A trim that the vehicle cannot fly is an answer too.
    VerifyReport report = verify_export(directory, std::nullopt);
    report.checks.push_back({"the vehicle can fly the trim", false, error.what()});
    return report;
  }
}

internal::Json to_json(const VerifyReport& report) {
  internal::Json checks = internal::Json::array();
  for (const VerifyCheck& check : report.checks)
    checks.push_back({{"name", check.name}, {"ok", check.ok}, {"detail", check.detail}});
  return {{"checks", checks}, {"verdict", report.ok() ? "pass" : "fail"}};
}

std::string to_text(const VerifyReport& report) {
  std::string text;
  for (const VerifyCheck& check : report.checks)
    text += fmt::format("{}{} {}: {}", text.empty() ? "" : "\n", check.ok ? "ok  " : "FAIL",
                        check.name, check.detail);
  return text;
}

Verb verify_verb() {
  struct Options {
    std::string directory, vehicle;
  };
  return {"verify", "DIR [--vehicle V]",
          "re-read an export as the flight program would and check everything",
          "quadtune verify out/uquad-hover", [](CLI::App& app) -> Action {
            auto options = std::make_shared<Options>();
            app.add_option("DIR", options->directory, "an export's directory");
            app.add_option("--vehicle", options->vehicle,
                           "the vehicle, where the manifest's is not built in")
                ->type_name("V");
            return [options](Context& context) {
              if (options->directory.empty())
                throw UsageError("quadtune verify: expected an export's directory", "DIR");
              const VerifyReport report = verify_directory(options->directory, options->vehicle);
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
