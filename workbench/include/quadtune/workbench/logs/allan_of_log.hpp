// SPDX-License-Identifier: Apache-2.0
/// The Allan deviation from the log of a stationary sensor.
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

/// The analysed data: an evenly sampled rate.
struct AllanRecord {
  std::string log;                         ///< path of the log
  std::string column;                      ///< name of the column
  std::string unit;                        ///< of the rate; may be empty
  Eigen::VectorXd rate;                    ///< (n)
  double dt = 0;                           ///< [s]
  std::vector<std::string> warnings = {};  ///< of the log's reader
  bool phase = false;                      ///< the column is the rate's integral
};

/// Selects a channel of a log.
struct AllanOptions {
  std::string log;     ///< a file that open_log() accepts
  std::string column;  ///< a name, or the number of a text column, from 1
  std::string unit;    ///< of the column; empty: as stated in the log
  /// Whether the column is the rate's integral, in s, or an angle in rad or deg. A wrapped angle is
  /// unwrapped: whole turns are added at jumps of more than half a turn.
  bool phase = false;
  AllanTaus taus = AllanTaus::octaves;  ///< averaging factors of the curve
  LogOptions reading = {};              ///< how the log is read
  LogNote note = {};                    ///< receives warnings
};

/// A record and its Allan deviation.
struct SensorAllan {
  AllanRecord record;      ///< the rate
  AllanAnalysis analysis;  ///< its deviation and noise coefficients
};

/// Reads a channel of a stationary sensor and identifies its noises.
/// @throws InvalidInput  if the log has a gap, and as read_sensors() and analyse_allan()
/// @throws MissingOption, FileError  as read_sensors()
[[nodiscard]] SensorAllan allan_of_log(const AllanOptions& options);

/// The same for the simulated rate of a gyroscope whose noise is known.
/// @param seed  of its noise
/// @param unit  of the rate in the result; empty: rad/s
/// @param taus  averaging factors of the curve
[[nodiscard]] SensorAllan allan_of_simulated(std::uint64_t seed, const std::string& unit,
                                             AllanTaus taus);

}  // namespace quadtune
