// SPDX-License-Identifier: Apache-2.0
/// Proof that exported flight code is what was designed: its text, its compiled program, its
/// flights.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "quadtune/exports/verify.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/flight.hpp"

namespace quadtune {

/// Where the compiled program runs.
enum class FlightCodeTarget {
  host,  ///< by `cc`, on this machine
  arm,   ///< by `arm-linux-gnueabihf-gcc`, under `qemu-arm`
};

/// Asks whether each file of an export of flight code is, byte by byte, what its gains.json gives
/// for this vehicle, and whether the program that a compiler makes of it repeats the recorded
/// flight. What is not what it should be is not compiled.
///
/// Without `cc` the program is not compiled for the host, and the answer says so; a compiler for
/// ARM that is missing is a failed check.
[[nodiscard]] std::vector<VerifyCheck> flight_code_checks(
    const std::filesystem::path& directory, const Vehicle& vehicle,
    const std::vector<FlightCodeTarget>& targets = {FlightCodeTarget::host});

/// A flight with a flight program in the place of the library's law, estimator and allocation.
struct ProgramFlight {
  FlightResult flight;
  /// What went in and came out, each control period a line: flights with the same text are the same
  /// bit by bit.
  std::string text;
};

/// The program of an export of flight code, compiled.
class CompiledProgram {
 public:
  /// Compiles it into a temporary folder.
  /// @throws FileError, InvalidInput  for files that are not what their gains and the vehicle give,
  ///                                  for a compiler that is not installed, and for its errors
  CompiledProgram(const std::filesystem::path& directory, const Vehicle& vehicle,
                  FlightCodeTarget target = FlightCodeTarget::host);
  ~CompiledProgram();
  CompiledProgram(const CompiledProgram&) = delete;
  CompiledProgram& operator=(const CompiledProgram&) = delete;

  /// Flies a setup, of which law, estimator and allocation are not used.
  /// @param interrupted  as quadtune::fly()
  /// @throws InvalidInput  if the program ends early
  [[nodiscard]] ProgramFlight fly(const FlightSetup& setup,
                                  const std::function<bool()>& interrupted = {}) const;
  /// The same flight by the library's templates in the precision of the program.
  [[nodiscard]] ProgramFlight fly_by_templates(const FlightSetup& setup) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace quadtune
