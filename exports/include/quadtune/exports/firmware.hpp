// SPDX-License-Identifier: Apache-2.0
/// Parameters of public autopilot firmware: PX4, ArduPilot, Betaflight and Crazyflie.
/// Sources of all facts: docs/bibliography.md, "Firmware". Theory: docs/theory.md, "Cascades of
/// autopilots".
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "quadtune/cascade.hpp"
#include "quadtune/design/firmware_options.hpp"
#include "quadtune/estimation/general_filter_settings.hpp"
#include "quadtune/exports/content.hpp"
#include "quadtune/exports/firmware_names.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// "px4", "ardupilot", "betaflight" or "crazyflie"; these are the names of the exporters, too.
[[nodiscard]] std::string to_string(FirmwareKind kind);
/// @throws InvalidInput  if the name is unknown, with the known names and the nearest
[[nodiscard]] FirmwareKind firmware_kind(const std::string& name, const std::string& where);

/// The versions whose parameters are known, newest first. A release is assigned to the newest known
/// version that does not exceed it: PX4 1.14.4 to "1.14".
[[nodiscard]] std::vector<std::string> firmware_versions(FirmwareKind kind);
/// The propeller sets that scale the thrust of the firmware; empty except for the Crazyflie.
[[nodiscard]] std::vector<std::string> firmware_setups(FirmwareKind kind);

/// The version and setup that options select.
/// @param kind     of the firmware
/// @param options  empty strings select the default version and the first of firmware_setups(); the
///                 default is the newest version but for PX4 (1.16) and ArduPilot (4.6)
/// @param where    prefix of messages
/// @throws InvalidInput  if the version is malformed or older than the oldest known one, or the
///                       setup does not exist
[[nodiscard]] Firmware firmware(FirmwareKind kind, const FirmwareOptions& options,
                                const std::string& where);
/// As firmware(), for the options --firmware and --setup of a command.
/// @throws OptionError  "firmware" or "setup", the option that is wrong
[[nodiscard]] Firmware firmware_of_options(FirmwareKind kind, const FirmwareOptions& options);

/// The name of the file that an export of this firmware writes.
[[nodiscard]] std::string parameter_file_name(FirmwareKind kind);

/// Properties of one parameter according to the documentation of the firmware.
struct ParameterFacts {
  std::string name;           ///< as the firmware spells it
  double usual = 0;           ///< default
  std::optional<double> min;  ///< as published
  std::optional<double> max;  ///< as published
  bool integer = false;       ///< whether the board stores an integer
  std::string unit;           ///< empty: dimensionless, or the unit of the loop
  bool read_only = false;     ///< read but never written, because it belongs to the setup of the
                              ///< vehicle
};

/// The parameters of the control loops, in the order in which they are written.
[[nodiscard]] std::vector<ParameterFacts> parameter_facts(const Firmware& firmware);

/// Parameter values by name; parameters without a value have the firmware's default.
class ParameterValues {
 public:
  /// Values of parameters of the firmware; others have their defaults.
  ParameterValues(const Firmware& firmware, const std::vector<Parameter>& values);

  [[nodiscard]] bool has(std::string_view name) const;  ///< whether the firmware has it
  /// The value; NaN if it belongs to the vehicle and is not given.
  /// @pre  has(name)
  [[nodiscard]] double operator()(std::string_view name) const;

 private:
  std::vector<Parameter> all_;
};

/// The contents of a parameter file.
struct ParameterFile {
  std::vector<Parameter> values;   ///< parameters of the control loops, each once
  std::size_t others = 0;          ///< number of other parameters, not in `notes`
  std::vector<std::string> notes;  ///< e.g. about a name that may be misspelled
};

/// The text of the file. Numbers read back to the value that the board stores: a float or an
/// integer.
/// @param firmware  that reads the file
/// @param values    parameters of parameter_facts()
/// @param header    comment lines, without comment characters
[[nodiscard]] std::string parameter_text(const Firmware& firmware,
                                         const std::vector<Parameter>& values,
                                         const std::vector<std::string>& header);

/// Reads a file as the firmware or its ground station does. Line ends may be LF or CR LF.
/// @throws InvalidInput  "origin:line: …" if a line is malformed, a parameter occurs twice or is
///                       not finite, a name belongs to another version, or the file has none of the
///                       parameters
[[nodiscard]] ParameterFile parse_parameters(const Firmware& firmware, const std::string& text,
                                             const std::string& origin);

/// Conversion between the outputs of the firmware's controllers and the wrench at hover.
struct FirmwareScale {
  /// Torque about roll, pitch and yaw per unit of the firmware's output [N m].
  std::array<double, 3> torque{};
  double thrust = 0;  ///< thrust of all rotors per unit of the firmware's thrust [N]
  double hover = 0;   ///< the firmware's thrust at hover
  double mass = 0;    ///< [kg]
};

/// @param firmware  whose mixer scales the outputs
/// @param vehicle  valid
/// @param values  those that change the scale, such as THR_MDL_FAC; the others have their defaults
/// @throws InvalidInput  if this firmware cannot mix the vehicle: Betaflight and Crazyflie support
///                       four rotors in X; for ArduPilot, quadtune supports four rotors in X or
///                       plus
/// @throws NoSolution    if the vehicle cannot hover
[[nodiscard]] FirmwareScale firmware_scale(const Firmware& firmware, const Vehicle& vehicle,
                                           const std::vector<Parameter>& values);

/// One loop of the firmware. Gains are positive if they damp.
struct FirmwareLoop {
  CascadeAxis axis = CascadeAxis::roll;  ///< the loop, by the quantity that it controls
  double scale = 0;             ///< torque, force or tilt per unit of the firmware's output
  double outer = 0;             ///< rate set point per error [1/s]
  double outer_integral = 0;    ///< [1/s²]
  double outer_derivative = 0;  ///< on the rate itself [1]
  double P = 0,  ///< proportional, on the error of the rate [firmware output per SI unit]
      I = 0,     ///< integral, likewise
      D = 0;     ///< derivative, on the rate unless of_error
  /// Sum of the time constants of the filters of D, in addition to those of the rate [s].
  double derivative_filter = 0;
  bool flies = true;  ///< false: the firmware has no such loop; the pilot closes it

  double forward = 0;     ///< on the set point of the rate that the outer loop computes
  bool of_error = false;  ///< D acts on the error of the rate, hence also on the outer gain

  /// The gains in the units of a PidLoop, without its signs.
  [[nodiscard]] double Kp() const {
    return scale * (P * outer + I * (1 + outer_derivative) + forward * outer);
  }
  /// Integral gain of a PidLoop, likewise.
  [[nodiscard]] double Ki() const { return scale * (I * outer + (P + forward) * outer_integral); }
  /// Derivative gain of a PidLoop, likewise.
  [[nodiscard]] double Kd() const {
    return scale *
           (P * (1 + outer_derivative) + forward * outer_derivative + (of_error ? D * outer : 0));
  }
  /// The gain on the derivative of the rate, Kd · rate_lead of a PidLoop.
  [[nodiscard]] double derivative() const { return scale * D; }
  /// The gain on the double integral of the error, which a cascade of PidLoops cannot represent.
  [[nodiscard]] double double_integral() const { return scale * I * outer_integral; }
};

/// The loops that result from the parameters on a vehicle, in the order of kAllCascadeAxes.
/// @param firmware  of the parameters
/// @param vehicle   valid
/// @param values    missing parameters have their defaults
/// @throws InvalidInput, NoSolution  as firmware_scale()
[[nodiscard]] std::vector<FirmwareLoop> firmware_loops(const Firmware& firmware,
                                                       const Vehicle& vehicle,
                                                       const std::vector<Parameter>& values);

/// The sign of a damping Kp in a PidLoop: -1 in x, where a negative pitch accelerates forward.
[[nodiscard]] double cascade_sign(CascadeAxis axis);

/// Converts the loops to a cascade with the signs of PidLoop. Loops that the firmware does not have
/// are copied from `pilot`.
[[nodiscard]] CascadeGains cascade_of(const std::vector<FirmwareLoop>& loops,
                                      const CascadeGains& pilot, double dt);

/// The parameters of a cascade.
struct FirmwareParameters {
  /// Values of the parameters that represent the cascade.
  std::vector<Parameter> values;
  /// Sentences about values that were rounded, shared, omitted or exceed the published range.
  std::vector<std::string> notes;
};

/// @throws InvalidInput  if the firmware cannot fly the gains (with the maximum Ki that it can), or
///                       the type of a parameter cannot represent its value; and as
///                       firmware_scale()
[[nodiscard]] FirmwareParameters firmware_parameters(const Firmware& firmware,
                                                     const Vehicle& vehicle,
                                                     const CascadeGains& gains);

/// The firmware that is named in the header of a file; no value if quadtune did not write the file.
/// @throws InvalidInput  if the file belongs to another firmware
[[nodiscard]] std::optional<Firmware> firmware_of_text(FirmwareKind kind, const std::string& text,
                                                       const std::string& origin);

/// The options with which quadtune wrote a parameter file.
/// @throws InvalidInput  as firmware_of_text(), or if the file does not name its firmware
[[nodiscard]] FirmwareOptions written_options(FirmwareKind kind, const std::string& text,
                                              const std::string& origin);

/// The standard deviation that a filter parameter represents for a noise density [unit/√Hz]: the
/// filter adds (σ dt)² in each prediction step of length dt.
/// @param density  noise density [unit/√Hz]
/// @param step     length of the prediction step [s]
[[nodiscard]] double filter_noise(double density, double step);

/// The noise parameters of the firmware's estimator that correspond to a general filter. If the
/// axes differ, the noisiest one is used. Values are limited to the published range; the notes
/// report which ones were limited and which are far below the default.
/// @throws InvalidInput  for Betaflight, which has no such parameters
[[nodiscard]] FirmwareParameters noise_parameters(const Firmware& firmware,
                                                  const GeneralFilterSettings& filter);

/// Whether a parameter is one of those of noise_parameters().
[[nodiscard]] bool is_noise_parameter(const std::string& name);

/// Checks that the parameters of an export fly the cascade of its manifest on the vehicle.
[[nodiscard]] std::vector<VerifyCheck> firmware_checks(const std::filesystem::path& directory,
                                                       const Vehicle& vehicle);

}  // namespace quadtune
