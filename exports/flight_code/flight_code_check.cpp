// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/flight_code_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <system_error>

#include "export_text.hpp"
#include "flight_code/adapters.hpp"
#include "flight_code/compiled/process.hpp"
#include "flight_code/flight_recording.hpp"
#include "flight_code/program_settings.hpp"
#include "flight_code/schedule_program.hpp"
#include "flight_code/scratch_folder.hpp"
#include "json/to_json.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/content.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/exporter.hpp"
#include "quadtune/exports/flight_code.hpp"
#include "quadtune/exports/read_gains.hpp"
#include "quadtune/exports/schedule_table.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;

std::string last_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

/// The files that result from the gains of an export, or its schedule, and a vehicle. Without
/// gains.json, which also contains weights and is compared with the manifest by verify_export().
struct MadeAnew {
  ExportContent content;
  std::vector<FileContent> files;

  MadeAnew(const fs::path& directory, const Vehicle& vehicle) {
    content.vehicle = vehicle;
    if (holds_schedule(directory)) {
      content.schedule = read_schedule(directory / kScheduleJsonName);
    } else {
      StoredLaws laws = read_laws(directory);
      content.gains = std::move(laws.gains);
      content.cascade = std::move(laws.cascade);
      content.estimator = std::move(laws.estimator);
      content.filters = exporter_of(ExportKind("c"), "verify").filters(directory);
    }
    content.flight_code = read_flight_code_options(directory);
    files = flight_code_files(content);
    std::erase_if(files, [](const FileContent& file) { return file.name == kGainsJsonName; });
  }
};

/// Describes how the files of a directory differ from those of the program; empty if they agree.
/// The directory must not contain the numbers of another program: a build of all files would
/// include both.
std::string text_difference(const fs::path& directory, const MadeAnew& made) {
  const std::vector<FileContent>& expected = made.files;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory)) {
    const std::string name = entry.path().filename().string();
    if ((name.ends_with("_parameters.c") || name.ends_with(exports::kTableEnd)) &&
        std::none_of(expected.begin(), expected.end(),
                     [&](const FileContent& file) { return file.name == name; }))
      return name + " belongs to another program; move it to another folder";
  }
  return file_difference(
      directory, expected,
      made.content.schedule ? "the schedule and its options" : "the gains and the vehicle");
}

/// The first program that a target requires and that is not installed; empty if all are.
std::string missing_program(FlightCodeTarget target) {
  std::vector<std::string> needed = {"cc"};
  if (target == FlightCodeTarget::arm) needed = {"arm-linux-gnueabihf-gcc", "qemu-arm"};
  for (const std::string& program : needed)
    if (!exports::has_program(program)) return program;
  return "";
}

/// The command line that starts a program.
std::vector<std::string> command_of(const fs::path& folder, FlightCodeTarget target,
                                    const std::string& argument) {
  std::vector<std::string> words = {(folder / "replay").string(), argument};
  if (target == FlightCodeTarget::arm) words.insert(words.begin(), "qemu-arm");
  return words;
}

/// Writes the files of a program, whose text has been checked, to a folder and compiles them there
/// to the program `replay`.
/// @return  the last line of the compiler's errors; empty on success
std::string compile(const MadeAnew& made, const fs::path& folder, FlightCodeTarget target) {
  const bool arm = target == FlightCodeTarget::arm;
  std::vector<std::string> words = {arm ? "arm-linux-gnueabihf-gcc" : "cc",
                                    "-std=c99",
                                    "-ffp-contract=off",
                                    "-O1",
                                    "-o",
                                    (folder / "replay").string()};
  if (arm) words.emplace_back("-static");
  const std::vector<exports::AdapterFile> of_board =
      exports::adapter_files(made.content.flight_code.adapter);
  for (const FileContent& file : made.files)
    if (file.name.ends_with(".c") &&
        std::none_of(of_board.begin(), of_board.end(),
                     [&](const exports::AdapterFile& one) { return one.to == file.name; }))
      words.push_back((folder / file.name).string());
  words.emplace_back("-lm");
  write_files(folder, made.files);
  std::string said;
  if (exports::Process(words).finish(said) == 0) return "";
  return fmt::format("{} does not compile it: {}", words.front(),
                     internal::printable(last_line(said)));
}

/// Replays the recording, and the run of the Kalman filters if there is one.
void replay_in(const fs::path& folder, FlightCodeTarget target, const std::string& recording,
               VerifyCheck& check) {
  check.ok = true;
  for (const std::string& recorded : {recording, std::string("filters.txt")}) {
    if (!check.ok || !fs::exists(folder / recorded)) continue;
    std::string said;
    check.ok =
        exports::Process(command_of(folder, target, (folder / recorded).string())).finish(said) ==
        0;
    if (!check.detail.empty()) check.detail += "; filters: ";
    check.detail += internal::printable(last_line(said));
  }
}

/// Replays the recorded flight, or points.
VerifyCheck check_replay(const MadeAnew& made, FlightCodeTarget target) {
  const bool arm = target == FlightCodeTarget::arm;
  const bool schedule = made.content.schedule.has_value();
  VerifyCheck check{
      fmt::format("the {} repeats its {}", arm ? "program for ARM" : "compiled program",
                  schedule ? "points" : "flight"),
      false, ""};
  if (const std::string missing = missing_program(target); !missing.empty()) {
    check.ok = !arm;
    check.detail = fmt::format("not compiled: {} is not installed here", missing);
    return check;
  }
  try {
    const exports::ScratchFolder scratch;
    check.detail = compile(made, scratch.path(), target);
    if (check.detail.empty())
      replay_in(scratch.path(), target,
                schedule ? exports::kRecordedPoints : exports::kRecordedFlight, check);
  } catch (const FileError& error) {
    check.detail = error.what();
  }
  return check;
}

}  // namespace

std::vector<VerifyCheck> flight_code_checks(const fs::path& directory, const Vehicle& vehicle,
                                            const std::vector<FlightCodeTarget>& targets) {
  const std::string name =
      fmt::format("C is what the {}", holds_schedule(directory) ? "schedule gives" : "gains give");
  std::vector<VerifyCheck> checks;
  try {
    const MadeAnew made(directory, vehicle);
    const std::string difference = text_difference(directory, made);
    checks.push_back({name, difference.empty(), difference});
    if (!difference.empty()) return checks;
    checks.back().detail = fmt::format("{} files, byte by byte", made.files.size());
    for (const FlightCodeTarget target : targets) checks.push_back(check_replay(made, target));
  } catch (const InvalidInput& error) {
    checks.push_back({name, false, error.what()});
  } catch (const FileError& error) {
    checks.push_back({name, false, error.what()});
  }
  return checks;
}

struct CompiledProgram::Parts {
  exports::ScratchFolder folder;
  FlightCodeTarget target = FlightCodeTarget::host;
  exports::ProgramSettings settings;
  bool double_precision = false;
};

CompiledProgram::CompiledProgram(const fs::path& directory, const Vehicle& vehicle,
                                 FlightCodeTarget target)
    : parts_(std::make_unique<Parts>()) {
  const MadeAnew made(directory, vehicle);
  if (made.content.schedule)
    throw InvalidInput(
        directory.string(),
        "is the program of a gain schedule, which does not fly; expected a control program");
  if (const std::string difference = text_difference(directory, made); !difference.empty())
    throw InvalidInput(directory.string(), difference + "; run `quadtune verify` for details");
  if (const std::string missing = missing_program(target); !missing.empty())
    throw FileError(missing,
                    "is not installed; it is required to compile or run the "
                    "flight code");
  if (const std::string refused = compile(made, parts_->folder.path(), target); !refused.empty())
    throw InvalidInput(directory.string(), refused);
  parts_->target = target;
  parts_->settings = exports::program_settings(exports::recorded_setup(made.content));
  parts_->double_precision = made.content.flight_code.double_precision;
}

CompiledProgram::~CompiledProgram() = default;

ProgramFlight CompiledProgram::fly(const FlightSetup& setup,
                                   const std::function<bool()>& interrupted) const {
  const auto process = exports::process_program(
      parts_->settings, command_of(parts_->folder.path(), parts_->target, "-"),
      parts_->double_precision);
  exports::RecordedFlight recorded = exports::record_flight(setup, parts_->settings, process,
                                                            parts_->double_precision, interrupted);
  return {std::move(recorded.flight), std::move(recorded.text)};
}

ProgramFlight CompiledProgram::fly_by_templates(const FlightSetup& setup) const {
  exports::RecordedFlight recorded =
      exports::record_flight(setup, parts_->settings,
                             exports::template_program(parts_->settings, parts_->double_precision),
                             parts_->double_precision);
  return {std::move(recorded.flight), std::move(recorded.text)};
}

}  // namespace quadtune
