// SPDX-License-Identifier: Apache-2.0
/// Parameters of the autopilot firmware that people own: PX4, ArduPilot, Betaflight, Crazyflie.
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
#include "quadtune/estimation/general_filter_settings.hpp"
#include "quadtune/exports/content.hpp"
#include "quadtune/exports/firmware_names.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/firmware_options.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// "px4", "ardupilot", "betaflight", "crazyflie": the names of the exports, too.
[[nodiscard]] std::string to_string(FirmwareKind kind);
/// @throws InvalidInput  naming the word, those that exist, and the nearest
[[nodiscard]] FirmwareKind firmware_kind(const std::string& name, const std::string& where);

/// The versions whose parameters are known, the newest first. A release belongs to the newest one
/// that is not above it: PX4 1.14.4 to "1.14".
[[nodiscard]] std::vector<std::string> firmware_versions(FirmwareKind kind);
/// The sets of propellers that scale the firmware's thrust; none but for the Crazyflie.
[[nodiscard]] std::vector<std::string> firmware_setups(FirmwareKind kind);

/// @param where  what asked for it, for messages
/// @throws InvalidInput  for a version below the oldest that is known, for one that is no version,
///                       or a setup that does not exist
[[nodiscard]] Firmware firmware(FirmwareKind kind, const FirmwareOptions& options,
                                const std::string& where);

/// The name of the file that an export writes.
[[nodiscard]] std::string parameter_file_name(FirmwareKind kind);

/// What a firmware's documentation says of one parameter.
struct ParameterFacts {
  std::string name;
  double usual = 0;           ///< its default
  std::optional<double> min;  ///< as published
  std::optional<double> max;  ///< as published
  bool integer = false;
  std::string unit;        ///< empty: none, or that of the loop
  bool read_only = false;  ///< read, never written: it belongs to the vehicle's set-up
};

/// The parameters that these loops consist of, in the order in which they are written.
[[nodiscard]] std::vector<ParameterFacts> parameter_facts(const Firmware& firmware);

/// Values by name, with the firmware's defaults behind them.
class ParameterValues {
 public:
  ParameterValues(const Firmware& firmware, const std::vector<Parameter>& values);

  [[nodiscard]] bool has(std::string_view name) const;  ///< whether the firmware has it
  /// NaN where it belongs to the vehicle and is not given.
  /// @pre  has(name)
  [[nodiscard]] double operator()(std::string_view name) const;

 private:
  std::vector<Parameter> all_;
};

/// What a file of parameters holds.
struct ParameterFile {
  std::vector<Parameter> values;   ///< of parameters that the loops consist of, each once
  std::size_t others = 0;          ///< how many further parameters it holds
  std::vector<std::string> notes;  ///< e.g. of a name that may be misspelled
};

/// The file's text. Numbers read back to what the board stores: a float, or an integer.
/// @param values  of parameter_facts()
/// @param header  lines of comment, without the mark of a comment
[[nodiscard]] std::string parameter_text(const Firmware& firmware,
                                         const std::vector<Parameter>& values,
                                         const std::vector<std::string>& header);

/// Reads a file as the firmware or its ground station does. Line ends may be LF or CR LF.
/// @throws InvalidInput  "origin:line: …" for a line that is none, a parameter that stands twice or
///                       is not finite, a name of another version, and a file without any of the
///                       parameters.
[[nodiscard]] ParameterFile parse_parameters(const Firmware& firmware, const std::string& text,
                                             const std::string& origin);

/// How a vehicle answers the firmware's controllers at hover.
struct FirmwareScale {
  /// Torque about roll, pitch and yaw per unit of the firmware's output [N m].
  std::array<double, 3> torque{};
  double thrust = 0;  ///< of all rotors per unit of the firmware's thrust [N]
  double hover = 0;   ///< the firmware's thrust at hover
  double mass = 0;    ///< [kg]
};

/// @param values  those that change the scale, such as THR_MDL_FAC; the rest has its default
/// @throws InvalidInput  for a vehicle that this firmware cannot mix: Betaflight and Crazyflie fly
///                       four rotors in X, ArduPilot is known here for four in X or plus
/// @throws NoSolution    if the vehicle cannot hover
[[nodiscard]] FirmwareScale firmware_scale(const Firmware& firmware, const Vehicle& vehicle,
                                           const std::vector<Parameter>& values);

/// One loop of the firmware. All gains are positive where they damp.
struct FirmwareLoop {
  CascadeAxis axis = CascadeAxis::roll;
  double scale = 0;             ///< torque, force or tilt per unit of the firmware's output
  double outer = 0;             ///< rate asked for per error [1/s]
  double outer_integral = 0;    ///< [1/s²]
  double outer_derivative = 0;  ///< of the rate itself [1]
  double P = 0, I = 0, D = 0;   ///< of the rate's error, in the firmware's output per SI unit
  bool flies = true;            ///< false: the firmware has no such loop, the pilot is it

  double forward = 0;     ///< of the set point of the rate, which the outer gain gives
  bool of_error = false;  ///< D acts on the rate's error, and so on the outer gain, too

  /// In the units of a PidLoop, without its signs.
  [[nodiscard]] double Kp() const {
    return scale * (P * outer + I * (1 + outer_derivative) + forward * outer);
  }
  [[nodiscard]] double Ki() const { return scale * (I * outer + (P + forward) * outer_integral); }
  [[nodiscard]] double Kd() const {
    return scale *
           (P * (1 + outer_derivative) + forward * outer_derivative + (of_error ? D * outer : 0));
  }
  /// What a cascade of PidLoops has no place for: the gain on the rate's derivative, and that of
  /// the error integrated twice.
  [[nodiscard]] double derivative() const { return scale * D; }
  [[nodiscard]] double double_integral() const { return scale * I * outer_integral; }
};

/// The loops that the parameters make of a vehicle, in the order of kAllCascadeAxes.
/// @param values  parameters that are missing have their default
/// @throws InvalidInput, NoSolution  as firmware_scale()
[[nodiscard]] std::vector<FirmwareLoop> firmware_loops(const Firmware& firmware,
                                                       const Vehicle& vehicle,
                                                       const std::vector<Parameter>& values);

/// The sign of Kp in a PidLoop that damps: -1 in x, where a pitch that is negative moves forward.
[[nodiscard]] double cascade_sign(CascadeAxis axis);

/// Those loops as a cascade with the signs of PidLoop. Loops that the firmware does not fly are
/// taken from `pilot`.
[[nodiscard]] CascadeGains cascade_of(const std::vector<FirmwareLoop>& loops,
                                      const CascadeGains& pilot, double dt);

/// The parameters that fly a cascade.
struct FirmwareParameters {
  std::vector<Parameter> values;
  /// A sentence each: what was rounded, shared, left out or is outside of the published range.
  std::vector<std::string> notes;
};

/// @throws InvalidInput  for gains that the firmware cannot fly, with the greatest Ki that it can;
///                       for a value that its type cannot hold; and as firmware_scale()
[[nodiscard]] FirmwareParameters firmware_parameters(const Firmware& firmware,
                                                     const Vehicle& vehicle,
                                                     const CascadeGains& gains);

/// The firmware that a file says it was written for; none where it is not quadtune's.
/// @throws InvalidInput  for a file of another firmware
[[nodiscard]] std::optional<Firmware> firmware_of_text(FirmwareKind kind, const std::string& text,
                                                       const std::string& origin);

/// The options with which quadtune wrote a file of parameters.
/// @throws InvalidInput  as firmware_of_text(), and for a file that does not say its firmware
[[nodiscard]] FirmwareOptions written_options(FirmwareKind kind, const std::string& text,
                                              const std::string& origin);

/// The standard deviation that a filter's parameter means, of a density [unit/√Hz]: the filter adds
/// (σ dt)² in each prediction step of length dt.
/// @param step  length of the prediction step [s]
[[nodiscard]] double filter_noise(double density, double step);

/// The noises of the firmware's estimator that a general filter's are. Of axes that differ the
/// noisiest counts. Values are held to the published range; notes tell which, and which are far
/// below the default.
/// @throws InvalidInput  for Betaflight, which has none
[[nodiscard]] FirmwareParameters noise_parameters(const Firmware& firmware,
                                                  const GeneralFilterSettings& filter);

/// Whether a parameter is one of these.
[[nodiscard]] bool is_noise_parameter(const std::string& name);

/// Whether an export's parameters fly the cascade of its manifest on the vehicle.
[[nodiscard]] std::vector<VerifyCheck> firmware_checks(const std::filesystem::path& directory,
                                                       const Vehicle& vehicle);

}  // namespace quadtune
