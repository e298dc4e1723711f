// SPDX-License-Identifier: Apache-2.0
/// Checks that exported flight code matches the design: its text, the compiled program and its
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

/// Checks that each file of an export of flight code is, byte by byte, what its gains.json gives
/// for this vehicle, and that the compiled program reproduces the recorded flight. Files that
/// differ are not compiled.
///
/// Without `cc`, the program is not compiled for the host, and the check reports so; a missing
/// compiler for ARM is a failed check.
[[nodiscard]] std::vector<VerifyCheck> flight_code_checks(
    const std::filesystem::path& directory, const Vehicle& vehicle,
    const std::vector<FlightCodeTarget>& targets = {FlightCodeTarget::host});

/// A flight in which the program replaces the library's law, estimator and control allocation.
struct ProgramFlight {
  FlightResult flight;  ///< the flight as quadtune::fly() returns it
  /// Inputs and outputs of the program, one line per control period. Flights with equal text are
  /// equal bit by bit.
  std::string text;
};

/// The compiled program of an export of flight code.
class CompiledProgram {
 public:
  /// Compiles the program in a temporary folder.
  /// @throws FileError, InvalidInput  if files differ from what their gains and the vehicle give,
  ///                    the compiler is not installed, or it fails
  CompiledProgram(const std::filesystem::path& directory, const Vehicle& vehicle,
                  FlightCodeTarget target = FlightCodeTarget::host);
  ~CompiledProgram();
  CompiledProgram(const CompiledProgram&) = delete;
  CompiledProgram& operator=(const CompiledProgram&) = delete;

  /// Flies a setup; its law, estimator and control allocation are not used.
  /// @param setup        accepted by quadtune::fly()
  /// @param interrupted  as quadtune::fly()
  /// @throws InvalidInput  if the program ends early
  [[nodiscard]] ProgramFlight fly(const FlightSetup& setup,
                                  const std::function<bool()>& interrupted = {}) const;
  /// Flies the same setup with the library's templates in the precision of the program.
  [[nodiscard]] ProgramFlight fly_by_templates(const FlightSetup& setup) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace quadtune
