// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "built_in_exporters.hpp"
#include "quadtune/exports/flight_code.hpp"
#include "quadtune/exports/schedule_table.hpp"

namespace quadtune::exports {
namespace {

/// Handles schedules, which are not laws: there are no laws to read, and gains.json is not read.
void add_schedules(Exporter& exporter) {
  exporter.read = [read = std::move(exporter.read)](const std::filesystem::path& directory,
                                                    const Manifest& manifest) -> StoredLaws {
    if (!holds_schedule(directory)) return read(directory, manifest);
    return {read_schedule(directory / kScheduleJsonName).vehicle, {}, {}};
  };
  exporter.written_again = [again = std::move(exporter.written_again)](
                               const std::filesystem::path& directory, const Manifest& manifest,
                               const Vehicle& vehicle) -> std::vector<FileContent> {
    if (!holds_schedule(directory)) return again(directory, manifest, vehicle);
    return {{kScheduleJsonName,
             schedule_text(read_schedule(directory / kScheduleJsonName), TableFormat::json)}};
  };
  exporter.filters = [filters = std::move(exporter.filters)](
                         const std::filesystem::path& directory) -> std::vector<KalmanFilter> {
    if (!holds_schedule(directory)) return filters(directory);
    return {};
  };
}

}  // namespace

Exporter flight_code_exporter() {
  // The C code is not parsed: the laws are read from the gains.json that is exported with it.
  Exporter exporter = json_exporter();
  exporter.target = export_target("c", "exporter");
  exporter.files = flight_code_files;
  exporter.gain_files = {kGainsJsonName, kFlightCodeName, kScheduleJsonName};
  exporter.read_plain = {};
  exporter.weights_difference = {};  // written_again compares all of gains.json
  add_schedules(exporter);
  return exporter;
}

}  // namespace quadtune::exports
