// SPDX-License-Identifier: Apache-2.0
/// A flight with a flight program in the place of the library's law and estimator.
#pragma once

#include <memory>
#include <string>

#include "flight_code/flight_lines.hpp"
#include "flight_code/program_settings.hpp"

namespace quadtune::exports {

/// The file of the flight that `replay` repeats.
inline constexpr char kRecordedFlight[] = "flight.txt";

/// A flight program as it runs: the library's templates, or a process.
class RunningProgram {
 public:
  RunningProgram() = default;
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;
  virtual ~RunningProgram() = default;

  virtual void start(const ProgramStart& start) = 0;
  /// The first half of a control period.
  [[nodiscard]] virtual Estimate<double> estimate(const EstimatorInput& input) = 0;
  /// The second half, by the estimate of the first.
  /// @param idle  commands of the motors where the phase is FlightPhase::off
  [[nodiscard]] virtual ProgramOutput control(const Reference<double>& reference,
                                              const Eigen::VectorXd& idle) = 0;
};

/// The library's templates in `float` or in `double`.
[[nodiscard]] std::shared_ptr<RunningProgram> template_program(const ProgramSettings& settings,
                                                               bool double_precision);

/// A process that answers as `replay -` of an exported program does.
/// @throws FileError  if it cannot be started
[[nodiscard]] std::shared_ptr<RunningProgram> process_program(
    const ProgramSettings& settings, const std::vector<std::string>& command,
    bool double_precision);

struct RecordedFlight {
  FlightResult flight;
  std::string text;  ///< docs/formats.md, "Recorded flights of flight code"
};

/// Flies a setup by a program, its allocation and the limits of its commands included, and writes
/// down what went in and came out.
/// @param setup        where, by which vehicle and in which weather; its law, its estimator and its
///                     allocation are not used
/// @param settings     of the program
/// @param interrupted  as fly()
[[nodiscard]] RecordedFlight record_flight(const FlightSetup& setup,
                                           const ProgramSettings& settings,
                                           const std::shared_ptr<RunningProgram>& program,
                                           bool double_precision,
                                           const std::function<bool()>& interrupted = {});

}  // namespace quadtune::exports
