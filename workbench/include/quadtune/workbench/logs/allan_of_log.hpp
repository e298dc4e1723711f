// SPDX-License-Identifier: Apache-2.0
/// The Allan deviation of a still sensor's log.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "quadtune/logs/log_reader.hpp"
#include "quadtune/tuning/allan.hpp"
#include "quadtune/workbench/logs/log_notes.hpp"

namespace quadtune {

/// "octaves", "decades" or "all".
/// @throws OptionError  "taus", for other words
[[nodiscard]] AllanTaus allan_taus(const std::string& word);

/// What is analysed: a rate, evenly sampled.
struct AllanRecord {
  std::string log;
  std::string column;
  std::string unit;                        ///< of the rate; may be empty
  Eigen::VectorXd rate;                    ///< (n)
  double dt = 0;                           ///< [s]
  std::vector<std::string> warnings = {};  ///< of the log's reader
  bool phase = false;                      ///< the column is the rate's integral
};

/// Which channel of which log.
struct AllanOptions {
  std::string log;     ///< a file that open_log() reads
  std::string column;  ///< a name or, of a text, a number from 1
  std::string unit;    ///< of the column; empty: as the log says
  /// The column is the rate's integral, in s, or an angle in rad or deg. An angle may be kept
  /// within a turn: whole turns are added where it jumps by more than half of one.
  bool phase = false;
  AllanTaus taus = AllanTaus::octaves;
  LogOptions reading = {};
  LogNote note = {};  ///< takes warnings
};

/// A record and its Allan deviation.
struct SensorAllan {
  AllanRecord record;
  AllanAnalysis analysis;
};

/// Reads a still sensor's channel and finds its noises.
/// @throws InvalidInput  for a gap in the log, and as read_sensors() and analyse_allan()
/// @throws MissingOption, FileError  as read_sensors()
[[nodiscard]] SensorAllan allan_of_log(const AllanOptions& options);

/// The same for the simulated rate of a gyroscope whose noise is known.
/// @param seed  of its noise
/// @param unit  of the rate in the result; empty: rad/s
[[nodiscard]] SensorAllan allan_of_made_up(std::uint64_t seed, const std::string& unit,
                                           AllanTaus taus);

}  // namespace quadtune
