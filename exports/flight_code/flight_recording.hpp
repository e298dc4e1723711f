// SPDX-License-Identifier: Apache-2.0
/// Records a flight with a flight program instead of the library's law and estimator.
#pragma once

#include <memory>
#include <string>

#include "flight_code/flight_lines.hpp"
#include "flight_code/program_settings.hpp"

namespace quadtune::exports {

/// Name of the file with the flight that `replay` reproduces.
inline constexpr char kRecordedFlight[] = "flight.txt";

/// A running flight program: the library's templates, or a process.
class RunningProgram {
 public:
  RunningProgram() = default;
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;
  virtual ~RunningProgram() = default;

  virtual void start(const ProgramStart& start) = 0;
  /// The first half of a control period: the estimator.
  [[nodiscard]] virtual Estimate<double> estimate(const EstimatorInput& input) = 0;
  /// The second half of a control period: law and commands, from the estimate of the first half.
  /// @param idle  motor commands if the phase is FlightPhase::off
  [[nodiscard]] virtual ProgramOutput control(const Reference<double>& reference,
                                              const Eigen::VectorXd& idle) = 0;
};

/// The library's templates in `float` or in `double`.
[[nodiscard]] std::shared_ptr<RunningProgram> template_program(const ProgramSettings& settings,
                                                               bool double_precision);

/// A process that behaves like `replay -` of an exported program.
/// @throws FileError  if it cannot be started
[[nodiscard]] std::shared_ptr<RunningProgram> process_program(
    const ProgramSettings& settings, const std::vector<std::string>& command,
    bool double_precision);

struct RecordedFlight {
  FlightResult flight;
  std::string text;  ///< docs/formats.md, "Recorded flights of flight code"
};

/// Flies a setup with a program, including its allocation and command limits, and records its
/// inputs and outputs.
/// @param setup        vehicle, mission and environment; its law, estimator and allocation are not
///                     used
/// @param settings     of the program
/// @param interrupted  as fly()
[[nodiscard]] RecordedFlight record_flight(const FlightSetup& setup,
                                           const ProgramSettings& settings,
                                           const std::shared_ptr<RunningProgram>& program,
                                           bool double_precision,
                                           const std::function<bool()>& interrupted = {});

}  // namespace quadtune::exports
