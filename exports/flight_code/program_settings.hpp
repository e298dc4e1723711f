// SPDX-License-Identifier: Apache-2.0
/// The numbers of a flight program; its C code is written from them, and the library flies with
/// them.
#pragma once

#include <array>
#include <optional>
#include <variant>

#include "quadtune/control/allocation.hpp"
#include "quadtune/control/cascaded_pid.hpp"
#include "quadtune/control/limited_allocation.hpp"
#include "quadtune/control/state_feedback_law.hpp"
#include "quadtune/estimation/general_filter_settings.hpp"
#include "quadtune/estimation/mambo_estimator.hpp"
#include "quadtune/estimation/uquad_filter.hpp"
#include "quadtune/exports/content.hpp"
#include "quadtune/simulation/flight.hpp"

namespace quadtune::exports {

/// The uquad's filter with the vehicle model with which it predicts.
struct UquadProgram {
  UquadFilterSettings<double> filter;
  RigidBody body;
  RotorSpeeds<double> hover;  ///< speeds before the first command [rad/s]
};

/// Estimator, control law, allocation and motors of one flight program.
struct ProgramSettings {
  double dt = 0;                                        ///< control period [s]
  std::optional<GeneralFilterSettings> general;         ///< the general filter,
  std::optional<MamboEstimatorSettings<double>> mambo;  ///< or the Mambo's estimator,
  std::optional<UquadProgram> uquad;                    ///< or the uquad's filter; or none
  std::variant<CascadedPidSettings<double>, StateFeedbackSettings<double>> law;
  Allocation<double> allocation;
  ThrustLimits<double> limits;
  MotorCommand motor;
  std::array<double, kMaxRotors> direction{};  ///< ±1, sign of each motor's command

  [[nodiscard]] bool has_estimator() const { return general || mambo || uquad; }
  [[nodiscard]] bool cascade() const {
    return std::holds_alternative<CascadedPidSettings<double>>(law);
  }
  [[nodiscard]] bool rate_lead() const {
    return cascade() && has_rate_lead(std::get<CascadedPidSettings<double>>(law));
  }
  [[nodiscard]] const StateFeedbackSettings<double>& feedback() const {
    return std::get<StateFeedbackSettings<double>>(law);
  }
};

/// The flight that is recorded for an exported program: take-off, then a step in position and
/// heading. The program's own law and estimator are those of the library.
/// @throws InvalidInput  as flight_code_files()
[[nodiscard]] FlightSetup recorded_setup(const ExportContent& content);

/// @throws InvalidInput  as flight_code_files()
[[nodiscard]] ProgramSettings program_settings(const FlightSetup& setup);

}  // namespace quadtune::exports
