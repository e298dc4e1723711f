// SPDX-License-Identifier: Apache-2.0
/// Loops and models as text, JSON and pictures. The results are only declared here; include the
/// header of a result to use it.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "report/loops/margins_report.hpp"
#include "report/plots/figure.hpp"

namespace quadtune {
struct CascadeReport;
struct CertifyReport;
struct FlownLoop;
struct Linearization;
struct LoopReport;
struct MethodComparison;
struct PidReport;
struct SampledPlant;
struct FirmwareImport;
struct VehicleCascade;
}  // namespace quadtune

namespace quadtune::report {

/// A vehicle's PID cascade: "vehicle", "dt", "sensor_delay_s", "integrator", "motor_lag_s",
/// "published", "loops", "margins", "spectral_radius".
[[nodiscard]] internal::Json to_json(const CascadeReport& report);
[[nodiscard]] std::string to_text(const CascadeReport& report);
/// The same with "method", "plant", "flown", "flown_loop", and the laws in the format that `fly
/// --gains` reads.
[[nodiscard]] internal::Json to_json(const VehicleCascade& cascade);
[[nodiscard]] std::string to_text(const VehicleCascade& cascade);
/// The parameters of a firmware on a vehicle; the JSON contains the cascade in the format of `fly
/// --gains`.
[[nodiscard]] internal::Json to_json(const FirmwareImport& import);
[[nodiscard]] std::string to_text(const FirmwareImport& import);
/// All loops, cut at the wrench.
[[nodiscard]] Figure cascade_figure(const VehicleCascade& cascade);

/// The proofs and searches of `certify`.
[[nodiscard]] internal::Json to_json(const CertifyReport& report);
[[nodiscard]] std::string to_text(const CertifyReport& report);

/// The flown loop: "stable", "largest_pole", "mode" and its conditions; not its margins.
[[nodiscard]] internal::Json to_json(const FlownLoop& loop);
[[nodiscard]] std::string to_text(const FlownLoop& loop);

/// The linear model of a vehicle at a trim, with the names of states and inputs; the notes are in
/// the JSON only.
/// @param model  solved
[[nodiscard]] internal::Json to_json(const Linearization& model);
[[nodiscard]] std::string to_text(const Linearization& model);

/// The margins of a loop, "time", "dt", and for a vehicle's loop "plant", "flown" and "ideal".
[[nodiscard]] internal::Json to_json(const LoopReport& report);
[[nodiscard]] std::string to_text(const LoopReport& report);

/// The effect of sampling on a vehicle's closed loops: "vehicle", "dt", "methods", "not_compared",
/// and "flown" if it was requested.
[[nodiscard]] internal::Json to_json(const MethodComparison& comparison);
[[nodiscard]] std::string to_text(const MethodComparison& comparison);
/// The response to the set point of x of the cascade: the slowest chain of loops, where periods
/// matter least, and the fastest poles, where they matter most.
[[nodiscard]] Figure sampling_figure(const MethodComparison& methods);

/// PID gains for a transfer function, the margins of their loop, and "how" they were computed.
[[nodiscard]] internal::Json to_json(const PidReport& report);
[[nodiscard]] std::string to_text(const PidReport& report);
/// @param num, den  coefficients of the plant, as given by the user
[[nodiscard]] Figure pid_figure(const PidReport& report, const std::string& num,
                                const std::string& den);

/// A sampled plant, or one converted to continuous time: "A", "B", "C", "D", and "states" if delays
/// have added states; or "num", "den" and the delay. Then "dt", "method", "inverse" and "warnings".
[[nodiscard]] internal::Json to_json(const SampledPlant& sampled);
[[nodiscard]] std::string to_text(const SampledPlant& sampled);

}  // namespace quadtune::report
