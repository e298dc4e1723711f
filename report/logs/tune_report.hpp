// SPDX-License-Identifier: Apache-2.0
/// What `quadtune tune kalman` found, as text, JSON and as a file.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "quadtune/estimation/filter_record.hpp"
#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/tuning/noise_tuning.hpp"

namespace quadtune::report {

struct TunedFile {
  std::string path;
  std::string sha256;
};

/// What fed a signal of the model, or was taken for the truth of a state.
struct TunedChannel {
  std::string signal;   ///< e.g. "height", "truth of vz"
  std::string channel;  ///< in full, with its unit: "sensor_baro.height [m]"
  std::string file;
};

/// The log of a flight, in one file or several, and what was taken of it.
struct TunedLog {
  std::vector<TunedFile> files;
  std::vector<TunedChannel> channels;
  std::vector<FilterRecord> records;
  std::vector<std::string> warnings = {};  ///< of the files' readers
};

struct TuneReport {
  const FilterModel& model;  ///< as it came, with the starts
  const std::vector<TunedLog>& logs;
  const NoiseTuning& tuning;
};

/// Which logs came, how the fit went, what it gained: a word and what is said of it.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> facts_of(const TuneReport& report);

[[nodiscard]] internal::Json to_json(const TuneReport& report);
[[nodiscard]] std::string to_text(const TuneReport& report);
/// The tuned model as a file that says from what it came and how it was judged.
[[nodiscard]] std::string tuned_file(const TuneReport& report, const std::string& command);

}  // namespace quadtune::report
