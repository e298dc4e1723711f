// SPDX-License-Identifier: Apache-2.0
/// quadtune export: writes gains or a design for another program.
#include "quadtune/exports/export.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/export/source_export.hpp"
#include "report/gains/gains.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  SourceExport request;
  std::string directory;
};

void require_complete(const Options& options) {
  const std::string& source = options.request.source;
  if (source.empty())
    refuse("SOURCE", "SOURCE is missing, expected an export, gains, a design or a vehicle");
  if (options.request.to.empty()) refuse("--to", "--to is missing, expected the format to write");
  if (options.directory.empty()) refuse("-o", "-o is missing, expected the directory to write");
  // An export that replaces its own source would lose what it does not contain.
  std::error_code ignored;
  if (std::filesystem::equivalent(source, options.directory, ignored))
    refuse("-o", "-o {} is the source itself, expected another directory", options.directory);
}

PreparedExport prepared(const SourceExport& request) {
  try {
    return prepare_export(request);
  } catch (const ExportRefused& error) {
    throw Refusal(fmt::format("{}; nothing was written{}", error.what(),
                              error.forcible() ? "; use --force to export it" : ""),
                  error.where());
  }
}

void run_export(const Options& options, Context& context) {
  require_complete(options);
  const PreparedExport prepared = cli::prepared(options.request);
  context.notes("warning: ", prepared.warnings);
  context.notes("note: ", prepared.notes);
  if (prepared.of_files)
    context.note(
        "note: only what the source holds is exported: gains, trim, cascade, estimator and "
        "vehicle; weights and Kalman filters are exported from a design file");
  std::vector<ManifestFile> files;
  {
    const WritingFiles writing;
    files = write_export(options.directory, prepared.kind, prepared.content, interrupted);
    context.written.push_back(options.directory);
  }
  context.print(
      [&] {
        return internal::Json{{"files", to_json(files)}};
      },
      [&] { return to_text(files, options.directory); });
}

void add_options(CommandLine& line, Options& options) {
  line.add_option(
      "SOURCE", options.request.source,
      "an export's directory, a gain file, a design file, a vehicle (its default cascade) "
      "or, with --to c, a gain schedule");
  line.add_option("--to NAME", options.request.to,
                  "uquad, mambo, json, mat, c, px4, ardupilot, betaflight or crazyflie");
  line.add_option("-o DIR", options.directory, "directory to write");
  line.add_option(
      "--vehicle V", options.request.vehicle,
      "the vehicle of the gains, if it is not built in and its file is not found in the working "
      "folder or near the export SOURCE");
  line.add_option("--name NAME", options.request.name,
                  "prefix of the names in the C program; default: the vehicle's name, for a "
                  "schedule followed by _schedule");
  line.add_option("--precision WORD", options.request.precision,
                  "precision of the C program: float or double");
  line.add_option("--law LAW", options.request.law,
                  "law of the C program, if the design has two: cascaded-pid or state-feedback");
  line.add_option("--adapter BOARD", options.request.adapter,
                  "files that connect the C program to a board: main, mambo, crazyflie or px4");
  line.add_option("--imu-calibration FILE", options.request.imu_calibration,
                  "calibration of the uquad's sensors to export with the gains, as `quadtune "
                  "calibrate imu -o` writes it");
  line.add_flag("--constants", options.request.constants,
                "for uquad: write a C header of the vehicle's constants as well");
  line.add_flag(
      "--force", options.request.force,
      "export even if the loop of a design is unstable, the logs did not confirm the covariances, "
      "the margins on a firmware are too small or SOURCE was forced; the manifest records the "
      "reason");
  line.add_option("--firmware VERSION", options.request.firmware.version,
                  "version of the firmware, e.g. 1.15 of px4; default: px4 1.16, ardupilot 4.6, "
                  "betaflight 2026.6, crazyflie 2026.08");
  line.add_flag(
      "--filter-noise", options.request.firmware.filter_noise,
      "for a firmware: write the noise of its estimator as well, from the design's filter");
  line.add_option("--setup NAME", options.request.firmware.setup,
                  "propellers of a Crazyflie: standard (default), legacy, thrust-kit or brushless");
}

}  // namespace

Verb export_verb() {
  return {"export", "DIR|FILE --to NAME -o DIR",
          "write gains, or the results of a design, for another program",
          "quadtune export designs/uquad-hover.toml --to json -o out/uquad-json",
          with_options(add_options, run_export)};
}

}  // namespace quadtune::cli
