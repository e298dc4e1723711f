// SPDX-License-Identifier: Apache-2.0
/// Loops, regulators and properties of systems that are given as matrices or data, as text and
/// JSON.
#pragma once

#include <optional>
#include <string>

#include "quadtune/control/pid_method.hpp"
#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/synthesis/pid/pid_gains.hpp"
#include "quadtune/synthesis/pole_placement.hpp"

namespace quadtune {
struct FrequencyDataReport;
struct MarginsReport;
struct MatrixLqgReport;
struct MatrixLqrReport;
struct SystemReport;
}  // namespace quadtune

namespace quadtune::report {

/// One line for each loop: Ms and Mt with their frequencies, and the gains that the disk allows.
[[nodiscard]] std::string peaks_text(const MarginsReport& report);

/// Margins of frequency response data: those of to_json(MarginsReport), "samples", "w_min", "w_max"
/// and "notes". Margins that the data leave open are null.
[[nodiscard]] internal::Json to_json(const FrequencyDataReport& report);
[[nodiscard]] std::string to_text(const FrequencyDataReport& report);

/// As to_json(LqrReport), and "K_int", "K_past" and "sampled" if the problem has them; "K" belongs
/// to the states of the plant.
/// @param report  solved
[[nodiscard]] internal::Json to_json(const MatrixLqrReport& report);
/// @param with_sampled  whether the sampled plant and cost are printed
[[nodiscard]] std::string to_text(const MatrixLqrReport& report, bool with_sampled);

/// "K", "L", "M", "S", "P", "controller", "poles", "cost", "rms" and "margins".
/// @param report  solved
[[nodiscard]] internal::Json to_json(const MatrixLqgReport& report);
[[nodiscard]] std::string to_text(const MatrixLqgReport& report);

/// "K", "poles" and "error".
/// @param placement  solved
/// @param dt         as for pole_table()
[[nodiscard]] internal::Json to_json(const PolePlacement& placement);
[[nodiscard]] std::string to_text(const PolePlacement& placement, double dt);

/// "poles", "zeros", "rank", "dc_gain", "stable", "hinf_norm", "hinf_frequency" and "h2_norm".
[[nodiscard]] internal::Json to_json(const SystemReport& report);
[[nodiscard]] std::string to_text(const SystemReport& report);

/// A PID controller at a sample period: "dt", "method", "num", "den", the coefficients of z.
[[nodiscard]] internal::Json discrete_pid_json(const PidGains& gains, double dt, PidMethod method);
/// Its difference equation.
[[nodiscard]] std::string discrete_pid_text(const PidGains& gains, double dt, PidMethod method);

}  // namespace quadtune::report
