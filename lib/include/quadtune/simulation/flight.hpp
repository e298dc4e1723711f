// SPDX-License-Identifier: Apache-2.0
/// Simulates a flight, given vehicle, mission, control law, estimator, sensors and wind.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "quadtune/cascade.hpp"
#include "quadtune/control/limited_allocation.hpp"
#include "quadtune/control/state_feedback_law.hpp"
#include "quadtune/estimation/general_filter_settings.hpp"
#include "quadtune/estimation/mambo_estimator.hpp"
#include "quadtune/estimation/uquad_filter.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/logs/log_table.hpp"
#include "quadtune/model/environment.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/flight_estimator.hpp"
#include "quadtune/simulation/flight_law.hpp"
#include "quadtune/simulation/integrators.hpp"
#include "quadtune/simulation/mission.hpp"

namespace quadtune {

struct GainSchedule;

/// The cascade of PID loops with its limits.
struct CascadeController {
  CascadeGains gains;                           ///< gains of the loops
  PidMethod method = PidMethod::forward_euler;  ///< for the integrals
  double attitude_limit = 3;                    ///< of the references [rad]
  double integrator_limit = 2;                  ///< of |∫error| [error · s]
  double back_calculation = 0.001;              ///< [1/s]
  bool velocity_feed_forward = false;           ///< CascadedPidSettings::velocity_feed_forward
  bool conditional_integration = false;         ///< CascadedPidSettings::conditional_integration
};

/// State feedback, sampled with the period `dt`.
struct StateFeedbackController {
  Gains gains;    ///< gains in any convention
  double dt = 0;  ///< control period [s], > 0; that of the gains if they have one
  std::vector<IntegralGuard> guards;  ///< one per state; empty: the integrals are not limited
  /// If set, ScheduledFeedback takes K, K_int, x0 and u0 from the schedule in every period; `gains`
  /// are those at the start of the flight, which are also used to assess the loop.
  std::shared_ptr<const GainSchedule> schedule = nullptr;
};

/// The control law of a flight.
using Controller = std::variant<CascadeController, StateFeedbackController, OwnController>;

/// Source of the state that the control law uses.
enum class EstimatorKind {
  mambo,    ///< MamboEstimatorSettings
  uquad,    ///< UquadFilterSettings
  general,  ///< GeneralFilterSettings, computed from the vehicle's sensors
  truth,    ///< the true state, to quantify the effect of estimation
  own,      ///< FlightSetup::own_estimator
};
/// "mambo", "uquad", "general" and "truth", also accepted as input; "own" for output only.
[[nodiscard]] std::string to_string(EstimatorKind kind);

/// The estimator of a name.
/// @throws InvalidInput  with the unknown name and the known ones
[[nodiscard]] EstimatorKind estimator_kind(const std::string& name, const std::string& where);

/// Model of the optical flow sensor.
enum class FlowModel {
  full,        ///< motion field averaged over the image
  simplified,  ///< formula of the original Simulink model package
  off,         ///< no sensor
};
/// "full", "simplified", "off", also accepted as input.
[[nodiscard]] std::string to_string(FlowModel model);

/// The model of a name.
/// @throws InvalidInput  with the unknown name and the known ones
[[nodiscard]] FlowModel flow_model(const std::string& name, const std::string& where);

/// Limits beyond which the flight program aborts: it stops the motors, and the flight has failed.
struct SafetyLimits {
  double tilt = 1.2;             ///< of the estimated attitude [rad]
  double collision = 60;         ///< of the accelerometer reading [m/s²]
  double flow_lost_time = 1;     ///< without optical flow, if the estimator requires it [s]
  double disagreement_time = 1;  ///< of difference between optical flow and estimated velocity [s]

  friend bool operator==(const SafetyLimits&, const SafetyLimits&) = default;
};

/// Complete description of a flight. Two flights with the same setup give bit-identical results,
/// provided that user-defined laws and estimators depend on their inputs only.
struct FlightSetup {
  Vehicle vehicle;  ///< the model that law and estimator use
  /// The true vehicle with its sensors; empty: the same as `vehicle`
  std::optional<Vehicle> flown;
  Mission mission;                                      ///< what the vehicle must do
  Controller controller;                                ///< the law
  AllocationRule allocation = AllocationRule::clipped;  ///< for commands beyond the motors' limits
  EstimatorKind estimator = EstimatorKind::mambo;       ///< source of the state that the law uses
  MamboEstimatorSettings<double> mambo_estimator;       ///< dt and gravity are set by fly()
  UquadFilterSettings<double> uquad_filter;             ///< likewise
  /// Noise assumed in addition to the sensor file, for the general filter
  GeneralFilterNoise general_noise;
  /// Settings of the general filter instead of those computed from the sensor file. fly() sets its
  /// dt and start. Only with real_sensors.
  std::optional<GeneralFilterSettings> general_filter;
  OwnEstimator own_estimator;  ///< for EstimatorKind::own
  /// false: ideal sensors without delay, at the rates of the vehicle's sensors
  bool real_sensors = true;
  FlowModel flow = FlowModel::full;  ///< model of the optical flow sensor
  double flow_rate = 0;              ///< [Hz]; 0: rate of the vehicle's sensor
  Environment environment;           ///< air, wind, gravity and magnetic field
  SafetyLimits safety;               ///< limits beyond which the flight program aborts
  Integrator integrator = Integrator::bogacki_shampine_3;  ///< method of the simulation
  /// Maximum integration step [s]; each control period has a whole number of steps
  double step = 0.005;
  double duration = 0;       ///< [s]; 0: duration of the mission
  std::uint64_t seed = 1;    ///< of all random numbers
  std::uint32_t flight = 0;  ///< number of the flight among those with this seed
  bool log = false;          ///< whether to fill FlightResult::log
};

/// The true vehicle of a setup.
[[nodiscard]] inline const Vehicle& flown_vehicle(const FlightSetup& setup) {
  return setup.flown ? *setup.flown : setup.vehicle;
}
/// The sensors that a setup flies with: those of its true vehicle, modified by the setup's options.
[[nodiscard]] Sensors sensors_of(const FlightSetup& setup);

/// Control period of a setup's law [s].
[[nodiscard]] double control_period(const FlightSetup& setup);

/// Duration of a setup's flight [s].
[[nodiscard]] double duration_of(const FlightSetup& setup);

/// Settings of the general filter for a setup: FlightSetup::general_filter if it is set and the
/// sensors are real, else computed from the sensors of the vehicle. The control period is that of
/// the law, and the initial deviations are those of a start on the ground or in the air.
/// @throws InvalidInput  if the sensors cannot feed the filter, with what is missing, or if the
///                       vehicle has optical flow and the flow model is FlowModel::simplified
[[nodiscard]] GeneralFilterSettings general_filter_settings(const FlightSetup& setup);

/// Outcome of a flight.
enum class FlightEnd {
  completed,    ///< the full duration was flown
  safety_exit,  ///< the flight program aborted; the last event gives the reason
  diverged,     ///< a state left its physically meaningful range
};
/// "completed", "safety exit", "diverged".
[[nodiscard]] std::string to_string(FlightEnd end);

/// Result of a simulated flight.
struct FlightResult {
  FlightEnd end = FlightEnd::completed;  ///< how the flight ended
  double end_time = 0;                   ///< [s]
  /// After divergence: the state that left its range. After a safety exit due to a user-defined law
  /// or estimator: which of them, and its invalid entry. Otherwise empty.
  std::string culprit;
  MetricValues metrics;                                              ///< of the whole flight
  std::vector<LogEvent> events;                                      ///< in chronological order
  StateVector<double> final_state = StateVector<double>::Zero();     ///< true
  StateVector<double> final_estimate = StateVector<double>::Zero();  ///< final state estimate
  /// Number of integration steps
  std::uint64_t steps = 0;
  LogTable log;  ///< one row per control period; empty unless FlightSetup::log is set
};

/// Adapts the Mambo's estimator to the simulated optical flow sensor: it corrects the sensor's
/// scale and subtracts the flow due to body rates, taken at the time of the image if the gyroscope
/// or the image is delayed. Set the law first, since its period is used. Without optical flow
/// nothing changes.
void calibrate_flow(FlightSetup& setup);

/// Checks that a setup can be flown.
/// @throws InvalidInput  naming the component and the mistake
void validate(const FlightSetup& setup);

/// Simulates one flight.
/// @param setup        accepted by validate()
/// @param interrupted  called periodically; true aborts the flight with Interrupted
/// @throws InvalidInput  as validate()
[[nodiscard]] FlightResult fly(const FlightSetup& setup,
                               const std::function<bool()>& interrupted = {});

/// Simulates many flights. Flights that differ only in numbers are computed several at a time in
/// SIMD lanes. Each result is bit-identical to that of fly().
/// @param setups       each accepted by validate()
/// @param threads      number of threads, 0: one per processor; the result does not depend on it
/// @param interrupted  called periodically; true aborts with Interrupted
/// @throws InvalidInput  as validate(), naming the flight
[[nodiscard]] std::vector<FlightResult> fly_all(std::span<const FlightSetup> setups,
                                                std::size_t threads = 0,
                                                const std::function<bool()>& interrupted = {});

}  // namespace quadtune
