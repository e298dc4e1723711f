// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/export/written_exports.hpp"

#include <fmt/format.h>

#include <utility>

#include "quadtune/design/export_target.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/workbench/design/design_verdict.hpp"
#include "quadtune/workbench/export/export_content.hpp"
#include "quadtune/workbench/export/gains_export.hpp"
#include "quadtune/workbench/verify/verify_directory.hpp"

namespace quadtune {

std::vector<WrittenExport> write_exports(const DesignOutcome& outcome, const std::string& directory,
                                         const ExportWriter& write, bool force) {
  const Design& design = outcome.design;
  const std::string file = design.file.string();
  if (design.exports.empty())
    throw InvalidInput(file, "has no [[export]]; it is required because of -o");
  ExportContent content = export_content(outcome);
  content.forced = reasons_against_export(outcome);
  std::vector<InputAtHand> inputs;
  inputs.reserve(content.inputs.size());
  for (const FileContent& input : content.inputs) inputs.push_back({input.name, "", input.bytes});
  std::vector<std::vector<std::string>> notes;
  std::vector<std::string> weak;  // of each export, empty if its margins are sufficient
  for (const ExportRequest& request : design.exports) {
    content.flight_code = request.flight_code;
    content.firmware = request.firmware;
    const ExportKind kind = export_kind(request.to, file);
    (void)export_files(kind, content);
    // Only these programs change the design.
    const bool adapts = export_target(request.to, file).is_firmware || request.to == "c";
    ExportContent adapted = content;
    notes.push_back(adapts ? adapt_to_program(adapted, kind) : std::vector<std::string>());
    weak.push_back(weak_loops(adapted, kind));
    if (!weak.back().empty() && !force)
      throw NoSolution(fmt::format("{}: {}; nothing was written; --force writes nevertheless", file,
                                   weak.back()),
                       file);
  }
  const std::vector<std::string> reasons = content.forced;
  std::vector<WrittenExport> written;
  for (const ExportRequest& request : design.exports) {
    WrittenExport one;
    one.notes = std::move(notes[written.size()]);
    content.forced = reasons;
    one.weak = std::move(weak[written.size()]);
    if (!one.weak.empty()) {
      content.forced.push_back(one.weak);
      one.notes.push_back("WARNING: " + one.weak);
    }
    content.flight_code = request.flight_code;
    content.firmware = request.firmware;
    one.kind = export_kind(request.to, file);
    one.directory = design.exports.size() == 1
                        ? directory
                        : (std::filesystem::path(directory) / request.to).string();
    one.files = write(one.directory, one.kind, content);
    one.verification = verify_with(one.directory, design.vehicle, inputs, &outcome.flown);
    written.push_back(std::move(one));
  }
  return written;
}

}  // namespace quadtune
