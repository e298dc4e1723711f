// SPDX-License-Identifier: Apache-2.0
/// Converts a firmware's parameters on a vehicle to SI, and computes the margins of its loops with
/// the firmware's filters and delays.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/exports/content.hpp"
#include "quadtune/exports/firmware.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/synthesis/margins.hpp"
#include "quadtune/transfer_function.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune {

/// A rotation loop of the firmware, cut at the torque.
struct FirmwareTurn {
  FirmwareLoop gains;  ///< of the parameters
  double inertia = 0;  ///< of the vehicle about this axis [kg m²]
  double damping = 0;  ///< by the air on its rotors about this axis at hover [N m s]
  double delay = 0;    ///< sum of the delays of computation, hold, gyroscope and motor commands [s]
  double lag = 0;      ///< motor lag [s]
  LoopMargins rate;    ///< the loop of the rate alone
  LoopMargins whole;   ///< with the angle loop; equal to `rate` if the firmware has none
};

/// The parameters of a firmware on a vehicle.
struct FirmwareImport {
  Firmware firmware;                ///< version of the firmware
  Vehicle vehicle;                  ///< that the firmware flies
  std::vector<FirmwareLoop> loops;  ///< in the order of kAllCascadeAxes
  std::vector<FirmwareTurn> turns;  ///< roll, pitch, yaw
  ExportContent content;            ///< the cascade, in the form that `fly --gains` and others
                                    ///< accept
  std::optional<FlownLoop> flown;   ///< of that cascade; none if it is not analysed
  std::vector<std::string> notes;   ///< one sentence each
};

/// The open loop of a rotation in continuous time: gyroscope and derivative filters, the delay and
/// the motor lag as in the firmware's documentation, and the inertia and the damping of the
/// vehicle.
/// Theory: "Cascades of autopilots".
/// @param firmware  of the parameters
/// @param vehicle   valid
/// @param loop      one of firmware_loops(): roll, pitch or yaw
/// @param values    parameters of filters and rates; missing ones have their defaults
/// @param angle     whether the angle loop is closed through the same torque
[[nodiscard]] ContinuousTransferFunction firmware_turn_loop(const Firmware& firmware,
                                                            const Vehicle& vehicle,
                                                            const FirmwareLoop& loop,
                                                            const std::vector<Parameter>& values,
                                                            bool angle);

/// Whether the whole loop has the smallest margins with which a vehicle should fly: a phase of 20
/// deg and an Ms of 3. Other checks of this workbench ask for more, but many boards fly with less.
[[nodiscard]] bool has_margins_to_fly(const FirmwareTurn& turn);
/// "a phase of at least 20 deg and an Ms of at most 3".
[[nodiscard]] std::string margins_to_fly();
/// "roll phase 30.9 deg, Ms 1.99", of the whole loop.
[[nodiscard]] std::string describe(const FirmwareTurn& turn);

/// Roll, pitch and yaw with their margins.
/// @throws InvalidInput, NoSolution  as firmware_loops()
[[nodiscard]] std::vector<FirmwareTurn> firmware_turns(const Firmware& firmware,
                                                       const Vehicle& vehicle,
                                                       const std::vector<Parameter>& values);

/// @param firmware  of the parameters
/// @param vehicle   valid
/// @param file      none: the firmware's defaults
/// @param dt        sample period of the cascade [s]; 0: kFirmwarePeriod
/// @throws InvalidInput, NoSolution  as firmware_loops()
[[nodiscard]] FirmwareImport import_parameters(const Firmware& firmware, const Vehicle& vehicle,
                                               const std::optional<ParameterFile>& file,
                                               double dt = 0);

/// Sample period of the cascade that represents the firmware's loops of 250 Hz to 8 kHz [s].
inline constexpr double kFirmwarePeriod = 0.004;

}  // namespace quadtune
